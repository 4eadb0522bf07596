"""tfestimate and mscohere by MATLAB's names, argument order and documented defaults."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...argument_checks import checks_arguments, not_negative
from ...errors import InvalidInput

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Segments into which MATLAB divides by default, half overlapping, and its least FFT length.
DEFAULT_SEGMENTS, LEAST_NFFT = 8, 256


@checks_arguments
def tfestimate(
    x: ArrayLike,
    y: ArrayLike,
    window: ArrayLike | int | None = None,
    noverlap: int | None = None,
    nfft: int | None = None,
    fs: float | None = None,
    *,
    estimator: Literal["H1", "H2"] = "H1",
) -> tuple[Complexes, Floats]:
    """Transfer function y over x by Welch's method, one-sided; ``[txy, f] = tfestimate(x, y, …)`` in MATLAB.

    Nothing is removed from the signals: no mean, no trend (Octave removes the mean by default).

    Parameters
    ----------
    x, y : (n,) arrays, real
    window : array or int, optional
        The window, or the length of a symmetric Hamming window. Default: Hamming, so long that eight segments with
        ``noverlap`` fit.
    noverlap : int, optional
        Samples by which segments overlap. Default: half a segment.
    nfft : int, optional
        FFT length; segments are padded with zeros, or wrapped where they are longer. Default: the next power of two
        from the segment length on, at least 256.
    fs : float, optional, Hz
        Sample rate. Without it frequencies are in rad/sample.
    estimator : {"H1", "H2"}
        Sxy/Sxx, right with noise in y alone, or Syy/Syx, right with noise in x alone.

    Returns
    -------
    txy : (nfft // 2 + 1,) complex array
    f : (nfft // 2 + 1,) array, Hz or rad/sample

    Raises
    ------
    InvalidInput
        Signals that are complex, of different length or not finite; window or overlap that do not fit.
    """
    if estimator not in ("H1", "H2"):
        raise InvalidInput("tfestimate: estimator", repr(estimator), "'H1' or 'H2'", "Choose one.")
    xx, yy, xy, f = _spectra(x, y, window, noverlap, nfft, fs)
    return (xy / xx if estimator == "H1" else yy / xy.conj()), f


@checks_arguments
def mscohere(
    x: ArrayLike,
    y: ArrayLike,
    window: ArrayLike | int | None = None,
    noverlap: int | None = None,
    nfft: int | None = None,
    fs: float | None = None,
) -> tuple[Floats, Floats]:
    """Magnitude-squared coherence abs(Sxy)²/(Sxx·Syy), one-sided; arguments as those of ``tfestimate``.

    Returns
    -------
    cxy, f : (nfft // 2 + 1,) arrays
    """
    xx, yy, xy, f = _spectra(x, y, window, noverlap, nfft, fs)
    return np.abs(xy) ** 2 / (xx * yy), f


def _spectra(
    x: ArrayLike,
    y: ArrayLike,
    window: ArrayLike | int | None,
    noverlap: int | None,
    nfft: int | None,
    fs: float | None,
) -> tuple[Floats, Floats, Complexes, Floats]:
    signals = [np.asarray(v) for v in (x, y)]
    n = signals[0].size
    alike = all(v.ndim == 1 and v.size == n and np.isrealobj(v) and np.all(np.isfinite(v)) for v in signals)
    if not alike or n == 0:
        raise InvalidInput(
            "tfestimate, mscohere: x, y",
            f"shapes {signals[0].shape} and {signals[1].shape}",
            "two real, finite vectors of one length",
            "Resample or cut them.",
        )
    values, overlap = _window(window, noverlap, n)
    length = values.size
    points = max(LEAST_NFFT, 2 ** math.ceil(math.log2(length))) if nfft is None else int(nfft)
    if not 1 <= length <= n or not 0 <= overlap < length or points < 1:
        raise InvalidInput(
            "tfestimate, mscohere",
            f"a window of {length} samples, noverlap {overlap}, nfft {points}, signals of {n}",
            "a window no longer than the signals, an overlap shorter than it, a positive nfft",
            "noverlap counts samples.",
        )
    a, b = (_segment_spectra(np.asarray(v, dtype=float), values, overlap, points) for v in signals)
    rate = 2.0 * np.pi if fs is None else not_negative("tfestimate, mscohere: fs", fs, positive=True)
    xy = np.asarray((a.conj() * b).sum(axis=0), dtype=complex)
    frequency = np.arange(points // 2 + 1) * rate / points
    return (np.abs(a) ** 2).sum(axis=0), (np.abs(b) ** 2).sum(axis=0), xy, frequency


def _window(window: ArrayLike | int | None, noverlap: int | None, n: int) -> tuple[Floats, int]:
    if window is None:
        half = DEFAULT_SEGMENTS - 1
        length = (
            int(n / (0.5 * half + 1.0)) if noverlap is None else (n + half * noverlap) // DEFAULT_SEGMENTS
        )
        values = np.hamming(max(length, 1))
    elif np.ndim(window) == 0:
        size = float(np.asarray(window))
        if not 1.0 <= size <= n:
            raise InvalidInput(
                "tfestimate, mscohere: window", f"{size:g} samples", f"1 to {n}", "Take a shorter one."
            )
        values = np.hamming(int(size))
    else:
        values = np.asarray(window, dtype=float).ravel()
    if not np.all(np.isfinite(values)):
        raise InvalidInput("tfestimate, mscohere: window", "NaN or infinity", "finite numbers", "Check it.")
    return values, values.size // 2 if noverlap is None else int(noverlap)


def _segment_spectra(signal: Floats, window: Floats, overlap: int, nfft: int) -> Complexes:
    pieces = np.lib.stride_tricks.sliding_window_view(signal, window.size)[:: window.size - overlap] * window
    if window.size > nfft:
        # MATLAB's datawrap: samples beyond nfft are added from the start again.
        padded = np.pad(pieces, ((0, 0), (0, -window.size % nfft)))
        pieces = padded.reshape(len(pieces), -1, nfft).sum(axis=1)
    return np.asarray(np.fft.rfft(pieces, nfft, axis=1), dtype=complex)
