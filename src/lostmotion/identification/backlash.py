"""Backlash from the motor encoder alone, with the load locked and the motor torque ramped up and down."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput, Problem
from ..recording import Recording
from .count_fit import compatible_range, count_fit
from .friction import Floats, Interval, torque_to_use

#: Torque reversals smaller than this part of its range count as noise (chosen).
REVERSAL = 0.05
#: Kept clear on both sides of a crossing and of the end of sticking, as part of the torque's range (chosen).
CLEARANCE = 0.02
#: Jumps of the torque by this part of its range within a sample are steps, after which the motor swings (chosen).
JUMP = 0.02
#: The angle swings where it varies by this many times the usual amount within the settling time (chosen).
SWING = 2.0
#: Most rows that go into the fit; every n-th is taken (chosen: a second of computing at the most).
MOST_ROWS = 20_000
#: Fewest rows on each side of the gap (chosen).
MIN_ROWS = 20
#: The motor must turn by this many counts: else nothing can be told from them (chosen).
MIN_COUNTS = 3.0
#: Ramps below which an interval rests on too little (chosen).
MIN_RAMPS = 4


@dataclass(frozen=True, eq=False)
class LockedBacklash:
    """Result of the locked-load test; None where the recording does not tell a value.

    Attributes
    ----------
    backlash : float, rad
        Total free angle, the wind-up removed. May come out slightly negative where there is none.
    stiffness : float, Nm/rad
        Of all shafts between motor and lock, in series.
    coulomb_motor : float, Nm
        Half the torque between the rising and the falling branch; 0 assumed where only one of them was recorded.
    intervals : dict of those names → (low, high), 95 %
    problems : tuple of Problem
    resolution : float, rad
        Encoder count as given or found; 0: none.
    ramps : int
    time, torque, angle : (n,) arrays, s, Nm, rad
        As recorded; the angle from the middle of the gap.
    direction, side : (n,) arrays
        Of the torque (+1 rising, −1 falling) and of the contact (±1; 0 where the row was not used).
    """

    backlash: float | None
    stiffness: float | None
    coulomb_motor: float | None
    intervals: dict[str, Interval]
    problems: tuple[Problem, ...]
    resolution: float
    ramps: int
    time: Floats
    torque: Floats
    angle: Floats
    direction: Floats
    side: Floats

    @property
    def source(self) -> str:
        return "not excited" if self.backlash is None else "identified"

    @property
    def interval(self) -> Interval | None:
        """95 % interval of the backlash, rad."""
        return self.intervals.get("backlash")

    def fitted(self, torque: Floats, direction: float, side: float) -> Floats:
        """Angle (rad, from the middle of the gap) under a torque (Nm) in contact at a side; for plots."""
        if self.backlash is None or self.stiffness is None or self.coulomb_motor is None:
            raise InvalidInput(
                "LockedBacklash.fitted", "no backlash", "an identified one", "See its problems."
            )
        wind_up = (np.asarray(torque, dtype=float) - direction * self.coulomb_motor) / self.stiffness
        return np.asarray(wind_up + 0.5 * side * self.backlash)


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
    branches lie 2·coulomb_motor/stiffness apart, and their average is free of it. The readings are fitted as what they
    are, counts (``count_fit``): at 12 bit a wind-up of 15 Nm sweeps one or two of them only. Left out: the crossing
    of the gap and what swings after it, the rows after a reversal in which the motor's friction holds it, and the swing
    after a jump of the torque. Intervals: scatter between ramps.

    A gap that its own friction holds closed against the torque, and a lock that gives way, are not seen.

    Parameters
    ----------
    recording : Recording
    angle, torque : str
        Signals; the torque's default is the measured one where there is one.
    resolution : float, optional, rad
        Encoder count; default: found from the readings.
    settling : float, s
        After a crossing or a jump of the torque (default chosen: ten periods of a mode of 100 Hz).

    Source: Fietzek & Rinderknecht, section II.4 (brakes closed, small oscillating motor torque).
    """
    used, problems = torque_to_use(recording, torque)
    theta, m, dt = recording[angle], recording[used], recording.dt
    count = _resolution(theta) if resolution is None else float(resolution)
    direction, ramp = _ramps(m)
    middle = 0.5 * (float(theta.max()) + float(theta.min()))
    nothing = LockedBacklash(
        backlash=None,
        stiffness=None,
        coulomb_motor=None,
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
    found = _not_excited(m, theta, count, used)
    if found is None:
        side = _sides(m, theta - middle, direction, ramp, max(round(settling / dt), 2), count)
        if min(np.count_nonzero(side == 1.0), np.count_nonzero(side == -1.0)) < MIN_ROWS:
            found = _no_rows(used, settling)
    if found is not None:
        return replace(nothing, problems=(*problems, found))
    return _fit(nothing, theta, ramp, side)


def _resolution(theta: Floats) -> float:
    """The encoder's count, if all changes are multiples of the smallest one; else 0."""
    steps = np.abs(np.diff(np.unique(theta)))
    steps = steps[steps > 1e-12 * max(float(np.abs(theta).max()), 1e-300)]
    if not steps.size:
        return 0.0
    # Rounding spoils the smallest step; the mean of all that are one count has its digits.
    count = float(steps[steps < 1.5 * steps.min()].mean())
    multiples = steps / count
    return count if float(np.abs(multiples - np.round(multiples)).max()) < 1e-3 else 0.0


def _ramps(m: Floats) -> tuple[Floats, NDArray[np.int64]]:
    """Direction of the torque (±1) and number of the ramp for each row; reversals within noise do not count."""
    least = REVERSAL * float(np.ptp(m))
    direction, ramp = np.empty(m.size), np.empty(m.size, dtype=np.int64)
    way = 1.0 if float(m[int(np.argmax(np.abs(m - m[0]) > least))]) >= float(m[0]) else -1.0
    extreme, at, start, number = float(m[0]), 0, 0, 0
    for k, value in enumerate(m.tolist()):
        if way * (value - extreme) >= 0.0:
            extreme, at = value, k
        elif way * (extreme - value) > least:
            direction[start : at + 1], ramp[start : at + 1] = way, number
            way, start, number, extreme, at = -way, at + 1, number + 1, value, k
    direction[start:], ramp[start:] = way, number
    return direction, ramp


def _sides(
    m: Floats, theta: Floats, direction: Floats, ramp: NDArray[np.int64], settling: int, count: float
) -> Floats:
    """Flank in contact, ±1, for the rows that can be used; else 0."""
    clear = CLEARANCE * float(np.ptp(m))
    side = np.where(theta >= 0.0, 1.0, -1.0)
    crossings = np.flatnonzero(np.diff(side)) + 1
    friction = _friction(m, direction, crossings)
    use = np.ones(m.size, dtype=bool)
    for number in range(int(ramp.max()) + 1):
        rows = np.flatnonzero(ramp == number)
        start = m[rows[0]]
        # After a reversal the motor's friction turns round before the motor does. The first ramp starts anywhere.
        held = 2.2 * friction + clear
        use[rows] &= direction[rows] * (m[rows] - start) > held
    for k in crossings:
        near = slice(max(k - settling // 4, 0), k + settling)
        use[near] = False
        same = ramp == ramp[k]
        use[same & (np.abs(m - m[k]) < clear)] = False
    for k in np.flatnonzero(np.abs(np.diff(m)) > JUMP * float(np.ptp(m))) + 1:
        use[k : k + settling] = False
    use &= _quiet(theta, use, settling, count)
    return np.where(use, side, 0.0)


def _quiet(theta: Floats, use: NDArray[np.bool_], width: int, count: float) -> NDArray[np.bool_]:
    """Where the motor does not swing: a motor with little friction bounces for longer than the settling time."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    swing = maximum_filter1d(theta, width) - minimum_filter1d(theta, width)
    usual = float(np.median(swing[use])) if use.any() else 0.0
    return np.asarray(swing < SWING * usual + 1.5 * count)


def _friction(m: Floats, direction: Floats, crossings: NDArray[np.int64]) -> float:
    """Coulomb friction at the motor, Nm: the gap is crossed where the torque exceeds it."""
    up, down = (m[crossings[direction[crossings] == way]] for way in (1.0, -1.0))
    if not (up.size and down.size):
        return 0.0
    return max(0.5 * (float(np.median(up)) - float(np.median(down))), 0.0)


def _fit(result: LockedBacklash, theta: Floats, ramp: NDArray[np.int64], side: Floats) -> LockedBacklash:
    rows = np.flatnonzero(side)
    rows = rows[:: max(rows.size // MOST_ROWS, 1)]
    s, way, m = side[rows], result.direction[rows], result.torque[rows]
    both = all(np.unique(way[s == flank]).size == 2 for flank in (1.0, -1.0)) or _separable(s, way)
    columns = np.stack([np.ones(rows.size), m, 0.5 * s] + ([-way] if both else []))
    values, low, high, open_ = _estimate(columns, theta[rows], result.resolution, ramp[rows])
    compliance, backlash = float(values[1]), float(values[2])
    problems = list(result.problems)
    intervals: dict[str, Interval] = {"backlash": (float(low[2]), float(high[2]))}
    stiffness: float | None = None
    coulomb: float | None = None if both else 0.0
    if compliance > 0.0 and low[1] > 0.0:
        stiffness = 1.0 / compliance
        intervals["stiffness"] = (1.0 / float(high[1]), 1.0 / float(low[1]))
        if both:
            coulomb = float(values[3]) / compliance
            intervals["coulomb_motor"] = (float(low[3]) / compliance, float(high[3]) / compliance)
    if open_:
        problems.append(_stiffness_open(1.0 / float(high[1]), 1.0 / float(low[1])))
    if not both:
        problems.append(_one_way())
    ramps = int(np.unique(ramp[rows]).size)
    if ramps < MIN_RAMPS:
        problems.append(_few_ramps(ramps))
    if intervals["backlash"][0] <= 0.0:
        problems.append(_none_found(intervals["backlash"][1]))
    # The readings are drawn in the middle of their counts.
    level = float(values[0]) - 0.5 * result.resolution
    return replace(
        result,
        backlash=backlash,
        stiffness=stiffness,
        coulomb_motor=coulomb,
        intervals=intervals,
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
    the wind-up sweeps one count: the torque is taken to be chosen that high.
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


def _not_excited(m: Floats, theta: Floats, count: float, torque: str) -> Problem | None:
    largest, turned = float(np.abs(m).max()), float(np.ptp(theta))
    if not (m.min() < 0.0 < m.max()):
        return Problem(
            "warning",
            f"locked_backlash: {torque}",
            f"{m.min():.4g} … {m.max():.4g} Nm: it never reverses",
            "a torque of both signs",
            "Ramp the torque through zero; the backlash is not excited.",
        )
    if turned < max(MIN_COUNTS * count, 1e-12):
        return Problem(
            "warning",
            f"locked_backlash: {torque}",
            f"up to {largest:.3g} Nm, under which the motor turns by {turned:.3g} rad ({_counts(turned, count)})",
            f"a torque that moves the motor across the gap, {MIN_COUNTS:g} counts or more",
            "Raise the torque above the friction at the motor, or use a finer encoder: too small to cross.",
        )
    return None


def _counts(turned: float, count: float) -> str:
    return f"{turned / count:.1f} counts" if count > 0.0 else "no count"


def _no_rows(torque: str, settling: float) -> Problem:
    return Problem(
        "warning",
        f"locked_backlash: {torque}",
        f"fewer than {MIN_ROWS} samples at rest on one flank",
        f"a torque that stays on each side of zero for much longer than {settling:g} s, and exceeds the friction",
        "Ramp more slowly (fast sines bounce from flank to flank), or raise the torque: too small to cross.",
    )


def _stiffness_open(low: float, high: float) -> Problem:
    return Problem(
        "warning",
        "locked_backlash: stiffness",
        f"one edge of a count on each flank: any stiffness from {low:.3g} Nm/rad on is compatible, up to {high:.3g} "
        "if the wind-up sweeps one count as it is taken to",
        "a wind-up that sweeps two counts or more",
        "Raise the torque, use a finer encoder, or lock the load at another angle; the backlash's interval "
        "holds what this leaves open.",
    )


def _one_way() -> Problem:
    return Problem(
        "warning",
        "locked_backlash",
        "each flank loaded in one direction only",
        "rising and falling torque on at least one flank",
        "Ramp back to zero as well: friction at the motor cannot be told here and makes the backlash read "
        "2·friction/stiffness too small.",
    )


def _few_ramps(count: int) -> Problem:
    return Problem(
        "warning",
        "locked_backlash",
        f"{count} ramps",
        f"{MIN_RAMPS} or more",
        "Repeat them: the interval comes from their scatter.",
    )


def _none_found(most: float) -> Problem:
    return Problem(
        "warning",
        "locked_backlash",
        f"an interval that holds zero: no backlash found, at most {max(most, 0.0):.3g} rad",
        "a gap that stands out",
        "If there should be one, check that the load is locked behind it and that the torque overcomes its friction.",
    )
