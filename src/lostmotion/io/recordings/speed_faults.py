"""A speed that is not as it was: sampled more slowly, zero where packets were lost, too coarse."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...errors import Problem
from ...recording import Recording
from .signal_faults import USUAL_CHANGES

Array = NDArray[np.float64]

#: A signal was held from one sample to the next if it changes so often at least, and on a raster alone. It was
#: interpolated over so many rows at most, if this share of its changes of slope lies on a raster (options: what is
#: sampled in every row gives 1/2). Changes larger than those of 99 % of the rows count as much as these.
SLOWEST, ON_RASTER, FEWEST_CHANGES, USUAL = 20, 0.98, 50, 0.99
#: A motor that turns is not at zero in the next row: it comes from, and goes on with, so many times what 99.9 % of the
#: changes are below; and lost packets are missing for so long at most, s (options; what is dead for longer has its own
#: check).
STOPPED, LONGEST_LOSS = 5.0, 0.2
#: Fewest values that a speed takes (option: 15 steps from the slowest to the fastest).
FEWEST_LEVELS = 16


def check_speeds(recording: Recording) -> tuple[Problem, ...]:
    """Warnings about the measured speeds of motor and load."""
    where = str(recording.meta.get("file", "recording"))
    found: list[Problem] = []
    for name in ("speed_motor", "speed_load"):
        if name in recording and np.ptp(recording[name]) > 0.0:
            values, place = recording[name], f"{where}, {name}"
            found += _slower(values, recording, place)
            found += _lost(values, recording.time, place)
            found += _coarse(values, place)
    return tuple(found)


def _slower(values: Array, recording: Recording, where: str) -> list[Problem]:
    """It changes, or changes its slope, in every second, third … row alone: it was held or interpolated in between.

    Under a torque that is held for some rows the slope of a motor's speed changes with it.
    """
    rows, how = _held(values), "changes"
    if rows < 2 and "torque_motor" in recording and not _raster(np.diff(recording["torque_motor"])):
        rows, how = _raster(np.diff(values, 2)), "changes its slope"
    if rows < 2:
        return []
    step = f"{1e3 * rows * recording.dt:.6g} ms"
    remedy = f'It was sampled every {step}: give resample = "{step}", or log faster.'
    got = f"a speed that {how} only once in {rows} rows"
    return [Problem.warning(where, got, "a sample of its own in every row", remedy)]


def _held(values: Array) -> int:
    """Rows for which every value is held, or a divisor of them; 0 where it hardly changes."""
    rows = np.flatnonzero(np.diff(values))
    return int(np.gcd.reduce(np.diff(rows))) if rows.size >= FEWEST_CHANGES else 0


def _raster(changes: Array) -> int:
    """Rows from one change to the next if nearly all lie on one raster, else 0."""
    sizes = np.abs(changes)
    sizes = np.minimum(sizes, np.quantile(sizes, USUAL))
    total = float(np.sum(sizes))
    for rows in range(SLOWEST, 1, -1):
        whole = sizes[: sizes.size // rows * rows].reshape(-1, rows)
        sums = np.sum(whole, axis=0)
        best = int(np.argmax(sums))
        if sums[best] > ON_RASTER * total > 0.0 and np.count_nonzero(whole[:, best]) >= FEWEST_CHANGES:
            return rows
    return 0


def _lost(values: Array, time: Array, where: str) -> list[Problem]:
    """It is exactly zero for some rows, and before and after them far from zero on the same side."""
    usual = float(np.quantile(np.abs(np.diff(values)), USUAL_CHANGES))
    zero = np.concatenate([[False], values == 0.0, [False]])
    first, last = np.flatnonzero(zero[1:] & ~zero[:-1]), np.flatnonzero(zero[:-1] & ~zero[1:]) - 1
    inside = (
        (first > 0)
        & (last < values.size - 1)
        & (last > first)
        & (time[last] - time[first - 1] <= LONGEST_LOSS)
    )
    first, last = first[inside], last[inside]
    before, after = values[first - 1], values[last + 1]
    lost = (np.minimum(np.abs(before), np.abs(after)) > STOPPED * usual) & (before * after > 0.0)
    if usual == 0.0 or not np.any(lost):
        return []
    i = int(np.flatnonzero(lost)[0])
    got = f"{before[i]:.4g}, then 0 in {last[i] - first[i] + 1} rows, then {after[i]:.4g}, at {time[first[i]]:.6g} s"
    got += f" (and {np.count_nonzero(lost) - 1} times more)" if np.count_nonzero(lost) > 1 else ""
    remedy = "Lost packets? Leave that part out by window = [...], or fill it in the tool that recorded."
    return [Problem.warning(where, got, "a motor that does not stop within a sample", remedy)]


def _coarse(values: Array, where: str) -> list[Problem]:
    levels = np.unique(values).size
    if levels >= FEWEST_LEVELS:
        return []
    remedy = "Log it with more digits, or log the angle in counts: channels.angle_motor."
    return [Problem.warning(where, f"a speed of only {levels} values", f"at least {FEWEST_LEVELS}", remedy)]
