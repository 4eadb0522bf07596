"""A chain of inertias from measured frequencies: the paper's four equations, and their general form."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..argument_checks import checks_arguments, not_negative
from ..drivetrain import Drivetrain, Shaft
from ..errors import InvalidInput
from .torsional_model import DAMPING_RATIO

Floats = NDArray[np.float64]


@checks_arguments
def two_mass_from_frequencies(
    *, zero: float, pole: float, damping_ratio: float = DAMPING_RATIO, inertia_total: float
) -> Drivetrain:
    """The linear two-mass drivetrain with these four numbers (Fietzek & Rinderknecht, section II.2).

    Solves, with θ_e motor, θ_w load, k stiffness and d damping::

        2π·zero = √(k/θ_w)                  2π·pole = √(k·(1/θ_e + 1/θ_w))
        D = d/2·√((1/θ_e + 1/θ_w)/k)        inertia_total = θ_e + θ_w

    Parameters
    ----------
    zero, pole : float, Hz
        First zero and second pole (the first is at 0 Hz) of motor angle over motor torque; 0 < zero < pole.
    damping_ratio : float
    inertia_total : float, kg m²

    Returns
    -------
    Drivetrain
        Without backlash and friction.
    """
    _check_interlaced(np.array([zero]), np.array([pole]), inertia_total)
    inertia_motor = inertia_total * (zero / pole) ** 2
    inertia_load = inertia_total - inertia_motor
    stiffness = inertia_load * (2.0 * math.pi * zero) ** 2
    return Drivetrain.two_mass(
        inertia_motor=inertia_motor,
        inertia_load=inertia_load,
        stiffness=stiffness,
        damping=damping_ratio * stiffness / (math.pi * pole),
    )


@checks_arguments
def chain_from_frequencies(
    zeros: ArrayLike,
    poles: ArrayLike,
    *,
    inertia_total: float,
    damping_ratio: float = DAMPING_RATIO,
) -> Drivetrain:
    """The one linear chain of n inertias with these n − 1 zeros and n − 1 poles of motor angle over motor torque.

    The general form of the four equations: the continued fraction (Cauer's form) of the response, computed by Lanczos'
    recursion from the poles and their residues. For n = 2 it equals ``two_mass_from_frequencies``.

    Parameters
    ----------
    zeros, poles : (n − 1,) arrays, Hz
        Without the pole at 0 Hz; interlaced: zero < pole < zero < pole …
    inertia_total : float, kg m²
    damping_ratio : float
        Of every eigenmode, as close as one damper in each shaft allows.
    """
    not_negative("chain_from_frequencies.damping_ratio", damping_ratio)
    z, p = (np.asarray(f, dtype=float) for f in (zeros, poles))
    _check_interlaced(z, p, inertia_total)
    z2, p2 = (2.0 * np.pi * z) ** 2, (2.0 * np.pi * p) ** 2
    residues = [1.0 / inertia_total]
    for i, pole in enumerate(p2):
        others = np.delete(p2, i)
        residues.append(-float(np.prod(1.0 - pole / z2) / np.prod(1.0 - pole / others)) / inertia_total)
    diagonal, off_diagonal = _lanczos(np.concatenate([[0.0], p2]), np.sqrt(residues))
    inertias, stiffnesses = [1.0 / math.fsum(residues)], [0.0]
    for a, b in zip(diagonal, off_diagonal, strict=False):
        stiffness = a * inertias[-1] - stiffnesses[-1]
        inertias.append((stiffness / b) ** 2 / inertias[-1])
        stiffnesses.append(stiffness)
    return damped_chain(inertias, stiffnesses[1:], damping_ratio)


def damped_chain(inertias: ArrayLike, stiffnesses: ArrayLike, damping_ratio: float) -> Drivetrain:
    """The linear chain with non-negative dampers that bring each eigenmode as close to the ratio as possible."""
    from scipy.linalg import eigh
    from scipy.optimize import nnls

    inertias, stiffnesses = np.asarray(inertias, dtype=float), np.asarray(stiffnesses, dtype=float)
    n = len(inertias)
    twist = np.eye(n)[:-1] - np.eye(n)[1:]
    stiffness = twist.T @ np.diag(stiffnesses) @ twist
    squares, shapes = eigh(stiffness, np.diag(inertias))
    frequencies = np.sqrt(squares[1:])
    # Eigenmode r of unit modal mass: Σ d_i·(twist of shaft i)² = 2·D·ω_r; rows over ω_r: ratios are compared.
    rows = (twist @ shapes[:, 1:]).T ** 2 / frequencies[:, None]
    dampings, _ = nnls(rows, np.full(n - 1, 2.0 * damping_ratio))
    shafts = tuple(Shaft(float(k), float(d)) for k, d in zip(stiffnesses, dampings, strict=True))
    return Drivetrain(tuple(float(j) for j in inertias), shafts)


def _lanczos(eigenvalues: Floats, start: Floats) -> tuple[list[float], list[float]]:
    """Diagonal and off-diagonal of the Jacobi matrix of eigenvalues and first components, fully reorthogonalised."""
    basis = [start / np.linalg.norm(start)]
    diagonal, off_diagonal = [], []
    for _ in range(len(eigenvalues) - 1):
        image = eigenvalues * basis[-1]
        diagonal.append(float(basis[-1] @ image))
        for _twice in range(2):
            for vector in basis:
                image = image - (vector @ image) * vector
        off_diagonal.append(float(np.linalg.norm(image)))
        basis.append(image / off_diagonal[-1])
    return diagonal, off_diagonal


def _check_interlaced(zeros: Floats, poles: Floats, inertia_total: float) -> None:
    alike = zeros.ndim == 1 and zeros.shape == poles.shape and zeros.size > 0
    rising = np.concatenate([[0.0], np.column_stack([zeros, poles]).ravel()]) if alike else np.zeros(2)
    if not np.all(np.diff(rising) > 0.0) or not inertia_total > 0.0:
        raise InvalidInput(
            "zeros, poles, inertia_total",
            f"{zeros.tolist()} Hz, {poles.tolist()} Hz, {inertia_total!r} kg m2",
            "as many zeros as poles, interlaced from above 0 Hz: zero, pole, zero, …; a positive inertia",
            "At the place where the torque acts, a zero lies below each pole.",
        )
