"""Total inertia: of the slow motion, in which the drive turns as one body, or the sum of motor and load.

Far below the zero, whatever shaft, gap and further inertias are like::

    u + τ·du/dt = J·a + c·d²a/dt² + M_c·sgn(ω) + d_v·ω + M_L        a = dω/dt

(u motor torque, ω motor speed; τ lag and delay, c the shaft's compliance at first order, M_L a constant load torque).
At a standstill friction holds whatever torque there is: torque, sign and M_L are left out there. A window over the
recording leaves the equation true, so its Fourier transform is linear in the parameters at each frequency. What is
left is coloured: at low frequencies a slow load torque, at high ones the torsion. Each frequency therefore counts by
the power that is left there, in the manner of Whittle's likelihood (Whittle 1953, Estimation and information in
stationary time series, Arkiv för Matematik 2, 423–434).
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ...statistics.block_covariance import sandwich, student_factor
from ...statistics.estimates import Interval
from ..gain_schedule import Stage
from ..identifiability import WIDEST, Told
from ..innovations import NAMES, Predictor
from .standstill import standstill

Array = NDArray[np.float64]
Spectrum = NDArray[np.complex128]

#: Upper edges of the bands, over the nameplate's zero (numerics: from where little but inertia shows to where the
#: compliance at first order is no longer enough), and over the sampling rate.
BANDS, BAND_DT = (0.1, 0.2, 0.4, 0.8), 0.2
#: Cut-off of the speed whose sign the friction takes, over the band's edge (numerics).
SIGN_CUTOFF = 4.0
#: Speed over its deviation below which a drive stands still, if for so many periods of the band's edge (numerics: one
#: that turns back is as slow, but soon moves again; on 456 development drives 0.003 to 0.01 and 0.2 to 2 do as well).
STANDS, STANDS_LONG = 3e-3, 0.5
#: Frequencies that a band needs, and that the power of what is left is averaged over: so many, or this share of all
#: below (numerics).
FEWEST, AVERAGED, AVERAGED_SHARE = 8, 12, 0.25
#: Rounds of fit and weights; least power that is left over the torque's, and least half width (numerics).
ROUNDS, LEAST_LEFT, EXACT = 8, 1e-12, 1e-9
#: Half width of the 95 % interval over what standard errors and bands say (calibrated on calibration drives 10200 to
#: 10320 and development drives 1000 to 1399, 2026-11-24, see docs/benchmarks/zoo.md; with standstills left out 96 % of
#: 407 development drives of 4267 to 4960 hold).
SURE = 2.9


def total_inertia(slow: tuple[float, float], stage: Stage, told: Told) -> tuple[float, Interval] | None:
    """Value and 95 % interval, kg m2; None where neither the fit nor the slow motion tells it.

    ``slow`` is what the slow motion says, see ``of_slow_motion``; the sum of motor and load, where both are
    identified, takes its place if it is known better. Where they contradict each other, the interval has room for both.
    """
    value, half = slow
    if {0, 1} <= set(stage.free):
        total, own = _sum(stage, told)
        apart = 0.0 if np.isinf(half) else abs(float(np.log(total / value)))
        apart = apart if apart > own + half else 0.0
        value, half = (
            (total, float(np.hypot(own, apart))) if own < half else (value, float(np.hypot(half, apart)))
        )
    return known(value, half)


def known(value: float, half: float) -> tuple[float, Interval] | None:
    """Value and interval, kg m2, of a half width in the logarithm; None where that is too wide."""
    if not half < WIDEST:
        return None
    return value, (float(value * np.exp(-half)), float(value * np.exp(half)))


def _sum(stage: Stage, told: Told) -> tuple[float, float]:
    """Inertia of motor and load together, kg m2, and the half width of its logarithm.

    By chance both may be off in opposite directions; by what the model lacks, in the same one.
    """
    places = [stage.free.index(NAMES.index(name)) for name in ("inertia_motor", "inertia_load")]
    inertias = np.exp(told.theta[:2])
    share = inertias / np.sum(inertias)
    covariance = student_factor(1) ** 2 * told.covariance[np.ix_(places, places)]
    rest = np.sqrt(np.maximum(told.half[places] ** 2 - np.diag(covariance), 0.0))
    return float(np.sum(inertias)), float(np.sqrt(share @ covariance @ share + (share @ rest) ** 2))


def of_slow_motion(predictor: Predictor, zero: float) -> tuple[float, float]:
    """Total inertia (kg m2) and half width of its logarithm; infinite: not known. ``zero`` is the nameplate's, Hz.

    The mean over bands, each by its certainty. What the bands disagree about is part of the half width: the shaft bends
    a wide band, friction that is no straight line a narrow one.
    """
    edges = {min(share * zero, BAND_DT / predictor.dt) for share in BANDS}
    found = [one for edge in edges if (one := _of_band(predictor, edge)) is not None]
    certain = np.array([one for one in found if one[1] < 1.0])
    if not certain.size or np.any(
        certain[:, 0] <= 0.0
    ):  # a negative inertia: the torque's sign, or an outside torque
        return float("nan"), float("inf")
    logarithm, half = np.log(certain[:, 0]), np.maximum(certain[:, 1], EXACT)
    weight = half**-2.0 / np.sum(half**-2.0)
    mean = weight @ logarithm
    return float(np.exp(mean)), float(SURE * np.sqrt(weight @ (half**2 + (logarithm - mean) ** 2)))


def _of_band(predictor: Predictor, edge: float) -> tuple[float, float] | None:
    """Inertia, kg m2, and half width over its size, from frequencies up to ``edge`` (Hz); None for too few of them."""
    spectra = [_spectra(predictor, rows, edge) for rows in predictor.pieces]
    columns, torque, frequency = (np.concatenate([one[i] for one in spectra], axis=-1) for i in range(3))
    if frequency.size < FEWEST:
        return None
    order = np.argsort(frequency, kind="stable")
    return _weighted_fit(columns[:, order], torque[order])


def _spectra(predictor: Predictor, rows: slice, edge: float) -> tuple[Spectrum, Spectrum, Array]:
    """Columns (6, m) with the acceleration first, torque (m,) and frequency (m,) of a windowed segment."""
    from scipy.signal import butter, sosfiltfilt

    torque, speed, dt = predictor.torque[rows], predictor.speed[rows], predictor.dt
    smooth = butter(2, min(SIGN_CUTOFF * edge, BAND_DT / dt), fs=1.0 / dt, output="sos")
    slow = sosfiltfilt(smooth, speed, padlen=min(int(3.0 / (edge * dt)), speed.size - 1))
    moves = ~standstill(np.abs(slow) <= STANDS * np.std(predictor.speed), int(STANDS_LONG / (edge * dt)))
    frequency = np.asarray(np.fft.rfftfreq(speed.size, dt), dtype=np.float64)
    inside = frequency <= edge
    window = np.hanning(speed.size) / np.sqrt(speed.size)
    signals = np.array([np.gradient(speed, dt), moves * np.sign(slow), speed, moves, moves * torque])
    acceleration, *others, seen = np.fft.rfft(signals * window)[:, inside]
    slope = 2j * np.pi * frequency[inside]
    columns: Spectrum = np.array([acceleration, *others, slope * acceleration, slope**2 * acceleration])
    return columns, np.asarray(seen), frequency[inside]


def _weighted_fit(columns: Spectrum, torque: Spectrum) -> tuple[float, float]:
    """The first coefficient, and its half width over its size, with each frequency by the power that is left there."""
    from scipy.stats import t

    bands = _averaged(torque.size)
    least = max(LEAST_LEFT * float(np.mean(np.abs(torque) ** 2)), 1e-300)  # none where all is a standstill
    weight = np.ones(torque.size)
    for _ in range(ROUNDS):
        jacobian, seen, scale = _real(columns * weight, torque * weight)
        found = np.linalg.lstsq(jacobian.T, seen, rcond=1e-12)[0]
        left = np.abs(torque - found / scale @ columns) ** 2
        power = np.concatenate(
            [np.full(end - first, np.mean(left[first:end])) for first, end in pairwise(bands)]
        )
        weight = 1.0 / np.sqrt(np.maximum(power, least))
    jacobian, seen, scale = _real(columns * weight, torque * weight)
    found = np.linalg.lstsq(jacobian.T, seen, rcond=1e-12)[0]
    rest = seen - found @ jacobian
    degrees = rest.size - found.size
    white = np.linalg.pinv(jacobian @ jacobian.T)[0, 0] * np.sum(rest**2) / degrees
    coloured = sandwich(jacobian, rest)[0, 0]
    half = max(float(t.ppf(0.975, degrees)) * np.sqrt(white), student_factor(1) * np.sqrt(coloured))
    return float(found[0] / scale[0]), float(half / max(abs(found[0]), 1e-300))


def _real(columns: Spectrum, torque: Spectrum) -> tuple[Array, Array, Array]:
    """Real and imaginary parts one after the other, each column of size one, and the sizes."""
    rows = np.ascontiguousarray(columns).view(np.float64)
    scale = np.maximum(np.linalg.norm(rows, axis=1), 1e-300)
    return rows / scale[:, None], np.ascontiguousarray(torque).view(np.float64), scale


def _averaged(count: int) -> list[int]:
    """Where the stretches of frequencies begin over which power is averaged, and the end."""
    bounds = [0]
    while bounds[-1] < count:
        bounds.append(min(count, bounds[-1] + max(AVERAGED, int(AVERAGED_SHARE * bounds[-1]))))
    if len(bounds) > 2 and bounds[-1] - bounds[-2] < AVERAGED:
        bounds.pop(-2)
    return bounds
