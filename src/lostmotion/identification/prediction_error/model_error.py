"""What the model leaves out: unmodelled eigenmodes in the innovations, and what they add to the intervals."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain

Array = NDArray[np.float64]

#: A spectral peak counts as an unmodelled mode if it stands above the noise by this fraction of the noise's
#: mean density (numerics: seven standard deviations of the spectrum's estimate over 10 s).
PEAK_HEIGHT = 0.5

#: And if its rms is more than this share of the rms of the torsional oscillation of the speed (calibrated on the
#: virtual rigs 1 and 2: half and double give the same; benchmarks/calibrations.py).
PEAK_SHARE = 0.005

#: Modes above this multiple of the torsional frequency are not looked for: they would add less than 1 %
#: (numerics), and an encoder's rounding makes tones there when the speed is steady.
HIGHEST_MODE = 15.0

#: Relative allowance for the damping if there is an unmodelled mode (calibrated on the virtual rigs 1 and 2,
#: ``benchmarks/calibrations.py``: 0.31 half widths off at most with half and double of it; the fitted damping was 20 to
#: 50 % above that of the shaft, because the impacts feed energy into the mode).
DAMPING_ALLOWANCE = 0.5

#: With an intermediate inertia on the shaft, what is allowed for in multiples of (pole / mode)²; 2 without (calibrated
#: on the virtual rigs 1 to 20, where motor inertia and stiffness are 0.5 to 1.3 % off then, and (pole / mode)² is
#: 1.8 %).
JOINT_ALLOWANCE = 1.0

#: Allowance for the lag if there is an unmodelled mode, samples (calibrated on the virtual rigs 1 and 2,
#: ``benchmarks/calibrations.py``: the largest error of damping, lag and Coulomb torque is 0.58 half widths with half of
#: it, 0.31 with it; such a mode turns the phase, in closed loop by up to 0.35 samples).
LAG_ALLOWANCE = 0.4


#: Allowance for the Coulomb torque if there is an unmodelled mode, so a plant finer than the model: friction is then
#: no straight line either (calibrated on the virtual rigs 1 and 2, ``benchmarks/calibrations.py``: 0.31 half widths
#: off at most with half and double of it; 1 to 20 were 0.1 to 1.5 % off).
FRICTION_ALLOWANCE = 0.015


def unmodelled_mode(
    residual: Array, speed: Array, dt: float, speed_from_counts: bool, pole_frequency: float
) -> float | None:
    """Frequency (Hz) of the residual's peak above the torsional mode, if one stands out of the noise.

    The noise is white, or blue like the difference of rounded counts; its level is that of the upper half
    of the band.

    Parameters
    ----------
    residual, speed : (n,) arrays, rad/s
    dt : float, s
    speed_from_counts : bool
    pole_frequency : float, Hz
    """
    from scipy.signal import welch

    rows = min(1024, residual.size)
    frequency, power = welch(residual, fs=1.0 / dt, nperseg=rows)
    colour = 2.0 * np.sin(np.pi * frequency * dt) ** 2 if speed_from_counts else np.ones(frequency.size)
    upper = (frequency > 0.25 / dt) & (frequency < 0.45 / dt)
    level = float(np.median(power[upper] / colour[upper]))
    band = (frequency > 2.5 * pole_frequency) & (frequency < min(HIGHEST_MODE * pole_frequency, 0.45 / dt))
    if np.count_nonzero(band) < 20:
        return None
    excess = np.where(band, power - level * colour, 0.0)
    peak = int(np.argmax(excess))
    if not excess[peak] > PEAK_HEIGHT * level:
        return None
    around = np.abs(frequency / frequency[peak] - 1.0) < 0.2
    torsional = (frequency > 0.2 * pole_frequency) & (frequency < 2.0 * pole_frequency)
    oscillation = np.sum(welch(speed, fs=1.0 / dt, nperseg=rows)[1][torsional])
    return float(frequency[peak]) if np.sum(excess[around]) > PEAK_SHARE**2 * oscillation else None


def model_allowance(
    names: tuple[str, ...],
    drivetrain: Drivetrain,
    dt: float,
    mode: float | None,
    further: bool = False,
    speed: float = np.inf,
    sampled: bool = False,
    joint: bool = False,
) -> Array:
    """Half widths (relative) for the sampling and for a mode that a two-mass model does not have.

    The observer holds gap and friction over a sample, an error of second order: (2π·pole·dt)²/2 is allowed
    (0.2 % at 100 Hz and 0.1 ms; about twice what exactly simulated recordings show), unless replicas have shown it.

    Below its frequency such a mode changes the inertia and the stiffness seen at the torsional mode by the
    relative amount (pole / mode)², to first order; twice that is allowed (chosen, for 95 %) for motor
    inertia, stiffness and backlash. The total inertia does not change, so the load inertia has the motor's
    allowance in kg m²; twice that with further channels, which show the load side through what the model leaves out
    (chosen: with the twist it was 1.1 to 1.3 % off on finer plants). The lag has ``LAG_ALLOWANCE``, the
    Coulomb torque ``FRICTION_ALLOWANCE``, and the viscous friction what makes up for that at the given speed.

    Parameters
    ----------
    names : tuple of str
    drivetrain : Drivetrain
        As fitted.
    dt : float, s
    mode : float or None, Hz
        Frequency of the mode; None: there is none, and nothing to allow for.
    further : bool
        Whether more than the motor speed is measured.
    speed : float, rad/s
        Usual speed of the recording.
    sampled : bool
        Whether the shift by the sampling is known and taken off.
    joint : bool
        Whether the model has an intermediate inertia on the shaft: half of it is allowed for then.
    """
    sampling = 0.0 if sampled else 0.5 * (2.0 * np.pi * drivetrain.pole_frequency * dt) ** 2
    if mode is None:
        return np.full(len(names), sampling)
    base = (JOINT_ALLOWANCE if joint else 2.0) * (drivetrain.pole_frequency / mode) ** 2
    allowances = {
        "inertia_motor": base,
        "stiffness": base,
        "backlash": base,
        "inertia_load": (2.0 if further else 1.0) * base * drivetrain.inertia_motor / drivetrain.inertia_load,
        "damping": DAMPING_ALLOWANCE,
        "lag": LAG_ALLOWANCE * dt / (drivetrain.lag + dt),
        "coulomb": FRICTION_ALLOWANCE,
        "viscous": FRICTION_ALLOWANCE * drivetrain.coulomb / max(drivetrain.viscous * speed, 1e-300),
    }
    return np.hypot([allowances.get(name, 0.0) for name in names], sampling)
