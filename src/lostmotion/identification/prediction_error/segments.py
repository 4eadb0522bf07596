"""One or more recordings, with gaps in them, as segments without gaps on one raster."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput, Problem
from ...recording import Recording
from . import problems as problem

Array = NDArray[np.float64]

#: Largest deviation of a time step from the usual step (option); from ``MISSING`` steps on, rows are missing (numerics:
#: half way to two).
RASTER, MISSING = 0.05, 1.5

#: Shortest segment that is used, s (numerics: twice the settling of the observer after a gap).
SHORTEST = 0.8

#: Sample times of recordings that are taken together may differ by this fraction (option: far below the raster).
SAME_RASTER = 1e-3


@dataclass(frozen=True, eq=False)
class Pieces:
    """Rows that are used, one segment after the other.

    Parameters
    ----------
    time : (n,) array, s
        As recorded; a further recording goes on one sample after the one before.
    signals : dict of name → (n,) array
    bounds : tuple of int
        First row of each segment, and n.
    dt : float, s
    left_out : float, s
        Time of rows with a NaN, and of segments that are too short.
    recordings : int
    """

    time: Array
    signals: dict[str, Array]
    bounds: tuple[int, ...]
    dt: float
    left_out: float
    recordings: int

    def joined(self, rows: int) -> Pieces:
        """``rows`` rows each taken as one: the mean of the torque after, of the count-averaged speed before it.

        For motor torque and motor speed. The rest of each segment is left out.
        """
        cut = [slice(a, a + (b - a) // rows * rows) for a, b in pairwise(self.bounds)]
        torque = [self.signals["torque_motor"][c].reshape(-1, rows).mean(axis=1) for c in cut]
        speed = []
        for c in cut:
            values = self.signals["speed_motor"][c]
            sums = np.cumsum(values)[::rows]
            speed.append(np.diff(sums, prepend=sums[0] - rows * values[0]) / rows)
        signals = {"torque_motor": np.concatenate(torque), "speed_motor": np.concatenate(speed)}
        time = np.concatenate([self.time[c][::rows] for c in cut])
        bounds = (0, *np.cumsum([t.size for t in torque]).tolist())
        return replace(self, time=time, signals=signals, bounds=bounds, dt=rows * self.dt)

    def problems(self) -> list[Problem]:
        """A warning if there are gaps."""
        gaps = len(self.bounds) - 1 - self.recordings
        if gaps <= 0 and self.left_out == 0.0:
            return []
        return [problem.gaps(len(self.bounds) - 1, self.recordings, self.left_out)]


def join(recordings: Sequence[Recording], names: Sequence[str]) -> Pieces:
    """Cut at NaN rows and missing rows, and put the segments one after the other.

    Raises
    ------
    InvalidInput
        If there is no recording, their sample times differ, a raster is not uniform, or no segment is long enough.
    """
    if not recordings:
        raise InvalidInput("recording", "none", "at least one", "Give a recording.")
    steps = [_step(recording.time) for recording in recordings]
    if max(steps) / min(steps) - 1.0 > SAME_RASTER:
        raise InvalidInput(
            "recording.time",
            f"sample times {steps} s",
            "one sample time",
            "Resample them to a common raster.",
        )
    # The mean step of a recording with missing rows is not its sample time.
    whole = len(recordings) == 1 and np.max(np.diff(recordings[0].time)) < MISSING * steps[0]
    dt = recordings[0].dt if whole else float(np.mean(steps))
    runs: list[list[slice]] = []
    times: list[Array] = []
    end = left_out = 0.0
    for recording, step in zip(recordings, steps, strict=True):
        _check_raster(recording.time, step)
        cut, lost = _runs(recording, names, step)
        runs.append(cut)
        left_out += lost
        shift = end - recording.time[0] if times else 0.0
        times += [recording.time[run] + shift for run in cut]
        end = float(recording.time[-1] + shift + step)
    if not times:
        raise InvalidInput(
            "recording",
            "no segment without a gap that is long enough",
            f"at least {SHORTEST} s",
            "Repair the gaps.",
        )
    signals = {
        name: np.concatenate([r[name][run] for r, cut in zip(recordings, runs, strict=True) for run in cut])
        for name in names
    }
    bounds = (0, *np.cumsum([time.size for time in times]).tolist())
    return Pieces(np.concatenate(times), signals, bounds, dt, left_out, len(recordings))


def _step(time: Array) -> float:
    """Mean of the steps at which no row is missing."""
    steps = np.diff(time)
    return float(np.mean(steps[steps < MISSING * np.median(steps)]))


def _check_raster(time: Array, step: float) -> None:
    ratio = np.diff(time) / step
    ratio = ratio[ratio < MISSING]
    if np.max(np.abs(ratio - 1.0)) > RASTER:
        raise InvalidInput(
            "recording.time",
            f"steps up to {100 * np.max(np.abs(ratio - 1.0)):.3g} % off",
            "a uniform raster within 5 %",
            "Resample it.",
        )


def _runs(recording: Recording, names: Sequence[str], step: float) -> tuple[list[slice], float]:
    """Rows of the segments that are long enough, and the time that is left out, s."""
    good = np.all(np.isfinite([recording[name] for name in names]), axis=0)
    after_gap = np.r_[False, np.diff(recording.time) > MISSING * step]
    edges = np.flatnonzero(np.diff(np.r_[False, good, False].astype(int)))
    runs = []
    for start, stop in edges.reshape(-1, 2):
        inner = start + np.flatnonzero(after_gap[start:stop])
        cuts = [start, *inner[inner > start].tolist(), stop]
        runs += [slice(int(a), int(b)) for a, b in zip(cuts, cuts[1:], strict=False)]
    # A recording in one segment is used whatever its length: what is too short altogether is reported elsewhere.
    kept = [run for run in runs if (run.stop - run.start) * step >= SHORTEST or len(runs) == 1]
    rows = sum(run.stop - run.start for run in kept)
    return kept, (len(recording) - rows) * step
