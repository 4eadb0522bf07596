"""Averages over the periods of an excitation that repeats: PRBS, multisine."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from .spectra import Complexes, Floats

#: A period may miss a whole number of samples by this part of a sample, over the whole recording (numerics: a line in
#: the middle of the band then turns by a fortieth of a period).
PHASE = 0.1
#: Lines below this part of the strongest one's amplitude, or so many standard deviations of their own mean, are not
#: excited (numerics: far above rounding, below what any multisine or PRBS has within its band; by chance one line in
#: two hundred is).
EXCITED, SURE = 1e-3, 3.0


def rows(period: float, dt: float, size: int) -> int:
    """Samples in a period (s); raises InvalidInput if it is no whole number of them or does not fit three times."""
    length = round(period / dt)
    if length < 8 or size < 3 * length:
        expected = f"{8 * dt:g} … {size * dt / 3.0:g} s: the first of at least three periods settles"
        raise InvalidInput("frequency_response: period", f"{period:g} s", expected, "Record more periods.")
    if abs(period / dt - length) * (size // length) > PHASE:
        got = f"{period!r} s, {period / dt:.6g} samples"
        remedy = "Give the period that the drive played, or resample."
        raise InvalidInput("frequency_response: period", got, "a whole number of samples", remedy)
    return length


def spectra(signal: Floats, length: int) -> Complexes:
    """(periods, length // 2 + 1) spectra of all whole periods but the first, the last row of the recording included."""
    periods = signal.size // length - 1
    return np.fft.rfft(signal[signal.size - periods * length :].reshape(periods, length), axis=1)


def excited(x: Complexes) -> NDArray[np.bool_]:
    """Lines that the input's periods (periods, m) have in common."""
    amplitude, deviation = np.abs(x.mean(axis=0)), np.std(x, axis=0, ddof=1) / np.sqrt(len(x))
    return np.asarray((amplitude > EXCITED * np.max(amplitude)) & (amplitude > SURE * deviation))
