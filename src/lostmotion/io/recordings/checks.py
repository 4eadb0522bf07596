"""Checks of a recording: errors that stop the reading, and warnings about what it cannot tell."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InputProblems, Problem
from ...recording import Recording
from .load_speed import check_load_speed
from .signal_faults import (
    LARGEST,
    STUCK_SHARE,
    Place,
    dead,
    longest_run,
    overflows,
    places,
    sentinels,
    spikes,
    stuck,
)
from .speed_faults import check_speeds
from .torque_and_speed import column_order, shows_wrong_sign, torque_agreement, unrelated

#: Fewest samples of a recording. Option: less than a few periods of any shaft at any sensible sample time.
MINIMUM_SAMPLES = 100
#: Fewest rows and shortest time (s) of a recording to identify from: what ``identify`` itself asks for (option).
IDENTIFIABLE_ROWS, IDENTIFIABLE_TIME = 1000, 0.5
#: Largest deviation of a step from the median step, as a fraction of it. Option: the error of a speed derived
#: with the mean step stays below it; logging clocks that drift by 2 % pass.
RASTER_TOLERANCE = 0.05
#: Share of samples at each end of the torque's distribution that is put down to noise. Option.
_NOISE_SHARE = 1e-3
#: Torque on the rare side counts as reversed from this fraction of the peak on. Option.
_REVERSAL = 0.01

#: Shortest and longest sample time of a recording, s (option: no logger of a drive is faster than 100 MHz, nor slower
#: than one row in 100 s).
SHORTEST_STEP, LONGEST_STEP = 1e-8, 100.0
#: Days since 1900 from 1954 to 2119, as a spreadsheet counts them (physics); and numbers from which on a step counts ns
#: and not µs (option: 50 ms in µs, 50 µs in ns).
DAYS, NANOSECONDS = (20_000.0, 80_000.0), 5e4
#: Longest sample time without a warning, s. Option: up to 50 kHz a raster in ms is seen; it tells nothing above 25 Hz.
SLOW = 0.02

#: Least correlation of swapped columns, and how far it lies above that of the columns as they are. Calibrated as
#: ``torque_and_speed.BLOCK``: the other correlation was -0.24 to 0 in all of these.
SWAPPED, SWAPPED_MARGIN = 0.4, 0.2
#: Agreement of torque and acceleration that shows a wrong sign (option: half of full disagreement).
OPPOSITE = -0.5


def check_finite(name: str, values: NDArray[np.float64], where: str, place: Place) -> list[Problem]:
    """NaN and infinite values, with their rows."""
    bad = np.flatnonzero(~np.isfinite(values))
    if not bad.size:
        return []
    got = f"NaN or infinity in {places(bad, place)}"
    remedy = "Give a window without them, or fill the gaps in the tool that recorded them."
    return [Problem.error(f"{where}, {name}", got, "a finite number in every row", remedy)]


def check_increasing(time: NDArray[np.float64], where: str, place: Place) -> list[Problem]:
    """Times that do not increase."""
    bad = np.flatnonzero(~(np.diff(time) > 0.0))
    if not bad.size:
        return []
    i = int(bad[0])
    got = f"{float(time[i + 1])!r} s after {float(time[i])!r} s in {place(i + 1)} ({bad.size} such steps)"
    remedy = "Check the column of the time; sort the rows, or give time = { sample_time = ... }."
    return [Problem.error(f"{where}, time", got, "strictly increasing times", remedy)]


def check_length(samples: int, where: str) -> list[Problem]:
    """Too few samples."""
    if samples >= MINIMUM_SAMPLES:
        return []
    remedy = "Record longer, widen the window."
    return [Problem.error(where, f"{samples} samples", f"at least {MINIMUM_SAMPLES}", remedy)]


def check_sample_time(time: NDArray[np.float64], where: str) -> list[Problem]:
    """A median step that no logger of a drive has: the time is in another unit."""
    step, duration = float(np.median(np.diff(time))), float(time[-1] - time[0])
    days = DAYS[0] < time[0] < DAYS[1] and duration < 1.0
    if SHORTEST_STEP <= step <= LONGEST_STEP and not days:
        return []
    got, unit = f"a sample time of {step:.4g} s", "ns" if step > NANOSECONDS else "us"
    if days:
        got, unit = (
            f"times near {time[0]:.9g} that last {duration:.3g} in all: days, as a spreadsheet counts",
            "d",
        )
    remedy = f'Say the unit of the time: time = {{ column = ..., unit = "{unit}" }}.'
    return [Problem.error(f"{where}, time", got, f"{SHORTEST_STEP:g} to {LONGEST_STEP:g} s", remedy)]


def check_raster(time: NDArray[np.float64], where: str, place: Place) -> list[Problem]:
    """Steps that differ from the median step by more than 5 % of it."""
    steps = np.diff(time)
    step = float(np.median(steps))
    bad = np.flatnonzero(np.abs(steps - step) > RASTER_TOLERANCE * step)
    if not bad.size:
        return []
    i = int(bad[0])
    got = (
        f"{bad.size} of {steps.size} steps off the median step of {step * 1e3:.6g} ms, the first in "
        f"{place(i + 1)}: {steps[i] * 1e3:.6g} ms; the longest: {steps.max() * 1e3:.6g} ms"
    )
    remedy = (
        f'Ask for resample = "{step * 1e3:.6g} ms", choose a window without gaps, or, if only the '
        "written times are rounded, give time = { sample_time = ... }."
    )
    return [Problem.error(f"{where}, time", got, "equal steps within 5 %", remedy)]


def stop_at_errors(problems: list[Problem]) -> None:
    """Raises what was found, warnings included, where an error is among it."""
    if any(problem.severity == "error" for problem in problems):
        raise InputProblems(problems)


@checks_arguments
def check_recording(recording: Recording) -> tuple[Problem, ...]:
    """The warnings about a recording: what its channels cannot tell, and what a slip in its columns would look like.

    Channels that are constant or stick, torque that never reverses, opposite signs, swapped columns, time in ms.

    Raises nothing; an empty tuple means that nothing was found.
    """
    where = str(recording.meta.get("file", "recording"))
    swapped = _swapped(recording, where)
    if swapped:  # what else is found in the two is found in the wrong one
        return (*_slow(recording, where), *swapped)
    found: list[Problem] = [*_slow(recording, where)]
    for name, values in recording.signals.items():
        if np.ptp(values) == 0.0:
            got = f"the constant {float(values[0])!r}"
            remedy = "Check that the channel was connected and recorded."
            found.append(Problem.warning(f"{where}, {name}", got, "a signal that changes", remedy))
        elif name in ("torque_motor", "torque_shaft") and not _reverses(values):
            got = f"a torque between {values.min():.4g} and {values.max():.4g} Nm that never reverses"
            remedy = "It does not identify the backlash: record with reversals of the torque."
            found.append(Problem.warning(f"{where}, {name}", got, "torque in both directions", remedy))
        found += stuck(name, values, recording, where)
        found += spikes(name, values, recording, where) or sentinels(name, values, where)
        found += overflows(name, values, where)
    found += dead(recording.signals, recording.time, where)
    found += _wrong_sign(recording, where)
    return (*found, *check_speeds(recording), *check_load_speed(recording))


def _swapped(recording: Recording, where: str) -> list[Problem]:
    follows, followed = column_order(recording)
    if followed <= max(SWAPPED, abs(follows) + SWAPPED_MARGIN):
        return []
    got = (
        f"a torque whose changes follow the speed (correlation {followed:.2f}), "
        f"not a speed whose changes follow the torque ({follows:.2f})"
    )
    remedy = "The two columns look swapped: exchange them in channels, or in the file's header."
    columns = f"{where}, torque_motor and speed_motor"
    return [Problem.warning(columns, got, "a speed that the torque accelerates", remedy)]


def _wrong_sign(recording: Recording, where: str) -> list[Problem]:
    agreement = torque_agreement(recording)
    if shows_wrong_sign(recording):
        agreement = min(agreement, column_order(recording)[0])
    if agreement > OPPOSITE:
        return []
    got = f"torque and acceleration of the motor of opposite sign (agreement {agreement:.2f})"
    expected = "acceleration in the direction of the torque (agreement near 1)"
    remedy = (
        "Set sign = -1 for torque_motor or for the motor's speed, or exchange the two if they are swapped."
    )
    return [Problem.warning(f"{where}, torque_motor", got, expected, remedy)]


def _slow(recording: Recording, where: str) -> list[Problem]:
    if recording.dt < SLOW * (1.0 - RASTER_TOLERANCE):
        return []
    got = f"a sample time of {recording.dt:.4g} s: {recording.time[-1] - recording.time[0]:.4g} s in all"
    expected = f"well below {SLOW} s: no mode of a shaft is seen in so few rows a second"
    remedy = 'If the time is in ms, say so: time = { column = ..., unit = "ms" }. Else record faster.'
    return [Problem.warning(f"{where}, time", got, expected, remedy)]


def rounded_to_decimals(values: NDArray[np.float64]) -> bool:
    """Whether the smallest step of numbers as written is 0.1, 0.01 …, and all are multiples of it.

    An encoder's step, 2π over counts and sample time, is such a number only by accident; whole numbers may be counts.
    """
    levels = np.unique(values[np.isfinite(values)][:20000])
    if levels.size < 3:
        return False
    smallest = float(np.min(np.diff(levels)))
    if not 1e-300 < smallest < 0.5 or np.max(np.abs(levels)) > LARGEST:
        return False
    step = 10.0 ** round(float(np.log10(smallest)))
    multiples = levels / step
    return bool(abs(smallest / step - 1.0) < 1e-3 and np.max(np.abs(multiples - np.round(multiples))) < 1e-3)


def check_identifiable(recording: Recording) -> tuple[Problem, ...]:
    """What forbids to identify from a recording: errors where its speed tells nothing, else warnings."""
    where = str(recording.meta.get("file", "recording"))
    return (
        *_too_short(recording, where),
        *_missing(recording, where),
        *(_standing(recording, where) or _unrelated(recording, where)),
    )


def _too_short(recording: Recording, where: str) -> list[Problem]:
    rows, duration = len(recording), len(recording) * recording.dt
    if rows >= IDENTIFIABLE_ROWS and duration >= IDENTIFIABLE_TIME:
        return []
    expected = f"at least {IDENTIFIABLE_ROWS} rows and {IDENTIFIABLE_TIME:g} s to identify from"
    remedy = (
        'Record longer, widen the window, or set use = "validate"; 10 s at 10 kHz are good. Or say the unit of the '
        'time: time = { column = ..., unit = "min" }.'
    )
    return [Problem.warning(where, f"{rows} rows, {duration:g} s", expected, remedy)]


def _missing(recording: Recording, where: str) -> list[Problem]:
    missing = [name for name in ("torque_motor", "speed_motor") if name not in recording]
    if not missing:
        return []
    example = (
        "the motor's current will do: channels.torque_motor = "
        '{ column = ..., unit = "A", scale = its torque constant }'
    )
    expected = (
        "torque and speed of the motor: without them the inertias, friction and backlash stay unknown, and no "
        "observer, no controller and no code is made"
    )
    remedy = f"Add the channel{'s' if len(missing) > 1 else ''}" + (
        f"; {example}." if "torque_motor" in missing else "; an angle will do: channels.angle_motor."
    )
    return [Problem.warning(where, f"no {' and no '.join(missing)}", expected, remedy)]


def _standing(recording: Recording, where: str) -> list[Problem]:
    """The error that the motor's speed holds one value in a large part of the recording."""
    if "speed_motor" not in recording:
        return []
    speed = recording["speed_motor"]
    first, length = (0, speed.size) if np.ptp(speed) == 0.0 else longest_run(speed)
    if length < STUCK_SHARE * speed.size:
        return []
    got = f"{speed[first]:.6g} in {length} of {speed.size} rows on end, from {recording.time[first]:.6g} s on"
    expected = "a speed that changes: nothing can be identified from one that hangs"
    remedy = (
        'Check the encoder and its channel; leave that part out by window = [...], or set use = "validate".'
    )
    return [Problem.error(f"{where}, speed_motor", got, expected, remedy)]


def _unrelated(recording: Recording, where: str) -> list[Problem]:
    largest = unrelated(recording)
    if largest is None or np.ptp(recording["torque_motor"]) == 0.0:  # a constant one is reported already
        return []
    got = f"a speed that does not follow the torque (correlation {largest:.2f} at most)"
    remedy = (
        "Check that both are of one recording, their columns, that the speed has its sign, and the torque is this "
        "motor's. Steady operation identifies nothing."
    )
    columns = f"{where}, torque_motor and speed_motor"
    return [Problem.warning(columns, got, "a motor that its torque accelerates", remedy)]


def _reverses(torque: NDArray[np.float64]) -> bool:
    low, high = np.quantile(torque, (_NOISE_SHARE, 1.0 - _NOISE_SHARE))
    level = _REVERSAL * max(abs(low), abs(high))
    return bool(low < -level and high > level)
