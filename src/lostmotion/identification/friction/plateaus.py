"""Plateaus: where a drive turns at constant speed, by its set-point or by its motion."""

from __future__ import annotations

import numpy as np

from ...recording import Recording
from .result import Floats

#: First part of each plateau that is left out (option).
SETTLING = 0.4
#: Parts of a plateau whose scatter gives its margin (numerics: Student's factor is 2.4, hardly above that of many).
PARTS = 8
#: Samples of a plateau at least (numerics: three in each of the parts, after settling).
SHORTEST = 5 * PARTS

#: A plateau of the motion takes at least this part of the recording (option: at most a hundred speeds).
SHARE = 0.01
#: There the speed changes by less than this from one window to the next, and over the whole plateau after settling by
#: less than the second number, as parts of itself (numerics: an average over a plateau means its speed; ramps and slow
#: waves change by more).
QUIET, DRIFT = 0.02, 0.05
#: Windows in the shortest plateau (numerics).
WINDOWS = 4


def of_reference(recording: Recording, reference: str) -> list[tuple[float, float]]:
    """Where the set-point stands still at a speed other than 0."""
    r, t = recording[reference], recording.time
    edges = [0, *(np.flatnonzero(np.diff(r) != 0.0) + 1).tolist(), r.size]
    return [
        (float(t[a]), float(t[b - 1]))
        for a, b in zip(edges, edges[1:], strict=False)
        if b - a >= SHORTEST and r[a] != 0.0
    ]


def of_motion(recording: Recording, speed: str) -> list[tuple[float, float]]:
    """Where the speed itself stands still, without any set-point: its mean over one window is that over the next."""
    w, t = recording[speed], recording.time
    least = max(SHORTEST, round(SHARE * w.size))
    width = least // WINDOWS
    if w.size < 2 * width:
        return []
    total = np.concatenate([[0.0], np.cumsum(w)])
    mean: Floats = (total[width:] - total[:-width]) / width
    before, after = mean[:-width], mean[width:]
    quiet = np.concatenate(
        [[False], np.abs(after - before) < QUIET * np.abs(0.5 * (before + after)), [False]]
    )
    edges = np.flatnonzero(np.diff(quiet.astype(int)))
    # Row k of the means' comparison lies between rows k and k + 2·width of the recording.
    return [
        (float(t[a + width]), float(t[b + width - 1]))
        for a, b in edges.reshape(-1, 2)
        if b - a >= least and _stands_still(mean[a + width // 2 : b + width // 2])
    ]


def _stands_still(mean: Floats) -> bool:
    """Whether averages of the speed over a plateau hardly change once it has settled."""
    settled = mean[round(SETTLING * mean.size) :]
    return bool(np.ptp(settled) < DRIFT * abs(float(np.mean(settled))))
