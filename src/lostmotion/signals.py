"""Test signals: steps, chirps, multisines, PRBS, band-limited noise, and the excitation of an identification run."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .argument_checks import checks_arguments, not_negative
from .errors import InvalidInput

Array = NDArray[np.float64]


def _length(duration: float, dt: float) -> int:
    samples = duration / dt if dt > 0.0 else math.nan
    if not math.isfinite(samples) or not math.isfinite(dt) or samples < 1.5:  # 1.5 rounds to two
        raise InvalidInput(
            "duration, dt",
            f"{duration} s, {dt} s",
            "finite, positive, at least two samples",
            "Lengthen the signal.",
        )
    return round(samples)


def _band(
    where: str, frequency: NDArray[np.floating[Any]], low: float, high: float, rms: float
) -> NDArray[np.bool_]:
    """The lines (Hz) of a spectrum from low to high, of which a signal of that RMS is made."""
    not_negative(f"{where}.low", low)
    not_negative(f"{where}.rms", rms)
    band = (frequency >= low) & (frequency <= high)
    if not band.any():
        raise InvalidInput(where, f"{low} … {high} Hz", "a band with at least one line", "Widen the band.")
    return np.asarray(band)


@checks_arguments
def steps(times: Sequence[float], values: Sequence[float], duration: float, dt: float) -> Array:
    """Piecewise constant signal: values[0] before times[0], then values[i + 1] from times[i] (s) on; (n,)."""
    if len(values) != len(times) + 1 or any(b <= a for a, b in zip(times, times[1:], strict=False)):
        raise InvalidInput(
            "steps",
            f"{len(times)} times, {len(values)} values",
            "rising times, one value more than times",
            "Give the value before the first time, too.",
        )
    # Half a sample of tolerance: a time on the sample grid begins its value exactly there.
    t = (np.arange(_length(duration, dt)) + 0.5) * dt
    return np.asarray(values, dtype=float)[np.searchsorted(np.asarray(times, dtype=float), t, side="right")]


@checks_arguments
def chirp(low: float, high: float, amplitude: float, duration: float, dt: float) -> Array:
    """Sine whose frequency rises linearly from low to high (Hz)."""
    low, high = not_negative("chirp.low", low), not_negative("chirp.high", high)
    t = np.arange(_length(duration, dt)) * dt
    return np.asarray(amplitude * np.sin(2.0 * np.pi * (low + 0.5 * (high - low) * t / duration) * t))


@checks_arguments
def multisine(low: float, high: float, rms: float, duration: float, dt: float, *, seed: int) -> Array:
    """All multiples of 1/duration from low to high (Hz) with equal amplitudes and random phases."""
    n = _length(duration, dt)
    frequency = np.fft.rfftfreq(n, dt)
    band = _band("multisine", frequency, low, high, rms)
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, frequency.size)
    signal = np.fft.irfft(np.where(band, np.exp(1j * phase), 0.0), n)
    return np.asarray(rms * signal / np.sqrt(np.mean(signal**2)))


@checks_arguments
def prbs(amplitude: float, shortest: float, duration: float, dt: float, *, seed: int) -> Array:
    """Random binary signal ±amplitude that may switch every `shortest` seconds."""
    n = _length(duration, dt)
    hold = max(1, round(not_negative("prbs.shortest", shortest) / dt))
    bits = np.random.default_rng(seed).integers(0, 2, -(-n // hold))
    return np.asarray(amplitude * (2.0 * np.repeat(bits, hold)[:n] - 1.0))


@checks_arguments
def noise(low: float, high: float, rms: float, duration: float, dt: float, *, seed: int) -> Array:
    """Gaussian noise with a flat spectrum between low and high (Hz) and nothing outside."""
    n = _length(duration, dt)
    frequency = np.fft.rfftfreq(n, dt)
    band = _band("noise", frequency, low, high, rms)
    rng = np.random.default_rng(seed)
    lines = rng.standard_normal(frequency.size) + 1j * rng.standard_normal(frequency.size)
    signal = np.fft.irfft(np.where(band, lines, 0.0), n)
    return np.asarray(rms * signal / np.sqrt(np.mean(signal**2)))


@checks_arguments
def excitation(
    duration: float = 10.0,
    dt: float = 1e-4,
    *,
    seed: int,
    inertia: float,
    coulomb: float,
    viscous: float,
    levels: Sequence[float] = (6.0, 30.0, -30.0, -6.0, 6.0, 30.0, -30.0, -6.0),
    ramp: float = 0.4,
    noise_rms: float = 4.0,
    band: tuple[float, float] = (2.0, 140.0),
    limit: float = 40.0,
) -> Array:
    """Motor torque that excites all parameters of a two-mass drivetrain with backlash, Nm, (n,).

    The torque for a speed profile with two levels in each direction (with nominal Coulomb and viscous friction and
    inertia; errors there only shift the levels), plus noise with content near zero and pole that reverses the shaft
    torque many times. Levels (rad/s), ramp (s), noise (Nm), band (Hz) and limit (Nm) are chosen
    for the paper's test rig: less noise and wider levels than 7 Nm, 10 and 25 rad/s halve the errors of friction.

    Parameters
    ----------
    inertia : float, kg m2
        Nominal total inertia.
    coulomb, viscous : float, Nm and Nm s/rad
        Nominal friction.
    """
    t = np.arange(_length(duration, dt)) * dt
    if not levels:
        raise InvalidInput("excitation.levels", "none", "speeds in rad/s", "Give at least one.")
    for name, value in (("inertia", inertia), ("coulomb", coulomb), ("viscous", viscous)):
        not_negative(f"excitation.{name}", value)
    not_negative("excitation.ramp", ramp, positive=True)
    not_negative("excitation.limit", limit, positive=True)
    hold = duration / len(levels)
    part = np.minimum((t / hold).astype(int), len(levels) - 1)
    target = np.array([0.0, *levels])
    progress = np.clip((t - part * hold) / ramp, 0.0, 1.0)
    change = target[part + 1] - target[part]
    speed = target[part] + change * progress
    acceleration = np.where(progress < 1.0, change / ramp, 0.0)
    torque = inertia * acceleration + viscous * speed + coulomb * np.sign(speed)
    return np.clip(torque + noise(*band, noise_rms, duration, dt, seed=seed), -limit, limit)
