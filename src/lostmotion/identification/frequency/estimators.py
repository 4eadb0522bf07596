"""Estimates from segment spectra: direct (H1, H2, Hv) and joint input–output, each with its variance."""

from __future__ import annotations

from typing import Literal

import numpy as np

from .spectra import Complexes, Floats, gain_and_coherence

Method = Literal["H1", "H2", "Hv"]

#: Squared correlation of Hann's window with itself, shifted by half (Welch 1967): overlap reduces the independent
#: averages.
HANN_HALF_OVERLAP = 1.0 / 36.0


def independent_averages(segments: int) -> float:
    """Independent averages: n / (1 + 2·(1 − 1/n)·ρ²) for neighbours that overlap by half (Welch 1967)."""
    return segments / (1.0 + 2.0 * (1.0 - 1.0 / segments) * HANN_HALF_OVERLAP)


def direct(x: Complexes, y: Complexes, method: Method, averages: float) -> tuple[Complexes, Floats, Floats]:
    """Response, coherence and variance from segment spectra (segments, m); see ``frequency_response``."""
    xx, yy = (np.abs(x) ** 2).sum(axis=0), (np.abs(y) ** 2).sum(axis=0)
    xy = np.asarray((x.conj() * y).sum(axis=0), dtype=complex)
    gain, coherence = gain_and_coherence(xx, yy, xy)
    tiny = np.finfo(float).tiny
    share = np.sqrt(np.maximum(coherence, tiny))
    response = {"H1": gain * share, "H2": gain / share, "Hv": gain}[method]
    lost = (1.0 - coherence) / np.maximum(coherence, tiny)
    return response, coherence, np.abs(response) ** 2 * lost / max(averages - 1.0, tiny)


def joint(x: Complexes, y: Complexes, r: Complexes, averages: float) -> tuple[Complexes, Floats, Floats]:
    """The same through a reference r without noise of the loop: Sry/Srx."""
    rx = np.asarray((r.conj() * x).sum(axis=0), dtype=complex)
    response = (r.conj() * y).sum(axis=0) / np.where(rx == 0.0, np.finfo(float).tiny, rx)
    xx, yy = (np.abs(x) ** 2).sum(axis=0), (np.abs(y) ** 2).sum(axis=0)
    _, coherence = gain_and_coherence(xx, yy, np.asarray((x.conj() * y).sum(axis=0), dtype=complex))
    rest = (np.abs(y - response * x) ** 2).sum(axis=0)
    power = (np.abs(r) ** 2).sum(axis=0)
    return response, coherence, power * rest / np.maximum(np.abs(rx) ** 2, 1e-300) / max(averages - 1.0, 1e-9)
