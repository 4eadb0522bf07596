"""What a sensor or a logger does wrong: a signal that stands still, one sample far off, sizes that nothing has."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import NDArray

from ...errors import Problem
from ...recording import Recording
from ..spelling import short_list

#: Largest size of a signal, SI (option: a day at a million rad/s turns 1e11 rad; no torque or speed comes near).
LARGEST = 1e12

#: A signal sticks where one value lasts so many times longer than 99 % of all do, and so long (s); said only of signals
#: that change often. Calibrated, as the others below, on the virtual rigs 1 to 4: no false warning and all faults
#: found, also with half and double of each but DEAD_TORQUE; benchmarks/calibrations.py.
STUCK_RUNS, USUAL_RUNS, STUCK_TIME, FEWEST_RUNS = 10.0, 0.99, 0.01, 200
#: Part of a recording to identify from in which the motor's speed may hold one value other than zero (option).
STUCK_SHARE = 0.25
#: A speed of zero is that of a dead sensor where it lasts for this part of the recording, at a median torque of this
#: part of that while the motor turns (calibrated on the same: with twice the torque no dead sensor is found; a motor
#: that stands needs less than one that breaks away).
DEAD_SHARE, DEAD_TORQUE = 0.1, 0.7
#: A sample is far off where it jumps there and back by so many times what 99.9 % of the changes are below (calibrated
#: on the same).
SPIKE, USUAL_CHANGES = 300.0, 0.999
#: An angle that jumps by this share of its whole range in one sample has overflowed (option: 65 535 of 65 536 counts,
#: and what the drive turns in a sample).
WHOLE_RANGE = 0.8
#: A value that marks lost samples comes so often at least, and is so far from all others, over their whole range
#: (option: half of it; a motion has values on its way there).
FEWEST_MARKS, MARK_AWAY = 3, 0.5

Place = Callable[[int], str]


def places(rows: NDArray[np.intp], place: Place) -> str:
    """The first rows, and how many there are: ``line 7, line 9 (2 values)``."""
    more = ", …" if rows.size > 5 else ""
    return f"{', '.join(place(int(i)) for i in rows[:5])}{more} ({rows.size} values)"


def check_sizes(name: str, values: NDArray[np.float64], where: str, place: Place) -> list[Problem]:
    """Numbers that are finite, and larger than any drive's."""
    bad = np.flatnonzero(np.isfinite(values) & (np.abs(values) > LARGEST))
    if not bad.size:
        return []
    got = f"{values[bad[0]]:.4g} in SI units in {places(bad, place)}"
    remedy = "If it is every row, check unit, scale and offset; else give a window without these rows."
    return [Problem.error(f"{where}, {name}", got, f"at most {LARGEST:g}", remedy)]


def longest_run(values: NDArray[np.float64]) -> tuple[int, int]:
    """First row and length of the longest run of one value other than zero."""
    starts, lengths = _runs(values)
    lengths = np.where(values[starts] != 0.0, lengths, 0)
    longest = int(np.argmax(lengths))
    return int(starts[longest]), int(lengths[longest])


def stuck(name: str, values: NDArray[np.float64], recording: Recording, where: str) -> list[Problem]:
    """The warning that a measured speed or torque holds one value, and not zero, far longer than it usually does."""
    if not name.startswith(("speed_", "torque_shaft")) or name == "speed_reference":
        return []
    starts, lengths = _runs(values)
    moving = values[starts] != 0.0
    if np.count_nonzero(moving) < FEWEST_RUNS:
        return []
    usual = float(np.quantile(lengths[moving], USUAL_RUNS))
    first, length = longest_run(values)
    if length < STUCK_RUNS * usual or length * recording.dt < STUCK_TIME:
        return []
    got = f"{values[first]:.6g} in {length} rows on end, from {recording.time[first]:.6g} s on"
    expected = f"a value that changes (others last {usual:.0f} row{'s' if usual > 1.0 else ''} at most)"
    remedy = "Check whether the sensor or the logger hung there: leave that part out by window = [...]."
    return [Problem.warning(f"{where}, {name}", got, expected, remedy)]


def dead(signals: Mapping[str, NDArray[np.float64]], time: NDArray[np.float64], where: str) -> list[Problem]:
    """The warning that the motor's speed is exactly zero for long, under torques at which it turns elsewhere."""
    if not {"torque_motor", "speed_motor"} <= set(signals):
        return []
    torque, speed = np.abs(signals["torque_motor"]), signals["speed_motor"]
    starts, lengths = _runs(speed)
    lengths = np.where(speed[starts] == 0.0, lengths, 0)
    longest = int(np.argmax(lengths))
    first, length = int(starts[longest]), int(lengths[longest])
    turning = torque[speed != 0.0]
    if length < DEAD_SHARE * speed.size or not turning.size:
        return []
    held = float(np.median(torque[first : first + length]))
    if held < DEAD_TORQUE * float(np.median(turning)):
        return []
    got = f"exactly 0 in {length} rows on end, from {time[first]:.6g} s on, at torques as large as while it turns"
    remedy = "Check the encoder there: leave that part out by window = [...], unless the motor was held."
    return [Problem.warning(f"{where}, speed_motor", got, "a motor that turns under such torques", remedy)]


def spikes(name: str, values: NDArray[np.float64], recording: Recording, where: str) -> list[Problem]:
    """The warning that single samples jump far off and back."""
    change = np.diff(values)
    usual = float(np.quantile(np.abs(change), USUAL_CHANGES))
    there, back = change[:-1], change[1:]
    far = np.minimum(np.abs(there), np.abs(back)) > SPIKE * usual
    found = np.flatnonzero(far & (there * back < 0.0)) + 1
    if usual == 0.0 or not found.size:
        return []
    times = short_list((f"{recording.time[i]:.6g} s" for i in found), 5)
    got = f"{values[found[0]]:.4g} in one sample, and back in the next, at {times}"
    expected = f"changes near {usual:.3g} from sample to sample, as elsewhere"
    remedy = (
        "A lost bit of the logger? Leave these samples out by window = [...], or repair them in the file."
    )
    return [Problem.warning(f"{where}, {name}", got, expected, remedy)]


def sentinels(name: str, values: NDArray[np.float64], where: str) -> list[Problem]:
    """The warning that one value stands far off all others, again and again in single samples: a mark of lost ones."""
    for extreme in (float(values.max()), float(values.min())):
        rows = np.flatnonzero(values == extreme)
        rest = values[values != extreme]
        if rows.size < FEWEST_MARKS or not rest.size or np.any(np.diff(rows) == 1):
            continue
        away, spread = float(np.min(np.abs(rest - extreme))), float(np.ptp(rest))
        if away > MARK_AWAY * spread > 0.0:
            got = f"{extreme:g} in {rows.size} single samples, and nothing between it and the rest"
            remedy = (
                "A mark of lost samples? Fill them in the tool that recorded them, or give window = [...]."
            )
            return [Problem.warning(f"{where}, {name}", got, "a signal without gaps", remedy)]
    return []


def overflows(name: str, values: NDArray[np.float64], where: str) -> list[Problem]:
    """The warning that an angle jumps back by its whole range: a counter that begins anew in each turn."""
    span = float(np.ptp(values))
    rows = np.flatnonzero(np.abs(np.diff(values)) > WHOLE_RANGE * span)
    if not name.startswith("angle_") or rows.size == 0 or span == 0.0:
        return []
    got = f"an angle that jumps by {span:.4g} rad, its whole range, {rows.size} times"
    remedy = "The counter overflows: let it count on in the tool that records, or give the speed instead."
    return [Problem.warning(f"{where}, {name}", got, "an angle that goes on counting", remedy)]


def _runs(values: NDArray[np.float64]) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First rows and lengths of the runs of one value."""
    starts = np.concatenate([[0], np.flatnonzero(np.diff(values)) + 1])
    return starts, np.diff(np.append(starts, values.size))
