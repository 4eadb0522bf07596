"""One signal over another by cross spectrum, its segments kept apart for a jackknife."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]


def segment_spectra(signal: Floats, length: int) -> Complexes:
    """Spectra of half-overlapping segments, each without its straight line, under a Hann window.

    Parameters
    ----------
    signal : (n,) array
    length : int
        Samples in a segment.

    Returns
    -------
    (segments, length // 2 + 1) complex array, in an arbitrary scale; no rows if the signal is too short.
    """
    if signal.size < length:
        return np.empty((0, length // 2 + 1), dtype=complex)
    segments = np.lib.stride_tricks.sliding_window_view(signal, length)[:: max(length // 2, 1)]
    line = np.linspace(-1.0, 1.0, length)
    slope = segments @ line / (line @ line)
    level = segments - segments.mean(axis=1, keepdims=True) - np.outer(slope, line)
    window = 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(length) / length)
    return np.asarray(np.fft.rfft(level * window, axis=1), dtype=complex)


def gain_and_coherence(xx: Floats, yy: Floats, xy: Complexes) -> tuple[Complexes, Floats]:
    """y over x and their coherence from (…, m) auto and cross spectra; xy = mean of conj(X)·Y.

    The modulus is the geometric mean √(Syy/Sxx) of the two usual estimates Sxy/Sxx and Syy/Syx, which
    noise in x and noise in y bias to opposite sides (Bendat & Piersol, Random Data, section 6.1).
    """
    tiny = np.finfo(float).tiny
    coherence = np.minimum(np.abs(xy) ** 2 / np.maximum(xx * yy, tiny), 1.0)
    gain = np.sqrt(yy / np.maximum(xx, tiny)) * np.exp(1j * np.angle(xy))
    return gain, coherence
