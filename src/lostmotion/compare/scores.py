"""Score of one observer in one experiment."""

from __future__ import annotations

import time

import numpy as np
from numpy.typing import NDArray

from ..metrics import rmse, signal_range
from ..recording import Recording
from .contestants import Runs
from .experiment import Experiment

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Score = dict[str, float | None]

#: The estimate counts as "gap" where its shaft torque is below this, Nm (option: resolution of a torque sensor).
GAP_TORQUE = 0.5
#: An estimated impact belongs to a true one if it lies within this time of it, s (option).
IMPACT_WINDOW = 5e-3
#: Shorter openings of the joint count neither as gap nor as impact, s (option: three periods of the
#: joint's own eigenmode).
SHORTEST_GAP = 2e-3
#: The backlash estimate is the mean over this last part of the experiment (option).
LAST_PART = 0.1

#: Replaces estimates that are not finite or larger: a failed observer must not gain by it (option).
LARGEST = 1e9
#: An observer has failed from this error on, as a fraction of range (option: the middle of the range has half of it).
FAILED = 1.0

SIGNALS = ("speed_load", "torque_shaft", "twist_elastic")
#: Every number of a score; None where an observer does not estimate it.
METRICS = (*SIGNALS, "f1_gap", "impact_delay", "impacts_found", "backlash_error", "time_per_sample")


def score(observer: Runs, data: Experiment) -> Score:
    """RMSE of the signals as fraction of range, F1 of the gap, impacts, backlash, time per sample (s).

    ``torque_sensor``, 1.0 or 0.0, says whether the observer reads the shaft's torque sensor.
    """
    recording = data.recording.only(*observer.inputs)
    before = time.process_time()
    estimate = observer.run(recording)
    spent = (time.process_time() - before) / len(recording)
    rows = data.judged
    result: Score = {**dict.fromkeys(METRICS), "time_per_sample": spent}
    result["torque_sensor"] = float("torque_shaft" in observer.inputs)
    for signal in SIGNALS:
        if f"{signal}_estimated" in estimate:
            true = data.truth[signal][rows]
            guess = _bounded(estimate[f"{signal}_estimated"][rows])
            result[signal] = rmse(guess, true) / signal_range(true)
    says = _says_gap(estimate, rows)
    if says is not None:
        open_, claimed = (
            _without_short(m, SHORTEST_GAP, recording.dt) for m in (data.truth["gap"][rows] > 0.5, says)
        )
        result["f1_gap"] = _f1(claimed, open_)
        result["impact_delay"], result["impacts_found"] = _impacts(claimed, open_, recording.dt)
    if "backlash_estimated" in estimate:
        last = estimate["backlash_estimated"][-max(1, round(LAST_PART * len(recording))) :]
        result["backlash_error"] = abs(float(np.mean(_bounded(last))) / data.backlash - 1.0)
    return result


def refused() -> Score:
    """Score of an observer that cannot be made for this drive and sample time: it has failed."""
    return {**dict.fromkeys(METRICS), **dict.fromkeys(SIGNALS, LARGEST)}


def _bounded(estimate: Array) -> Array:
    """Numbers within ±LARGEST; NaN becomes LARGEST: a failure must not look like a zero."""
    return np.clip(np.nan_to_num(estimate, nan=LARGEST), -LARGEST, LARGEST)


def _says_gap(estimate: Recording, rows: slice) -> Mask | None:
    """Where the observer reports a gap: by its own probability, or by its shaft torque."""
    if "probability_gap" in estimate:
        return np.asarray(estimate["probability_gap"][rows] > 0.5)
    if "torque_shaft_estimated" in estimate:
        return np.asarray(np.abs(estimate["torque_shaft_estimated"][rows]) < GAP_TORQUE)
    return None


def _runs(mask: Mask) -> NDArray[np.int64]:
    """(n, 2) first index and index after the last of every run of True."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return edges.reshape(-1, 2).astype(np.int64)


def _without_short(mask: Mask, shortest: float, dt: float) -> Mask:
    kept = np.zeros(mask.size, dtype=bool)
    for first, after in _runs(mask):
        if (after - first) * dt >= shortest:
            kept[first:after] = True
    return kept


def _f1(guess: Mask, truth: Mask) -> float | None:
    both, total = np.count_nonzero(guess & truth), np.count_nonzero(guess) + np.count_nonzero(truth)
    return float(2.0 * both / total) if total else None


def _impacts(guess: Mask, truth: Mask, dt: float) -> tuple[float | None, float | None]:
    """Median time by which impacts are found late (s, either sign counts as positive), and the fraction found."""
    real = np.array([after for _, after in _runs(truth) if after < truth.size], dtype=float)
    found = np.array([after for _, after in _runs(guess) if after < guess.size], dtype=float)
    if real.size == 0:
        return None, None
    if found.size == 0:
        return None, 0.0
    nearest = found[np.argmin(np.abs(found[:, None] - real), axis=0)]
    delay = np.abs(nearest - real) * dt
    hit = delay <= IMPACT_WINDOW
    return (float(np.median(delay[hit])) if hit.any() else None), float(np.mean(hit))
