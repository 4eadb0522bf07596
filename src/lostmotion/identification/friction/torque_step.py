"""Friction, and inertia where it is not known, from the speed after a torque step (the paper's Fig. 5)."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from ...argument_checks import checks_arguments, not_negative
from ...errors import InvalidInput
from ...recording import Recording
from ..statistics.regression import linear_fit
from . import problems as problem
from .result import Floats, FrictionFit, checked_inertia, reported, torque_to_use

#: Above this part of the largest speed the drive counts as turning, below it as in Stribeck or stiction (option: the
#: default of ``min_speed``).
TURNING = 0.02
#: Half width of the averages by default, s (option: ten periods of a 100 Hz eigenmode, a tenth of a friction time
#: constant).
AVERAGING = 0.1
#: Fewest averages (numerics: three in each of the blocks that the intervals come from).
MIN_AVERAGES = 60
#: A torque is constant if it departs from one level in each direction by less than this part of it (calibrated on steps
#: and levels on the virtual rigs 1 to 4: half and double find the same; benchmarks/calibrations.py).
CONSTANT = 0.01


class _Stretch(NamedTuple):
    """One stretch of one sign of speed: rows of the joined recordings, that sign, and the arrays."""

    rows: slice
    sign: float
    torque: Floats
    speed: Floats


@checks_arguments
def torque_step(
    recordings: Recording | Sequence[Recording],
    *,
    inertia: float | None = None,
    speed: str = "speed_motor",
    torque: str | None = None,
    asymmetric: bool = False,
    min_speed: float | None = None,
    averaging: float = AVERAGING,
) -> FrictionFit:
    """Fit the equation of motion to what follows a torque step::

        inertia·d(speed)/dt = torque − offset − coulomb·sgn(speed) − viscous·speed

    It is linear in its parameters, so torque, speed and its central difference go through the same weighted average
    (Hann), over every stretch in which the drive turns in one direction; ripple and noise of the torque, which is
    the poor measurement, then are the residual of a least-squares fit. Intervals: jackknife over 20 blocks, valid for
    coloured residuals; friction that drifts over the whole recording (a bearing that warms up) is not in them.

    Parameters
    ----------
    recordings : Recording or sequence of Recording
        Steps in both directions may be one recording or several; all of one sample time.
    inertia : float, optional, kg m2
        The total inertia where it is known (the paper's way). Without it, it is identified.
    speed, torque : str
        Signals; the torque's default is the measured one where there is one.
    asymmetric : bool
        Coulomb and viscous friction for each direction. Otherwise both share them, with an offset if both turn.
    min_speed : float, optional, rad/s
        Below this the drive does not count as turning; default: 2 % of the largest speed.
    averaging : float, s
        Half width of the averages. Noise of the speed biases the inertia down where they are too short.

    Returns
    -------
    FrictionFit
        Of the speed; ``fitted`` is the equation solved with the torque recorded, from each stretch's first speed.

    Source: Fietzek & Rinderknecht, section II.3 and Fig. 5.
    """
    inertia = checked_inertia(inertia, "torque_step")
    records = _records(recordings)
    dt = records[0].dt
    used, problems = torque_to_use(records[0], torque)
    w = np.concatenate([r[speed] for r in records])
    m = np.concatenate([r[used] for r in records])
    if min_speed is not None:
        not_negative("torque_step.min_speed", min_speed)
    width = not_negative("torque_step.averaging", averaging, positive=True)
    half = max(round(width / dt), 2)  # the first speed of a stretch comes from a line through so many
    stretches = _stretches(records, w, m, min_speed, 2 * half + 1)
    signs = {s.sign for s in stretches}
    names = _names(signs, asymmetric)
    x, y = _averages(stretches, names, half, dt)
    fitted = np.full(w.shape, np.nan)
    known = {} if inertia is None else {"inertia": inertia}
    result = FrictionFit(
        values={**dict.fromkeys(names), **known},
        intervals={},
        sources=dict.fromkeys(known, "nameplate"),
        problems=problems,
        signal=speed,
        time=_joined_time(records),
        torque=m,
        measured=w,
        fitted=fitted,
    )
    if y.size < MIN_AVERAGES:
        still = problem.does_not_turn(speed, y.size, MIN_AVERAGES, float(np.abs(w).max()))
        return replace(result, problems=(*problems, still))
    if inertia is not None:
        names, x, y = names[1:], x[1:], y - inertia * x[0]
    elif _constant_torque(names, x, y):
        return replace(result, problems=(*problems, problem.scale_not_identified(used)))
    fit = linear_fit(x, y)
    values, intervals, sources, more = reported(names, fit.values, fit.margins, inertia, "torque_step")
    doubtful = {n: (a, b) for n, (a, b) in intervals.items() if n != "offset" and a <= 0.0 <= b}
    zero = (problem.may_be_zero(values, doubtful),) if doubtful else ()
    result = replace(
        result, values=values, intervals=intervals, sources=sources, problems=(*problems, *more, *zero)
    )
    if values["inertia"] is None:
        return result
    for stretch in stretches:
        fitted[stretch.rows] = _solved(stretch, result, half, dt)
    turns = np.isfinite(fitted)
    error = float(np.linalg.norm((w - fitted)[turns]) / np.linalg.norm(w[turns]))
    return replace(result, fitted=fitted, relative_error=error)


def _records(recordings: Recording | Sequence[Recording]) -> list[Recording]:
    records = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not records or max(r.dt for r in records) > 1.001 * min(r.dt for r in records):
        raise InvalidInput(
            "torque_step", f"{len(records)} recordings", "recordings of one sample time", "Resample them."
        )
    return records


def _joined_time(records: list[Recording]) -> Floats:
    """One recording after the other."""
    parts: list[Floats] = []
    start = float(records[0].time[0])
    for r in records:
        parts.append(r.time - r.time[0] + start)
        start = float(parts[-1][-1]) + r.dt
    return np.concatenate(parts)


def _stretches(
    records: list[Recording], w: Floats, m: Floats, min_speed: float | None, shortest: int
) -> list[_Stretch]:
    limit = TURNING * float(np.abs(w).max()) if min_speed is None else min_speed
    sides = np.sign(w) * (np.abs(w) > limit)
    cuts = set((np.flatnonzero(np.diff(sides)) + 1).tolist()) | {0, w.size}
    cuts |= set(np.cumsum([len(r) for r in records]).tolist())
    edges = sorted(cuts)
    return [
        _Stretch(slice(a, b), float(sides[a]), m[a:b], w[a:b])
        for a, b in zip(edges, edges[1:], strict=False)
        if sides[a] != 0.0 and b - a > shortest
    ]


def _names(signs: set[float], asymmetric: bool) -> tuple[str, ...]:
    if asymmetric:
        turned = tuple(n for n, s in (("plus", 1.0), ("minus", -1.0)) if s in signs)
        return ("inertia", *(f"coulomb_{n}" for n in turned), *(f"viscous_{n}" for n in turned))
    return ("inertia", "coulomb", "viscous", *(("offset",) if len(signs) == 2 else ()))


def _averages(
    stretches: list[_Stretch], names: tuple[str, ...], half: int, dt: float
) -> tuple[Floats, Floats]:
    """Columns (p, n) in the order of the names, and torques (n,), averaged over ±half samples every half."""
    weight = np.hanning(2 * half + 3)[1:-1]
    weight /= weight.sum()
    rows, torques = [np.zeros((len(names), 0))], [np.zeros(0)]
    for s in stretches:
        side = "plus" if s.sign > 0.0 else "minus"
        mean = np.convolve(s.speed, weight, "valid")[::half]
        rate = np.convolve(np.gradient(s.speed, dt), weight, "valid")[::half]
        one = np.ones_like(mean)
        by_name = {
            "inertia": rate,
            "coulomb": s.sign * one,
            "viscous": mean,
            "offset": one,
            f"coulomb_{side}": s.sign * one,
            f"viscous_{side}": mean,
        }
        rows.append(np.stack([by_name.get(name, 0.0 * one) for name in names]))
        torques.append(np.convolve(s.torque, weight, "valid")[::half])
    return np.concatenate(rows, axis=1), np.concatenate(torques)


def _constant_torque(names: tuple[str, ...], x: Floats, y: Floats) -> bool:
    """Whether Coulomb friction and offset alone explain the torque: then nothing gives the other values a scale."""
    constant = np.array([name.startswith("coulomb") or name == "offset" for name in names])
    level = np.linalg.lstsq(x[constant].T, y, rcond=None)[0]
    return bool(np.linalg.norm(y - level @ x[constant]) < CONSTANT * np.linalg.norm(y))


def _solved(s: _Stretch, found: FrictionFit, half: int, dt: float) -> Floats:
    """Speed along one stretch: speed[k+1] = decay·speed[k] + gain·(torque[k] − offset − coulomb), exactly."""
    from scipy.signal import lfilter

    side = 0 if s.sign > 0.0 else 1
    coulomb, viscous, offset = found.levels()
    inertia = float(found.values["inertia"] or 1.0)
    x = viscous[side] / inertia * dt
    gain = (-np.expm1(-x) / x if x != 0.0 else 1.0) * dt / inertia
    drive = s.torque - offset - s.sign * coulomb[side]
    first = float(np.polyval(np.polyfit(np.arange(half), s.speed[:half], 1), 0.0))
    later = lfilter([gain], [1.0, -np.exp(-x)], drive[:-1], zi=[np.exp(-x) * first])[0]
    return np.concatenate([[first], later])
