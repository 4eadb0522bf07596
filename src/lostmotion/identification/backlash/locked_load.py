"""Backlash from the motor encoder alone, with the load locked and the motor torque ramped up and down."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments, not_negative
from ...errors import InvalidInput
from ...recording import Recording
from ..friction.result import Floats, torque_to_use
from ..statistics.estimates import Estimates, Interval, sources_of
from ..statistics.quantised_regression import compatible_range, count_fit
from . import problems as problem
from .ramps import count_of, ramps_of, sides_of

#: Most rows that go into the fit; every n-th is taken (numerics: a second of computing at the most).
MOST_ROWS = 20_000
#: Names of the values.
VALUES = ("backlash", "stiffness", "coulomb_motor")


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class LockedBacklash(Estimates):
    """Result of the locked-load test.

    Values: ``backlash`` (rad, total free angle, the wind-up removed; slightly negative, perhaps, where there is none),
    ``stiffness`` (Nm/rad, of all shafts between motor and lock, in series), ``coulomb_motor`` (Nm, half the torque
    between the rising and the falling branch; None if only one of them was recorded; the others then assume no
    friction).

    Attributes
    ----------
    resolution : float, rad
        Encoder count as given or found; 0: none.
    ramps : int
    time, torque, angle : (n,) arrays, s, Nm, rad
        As recorded; the angle from the middle of the gap.
    direction, side : (n,) arrays
        Of the torque (+1 rising, −1 falling) and of the contact (±1; 0 where the row was not used).
    """

    resolution: float
    ramps: int
    time: Floats
    torque: Floats
    angle: Floats
    direction: Floats
    side: Floats

    def fitted(self, torque: Floats, direction: float, side: float) -> Floats:
        """Angle (rad, from the middle of the gap) under a torque (Nm) in contact at a side; for plots."""
        backlash, stiffness = self.values["backlash"], self.values["stiffness"]
        if backlash is None or stiffness is None:
            raise InvalidInput(
                "LockedBacklash.fitted", "no backlash", "an identified one", "See its problems."
            )
        friction = direction * (self.values["coulomb_motor"] or 0.0)
        wind_up = (np.asarray(torque, dtype=float) - friction) / stiffness
        return np.asarray(wind_up + 0.5 * side * backlash)


@checks_arguments
def locked_backlash(
    recording: Recording,
    *,
    angle: str = "angle_motor",
    torque: str | None = None,
    resolution: float | None = None,
    settling: float = 0.1,
) -> LockedBacklash:
    """Backlash with the load locked, from motor torque and motor angle on slow ramps or plateaus::

        angle = middle + (torque − direction·coulomb_motor)/stiffness + side·backlash/2

    ``side`` is the flank in contact, ``direction`` that of the torque: friction at the motor makes rising and falling
    branches lie 2·coulomb_motor/stiffness apart, and their average is free of it. The readings are fitted as
    counts (``count_fit``): at 12 bit a wind-up of 15 Nm covers one or two of them only. Left out: the crossing of the
    gap and the oscillation after it, the rows after a reversal in which friction holds the motor, and the oscillation
    after a jump of the torque. Intervals: scatter between ramps.

    Not detected: a gap that its own friction holds closed against the torque, and a lock that gives way.

    Parameters
    ----------
    recording : Recording
    angle, torque : str
        Signals; the torque's default is the measured one where there is one.
    resolution : float, optional, rad
        Encoder count; default: found from the readings.
    settling : float, s
        After a crossing or a jump of the torque (default chosen: ten periods of a 100 Hz eigenmode).

    Source: Fietzek & Rinderknecht, section II.4 (brakes closed, small oscillating motor torque).
    """
    not_negative("locked_backlash.settling", settling)
    if resolution is not None:
        not_negative("locked_backlash.resolution", resolution)
    used, problems = torque_to_use(recording, torque)
    theta, m, dt = recording[angle], recording[used], recording.dt
    count = count_of(theta) if resolution is None else float(resolution)
    direction, ramp = ramps_of(m)
    middle = 0.5 * (float(theta.max()) + float(theta.min()))
    nothing = LockedBacklash(
        values=dict.fromkeys(VALUES),
        intervals={},
        problems=problems,
        resolution=count,
        ramps=int(ramp.max()) + 1,
        time=recording.time,
        torque=m,
        angle=theta - middle,
        direction=direction,
        side=0.0 * m,
    )
    found = problem.not_excited(m, theta, count, used)
    if found is None:
        side = sides_of(m, theta - middle, direction, ramp, max(round(settling / dt), 2), count)
        if min(np.count_nonzero(side == 1.0), np.count_nonzero(side == -1.0)) < problem.MIN_ROWS:
            found = problem.no_rows(used, settling)
    if found is not None:
        return replace(nothing, problems=(*problems, found))
    return _fit(nothing, theta, ramp, side)


def _fit(result: LockedBacklash, theta: Floats, ramp: NDArray[np.int64], side: Floats) -> LockedBacklash:
    rows = np.flatnonzero(side)
    rows = rows[:: max(rows.size // MOST_ROWS, 1)]
    s, way, m = side[rows], result.direction[rows], result.torque[rows]
    both = all(np.unique(way[s == flank]).size == 2 for flank in (1.0, -1.0)) or _separable(s, way)
    columns = np.stack([np.ones(rows.size), m, 0.5 * s] + ([-way] if both else []))
    values, low, high, open_ = _estimate(columns, theta[rows], result.resolution, ramp[rows])
    compliance = float(values[1])
    problems = list(result.problems)
    found: dict[str, float | None] = {**result.values, "backlash": float(values[2])}
    intervals: dict[str, Interval] = {"backlash": (float(low[2]), float(high[2]))}
    if compliance > 0.0 and low[1] > 0.0:
        found["stiffness"] = 1.0 / compliance
        intervals["stiffness"] = (1.0 / float(high[1]), 1.0 / float(low[1]))
        if both:
            found["coulomb_motor"] = float(values[3]) / compliance
            intervals["coulomb_motor"] = (float(low[3]) / compliance, float(high[3]) / compliance)
    if open_:
        problems.append(problem.stiffness_open(1.0 / float(high[1]), 1.0 / float(low[1])))
    if not both:
        problems.append(problem.one_way())
    ramps = int(np.unique(ramp[rows]).size)
    if ramps < problem.MIN_RAMPS:
        problems.append(problem.few_ramps(ramps))
    if intervals["backlash"][0] <= 0.0:
        problems.append(problem.none_found(intervals["backlash"][1]))
    # The readings are drawn in the middle of their counts.
    level = float(values[0]) - 0.5 * result.resolution
    return replace(
        result,
        values=found,
        intervals=intervals,
        sources=sources_of(found),
        problems=tuple(problems),
        ramps=ramps,
        angle=theta - level,
        side=side,
    )


def _estimate(
    columns: Floats, theta: Floats, resolution: float, ramp: NDArray[np.int64]
) -> tuple[Floats, Floats, Floats, bool]:
    """Values of (middle, compliance, backlash, half hysteresis), ends of their intervals, and whether counts leave them
    open.

    With one edge of a count on each flank, every compliance is compatible up to the limit at which a second edge would
    have shown. Edges seen at a given torque on two flanks are the more likely the more edges there are for each Nm;
    with all scales of compliance equally likely beforehand its density rises linearly up to that limit. It begins where
    the wind-up covers one count: the torque is assumed to be chosen that high.
    """
    fit = count_fit(columns, theta, resolution, ramp)
    low, high = fit.values - fit.margins, fit.values + fit.margins
    if resolution == 0.0:
        return fit.values, low, high, False
    bounds: dict[int, tuple[float | None, float | None]] = {
        i: (0.0, None) for i in (1, 3) if i < len(columns)
    }
    least, most = compatible_range(columns, theta, resolution, bounds=bounds)
    limit, first = float(most[1]), resolution / float(np.abs(columns[1]).max())
    if not (np.isfinite(limit) and least[1] < first < limit):
        return fit.values, np.fmin(low, least), np.fmax(high, most), False
    compliance = 2.0 / 3.0 * (limit**3 - first**3) / (limit**2 - first**2)
    rest = np.delete(columns, 1, axis=0)
    part = count_fit(rest, theta, resolution, ramp, known=compliance * columns[1])
    values, margins = np.insert(part.values, 1, compliance), np.insert(part.margins, 1, 0.0)
    bounds[1] = (first, limit)
    least, most = compatible_range(columns, theta, resolution, bounds=bounds)
    return values, np.fmin(values - margins, least), np.fmax(values + margins, most), True


def _separable(side: Floats, way: Floats) -> bool:
    """Whether friction (by direction) and gap (by side) are different columns: both directions on one side do."""
    return float(np.abs(np.mean(side * way) - np.mean(side) * np.mean(way))) < 0.98 * float(
        np.std(side) * np.std(way)
    )
