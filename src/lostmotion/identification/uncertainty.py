"""How well the parameters are known: statistics of the fit, and allowances for what the model leaves out."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from .gauss_newton import normal_equations

Array = NDArray[np.float64]

#: Blocks of the recording whose scores count as independent (chosen: 0.5 s each in 10 s, several times the
#: slowest time constant of the observer, and about as long as a speed level lasts).
BLOCKS = 20

#: The rest of a block's share in a parameter counts as at least this much (chosen: pulls grow fivefold at most).
LEAST_REST = 0.2

#: A spectral peak counts as an unmodelled mode if it stands above the noise by this fraction of the noise's
#: mean density (chosen: seven standard deviations of the spectrum's estimate over 10 s).
PEAK_HEIGHT = 0.5

#: And if its rms is more than this share of the rms of the torsional oscillation of the speed (chosen).
PEAK_SHARE = 0.005

#: Modes above this multiple of the torsional frequency are not looked for: they would add less than 1 %
#: (chosen), and an encoder's rounding makes tones there when the speed is steady.
HIGHEST_MODE = 15.0

#: Relative allowance for the damping if there is an unmodelled mode (chosen: on finer plants the fitted
#: damping was 20 to 50 % above that of the shaft, because the impacts feed energy into the mode).
DAMPING_ALLOWANCE = 0.5

#: With a joint piece on the shaft, what is allowed for in multiples of (pole / mode)²; 2 without (chosen: motor inertia
#: and stiffness are 0.5 to 1.3 % off then on finer plants, where (pole / mode)² is 1.8 %).
JOINT_ALLOWANCE = 1.0

#: Allowance for the lag if there is an unmodelled mode, samples (chosen: such a mode turns the phase as
#: well; in closed loop by up to 0.35 samples).
LAG_ALLOWANCE = 0.4


#: Allowance for the Coulomb torque if there is an unmodelled mode, so a plant finer than the model: friction is then
#: no straight line either (chosen: 0.1 to 1.5 % off on finer plants with a Stribeck rise).
FRICTION_ALLOWANCE = 0.015


@dataclass(frozen=True, eq=False)
class Blocks:
    """Normal equations of a fit, block by block of the recording.

    Parameters
    ----------
    hessians : (BLOCKS, p, p) array
    gradients : (p, BLOCKS) array
    """

    hessians: Array
    gradients: Array

    @classmethod
    def of(cls, jacobian: Array, residual: Array) -> Blocks:
        """From a Jacobian (p, n) and a residual (n,); a remainder of rows goes to the last blocks."""
        ends = np.linspace(0, residual.size, BLOCKS + 1).astype(int)
        parts = [normal_equations(jacobian[:, i:j], residual[i:j]) for i, j in pairwise(ends)]
        return cls(np.array([h for h, _ in parts]), np.array([g for _, g in parts]).T)

    @cached_property
    def step(self) -> Array:
        """(p,) Gauss–Newton step; zero where the residual does not tell a parameter at all."""
        hessian, scale = self._scaled(self.hessians.sum(axis=0))
        step = np.linalg.lstsq(hessian, -self.gradients.sum(axis=1) / scale, rcond=1e-10)[0]
        return np.asarray(step / scale)

    @cached_property
    def influences(self) -> Array:
        """(p, BLOCKS): how far each block pulls the estimate.

        A block that tells much of a parameter bends the fit towards itself; as in a jackknife its pull is taken as
        1/(1 − share) larger (Bell & McCaffrey 2002, "CR3").
        """
        hessian, scale = self._scaled(self.hessians.sum(axis=0))
        # A direction without information gets a huge variance instead of an error.
        root = np.linalg.cholesky(hessian + 1e-12 * np.eye(scale.size))
        inverse = np.linalg.inv(root)
        pulls = np.empty(self.gradients.shape)
        for block, own in enumerate(self.hessians):
            share, axes = np.linalg.eigh(inverse @ (own / np.outer(scale, scale)) @ inverse.T)
            weight = 1.0 / np.maximum(1.0 - share, LEAST_REST)
            score = axes.T @ (inverse @ (self.gradients[:, block] / scale))
            pulls[:, block] = -inverse.T @ (axes @ (weight * score)) / scale
        return pulls

    @staticmethod
    def _scaled(hessian: Array) -> tuple[Array, Array]:
        scale = np.sqrt(np.maximum(np.diag(hessian), 1e-300))
        return hessian / np.outer(scale, scale), scale


def covariance(influences: Array) -> Array:
    """(p, p) covariance of an estimate from what its blocks pull, (p, BLOCKS): valid for a residual of any colour."""
    centred = influences - influences.mean(axis=1, keepdims=True)
    return np.asarray(centred @ centred.T * BLOCKS / (BLOCKS - 1))


def sandwich(jacobian: Array, residual: Array) -> Array:
    """Covariance H⁻¹ S H⁻¹ of the parameters; valid for a residual of any colour.

    H = J Jᵀ, and S sums the outer products of the scores of ``BLOCKS`` blocks (White 1980, with blocks for
    the autocorrelation), each enlarged as ``Blocks.influences`` says.

    Parameters
    ----------
    jacobian : (p, n) array
    residual : (n,) array
    """
    return covariance(Blocks.of(jacobian, residual).influences)


def excess(value: Array, spread: Array, factor: float) -> Array:
    """What of (p,) values is more than chance: √(value² − (factor · standard deviation)²), or zero.

    Parameters
    ----------
    value : (p,) array
    spread : (p, BLOCKS) array
        What each block of the recording contributes to it.
    factor : float
        Half width of an interval in standard deviations.
    """
    chance = factor**2 * np.diag(covariance(spread))
    return np.asarray(np.sqrt(np.maximum(value**2 - chance, 0.0)))


def student_factor(p: int) -> float:
    """Half width of a 95 % interval in standard deviations, with p parameters estimated from the blocks."""
    from scipy.stats import t

    return float(t.ppf(0.975, BLOCKS - p))


def growth(residual: Array, reference: Array) -> tuple[float, float]:
    """How much larger the sum of squares of a residual is than that of a reference, both (n,).

    Returns
    -------
    (float, float)
        In multiples of the reference's mean sum over one of ``BLOCKS`` blocks; and the t statistic of the mean of the
        blocks' differences, which is small where a single block makes all of it.
    """
    length = residual.size // BLOCKS
    squares = [
        np.square(r[: length * BLOCKS]).reshape(BLOCKS, length).sum(axis=1) for r in (residual, reference)
    ]
    difference = squares[0] - squares[1]
    deviation = float(np.std(difference, ddof=1)) / np.sqrt(BLOCKS)
    typical = float(np.mean(squares[1]))
    mean = float(np.mean(difference))
    return BLOCKS * mean / max(typical, 1e-300), mean / max(deviation, 1e-300)


def shift(jacobian: Array, residual: Array) -> Array:
    """(p,) Gauss–Newton step that these innovations ask for.

    Zero where the innovations do not tell a parameter at all.
    """
    return Blocks.of(jacobian, residual).step


def unmodelled_mode(
    residual: Array, speed: Array, dt: float, count_averaged: bool, pole_frequency: float
) -> float | None:
    """Frequency (Hz) of the residual's peak above the torsional mode, if one stands out of the noise.

    The noise is white, or blue like the difference of rounded counts; its level is that of the upper half
    of the band.

    Parameters
    ----------
    residual, speed : (n,) arrays, rad/s
    dt : float, s
    count_averaged : bool
    pole_frequency : float, Hz
    """
    from scipy.signal import welch

    rows = min(1024, residual.size)
    frequency, power = welch(residual, fs=1.0 / dt, nperseg=rows)
    colour = 2.0 * np.sin(np.pi * frequency * dt) ** 2 if count_averaged else np.ones(frequency.size)
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
    (0.2 % at 100 Hz and 0.1 ms; about twice what exactly simulated recordings show), unless replicas have told it.

    Below its frequency such a mode changes the inertia and the stiffness seen at the torsional mode by the
    relative amount (pole / mode)², to first order; twice that is allowed (chosen, for 95 %) for motor
    inertia, stiffness and backlash. The total inertia is not touched, so the load inertia has the motor's
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
        Whether the model has a joint piece on the shaft: half of it is allowed for then.
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
