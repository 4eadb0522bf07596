"""What is wrong with a recording, and what a user should know about an identification."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput, Problem
from ...memory import check_memory
from ...recording import Recording
from . import problems as problem
from .result import Prediction

#: Largest torque (Nm) and speed (rad/s) that are taken for real (option: a thousand times those of big drives).
LARGEST_VALUE = 1e8

#: Bytes that a row of a channel takes (numerics: eight Jacobians of eight columns stand side by side for the intervals;
#: measured are 0.5 kB).
MEMORY = 600

#: Correlation above which two parameters can hardly be separated (numerics: each interval is five times as wide as
#: with the other one known).
CORRELATED = 0.98

#: A value off the nameplate by more than this factor is worth a second look (option: just beyond the factor
#: of two that a start may be off).
FAR = 2.2

#: Innovations count as not white if the lower tenth of the band has more than so many times white noise's share of the
#: power (calibrated on the virtual rigs 1 and 2, ``benchmarks/calibrations.py``: half and double warn alike; white
#: noise has 1, count noise 0.05).
NOT_WHITE = 2.0

#: Innovations below this share of the speed's deviation are not looked at (option: below every real sensor's noise).
NEGLIGIBLE = 1e-4

#: Where the innovations are more than this share of the speed's deviation, the fit identifies nothing (calibrated on
#: the virtual rigs 1 and 2, ``benchmarks/calibrations.py``: half and double decide alike; with 12 bit at 10 kHz, which
#: have more, values came out 50 to 100 % wrong).
COARSE = 0.25

#: Rows are joined until the rounding of counts is at most this share of the speed's deviation (calibrated on
#: the virtual rigs 1 to 12: 14 bit at 10 kHz needs none).
FINE = 0.1

#: A torsional mode needs this many samples per period for the observer's discretisation (calibrated, data not
#: recorded).
SAMPLES_PER_PERIOD = 15.0


def check_recording(recording: Recording, names: Sequence[str]) -> None:
    """Raise InvalidInput for signals that no identification can work with; a NaN is a gap."""
    for name in names:
        values = recording[name]
        if np.any(np.isinf(values)):
            row = int(np.argmax(np.isinf(values)))
            raise InvalidInput(
                f"recording {name}",
                f"{values[row]} in row {row}",
                "finite numbers, or NaN for a gap",
                "Cut it out or repair it.",
            )
        values = values[np.isfinite(values)]
        if not values.size:
            raise InvalidInput(f"recording {name}", "NaN throughout", "a signal", "Check the channel.")
        largest = float(np.max(np.abs(values)))
        if largest > LARGEST_VALUE:
            raise InvalidInput(
                f"recording {name}", f"{largest:.3g}", f"SI values below {LARGEST_VALUE:g}", "Check the unit."
            )
        if np.ptp(values) == 0.0:
            raise InvalidInput(
                f"recording {name}",
                f"{values[0]} throughout",
                "a moving signal",
                "Check the channel, or excite it.",
            )


def check_length(rows: int, dt: float, min_rows: int, min_time: float) -> None:
    """Raise InvalidInput if too few rows can be used; dt and min_time in s."""
    if rows < min_rows or rows * dt < min_time:
        raise InvalidInput(
            "recording",
            f"{rows} rows, {rows * dt:g} s",
            f"at least {min_rows} rows and {min_time:g} s",
            "Record longer: 10 s at 10 kHz are good.",
        )


def check_size(rows: int, channels: int) -> None:
    """Raise InvalidInput if so many rows take more memory than the limit."""
    remedy = (
        "Identify from a part: window = [start, stop] in the TOML, recording.window(start, stop) in Python."
    )
    check_memory("recording", f"{rows} rows to identify from", MEMORY * rows * channels, remedy)


def count_step(speed: NDArray[np.float64]) -> float | None:
    """The step of which a speed takes only multiples, as the count difference of an encoder does, rad/s; else None.

    The greatest common divisor of the differences between its levels, by Euclid: of a fine encoder no two levels that
    occur are neighbours.
    """
    levels = np.unique(speed)  # of all rows: many a recording begins at rest
    if levels.size < 3:
        return None
    rounding = 1e-9 * float(np.max(np.abs(levels)))
    differences = np.diff(levels)
    rest = differences = differences[differences > rounding]
    step = 0.0
    while rest.size:
        step = float(np.min(rest))
        rest = np.abs(rest - step * np.round(rest / step))
        rest = rest[rest > max(rounding, 0.02 * step)]
    # Rounding has gone into the step; ever more counts at once tell it ever better.
    spans, most = np.sort(np.concatenate([differences, np.abs(levels)])), 3.0
    while step > 0.0:
        few = spans[spans < most * step]
        counts = np.round(few / step)
        step = float(counts @ few / (counts @ counts)) if np.any(counts) else step
        if few.size == spans.size:
            return step if np.max(np.abs(levels / step - np.round(levels / step))) < 0.02 else None
        most *= 3.0
    return None


def rows_to_join(speed: NDArray[np.float64], dt: float, pole_frequency: float) -> tuple[int, list[Problem]]:
    """How many rows to take as one, so that counts are fine enough, and a warning if that is more than one.

    No more than leave ``SAMPLES_PER_PERIOD`` for the torsional mode (pole_frequency, Hz).
    """
    step, deviation = count_step(speed), float(np.std(speed))
    if step is None or not deviation > 0.0:
        return 1, []
    wanted = int(np.ceil(step / np.sqrt(6.0) / (FINE * deviation)))
    rows = max(1, min(wanted, int(1.0 / (SAMPLES_PER_PERIOD * pole_frequency * dt))))
    if rows == 1:
        return 1, []
    return rows, [problem.rows_joined(step, deviation, rows)]


def too_coarse(level: float, deviation: float) -> bool:
    """Whether innovations of this rms leave too little of a speed's standard deviation."""
    return level > COARSE * deviation


def is_too_coarse(prediction: Prediction) -> bool:
    """Whether the noise of the motor speed leaves too little of it."""
    return too_coarse(prediction.levels.get("speed_motor", 0.0), prediction.deviation)


def low_frequency_excess(residual: NDArray[np.float64]) -> float:
    """Power of a residual in the lower tenth of the band, as a multiple of what white noise would have there.

    From 1 % of the band on: slower parts are what the observer corrects anyway.
    """
    from scipy.signal import welch

    frequency, power = welch(residual, nperseg=min(2048, residual.size))
    slow = (frequency >= 0.005) & (frequency < 0.05)
    return float(np.mean(power[slow]) / max(float(np.mean(power[1:])), 1e-300))


def warnings(
    start: Drivetrain,
    found: Drivetrain,
    total: float,
    sources: Mapping[str, str],
    names: tuple[str, ...],
    covariance: NDArray[np.float64],
    prediction: Prediction,
    converged: bool,
    dt: float,
    gap_bound: float | None = None,
) -> tuple[Problem, ...]:
    """Warnings about the result, each with a remedy; ``total`` is the inertia seen at low frequency, kg m2.

    ``gap_bound``: the largest gap that may be there, rad, where there is none in the model.

    First what may be wrong with all of it, then what single parameters lack.
    """
    problems = []
    if not 1.0 / FAR < total / found.inertia_total < FAR:
        problems.append(problem.inertia_contradicts_torque(total, found.inertia_total))
    problems += [
        problem.far_from_nameplate(name, getattr(found, name), getattr(start, name), FAR)
        for name in names
        if _is_far(name, start, found)
    ]
    problems += [
        problem.no_gap(gap_bound, start.backlash)
        if name == "backlash" and gap_bound is not None
        else problem.not_excited(name, getattr(found, name), getattr(start, name))
        for name, source in sources.items()
        if source == "not excited"
    ]
    problems += _correlated(names, covariance)
    if not converged:
        problems.append(problem.still_moving())
    problems += _of_prediction(prediction, bool(names))
    samples = 1.0 / (found.pole_frequency * dt)
    if samples < SAMPLES_PER_PERIOD:
        problems.append(problem.few_samples_per_period(samples, SAMPLES_PER_PERIOD))
    return tuple(problems)


def _of_prediction(prediction: Prediction, told: bool) -> list[Problem]:
    """What the innovations say about model and sensor; ``told``: whether anything is identified in spite of them."""
    problems = []
    excess = low_frequency_excess(prediction.residual)
    if excess > NOT_WHITE and prediction.rms > NEGLIGIBLE * float(np.std(prediction.speed_motor)):
        problems.append(problem.not_white(excess, NOT_WHITE))
    if not told and is_too_coarse(prediction):
        level = prediction.levels["speed_motor"]
        problems.append(problem.too_coarse(level, prediction.deviation, COARSE))
    if prediction.unmodelled_frequency is not None:
        problems.append(problem.unmodelled_mode(prediction.unmodelled_frequency))
    return problems


def _is_far(name: str, start: Drivetrain, found: Drivetrain) -> bool:
    before, after = getattr(start, name), getattr(found, name)
    # Damping, viscous friction and lag are rarely on a nameplate; what is there is a guess.
    rough = name in ("damping", "viscous", "lag")
    return not rough and before > 0.0 and not before / FAR <= after <= before * FAR


def _correlated(names: tuple[str, ...], covariance: NDArray[np.float64]) -> list[Problem]:
    deviation = np.sqrt(np.diag(covariance))
    correlation = np.abs(covariance / np.outer(deviation, deviation))
    np.fill_diagonal(correlation, 0.0)
    together = [name for name, row in zip(names, correlation, strict=True) if np.max(row) > CORRELATED]
    return [problem.correlated(together, np.max(correlation), CORRELATED)] if together else []
