"""H∞ observer with the nonlinear extension: the gain bounds the worst error instead of the mean one."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem
from ..arguments import mapping, number
from ..scale import scale_of, sized
from .kalman import SampledModel, covariances_of, predictor_gain, sampled_model

Array = NDArray[np.float64]

#: Weight of each error in the bound by default, 1/unit (option: 1 rad/s and 10 mrad weigh alike on the paper's rig; on
#: others by ``scale.scale_of``).
WEIGHTS: Mapping[str, float] = {"speed_load": 1.0, "twist": 100.0}

#: Attenuation level as a multiple of the smallest possible one; 1 makes the gain infinite, ∞ gives the Kalman observer
#: (calibrated on the virtual rigs 1 to 4: the load speed is 0.041, 0.034, 0.031 % of its range off with 1.05, 1.1, 1.2,
#: and with a load inertia 20 % too small 0.59, 0.75, 0.93 %; benchmarks/calibrations.py).
MARGIN = 1.1

#: Relative accuracy of the search for the smallest level (numerics).
TOLERANCE = 1.005


def h_infinity(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    weights: Mapping[str, float] | None = None,
    margin: float = MARGIN,
    process_covariance: Mapping[str, float] | None = None,
    measurement_covariance: Mapping[str, float] | None = None,
    speed_from_counts: bool = False,
    load_torque: bool = False,
    largest_innovation: Mapping[str, float] | None = None,
) -> DiscreteSystem:
    """H∞ observer of a two-mass drivetrain with backlash and Coulomb friction.

    The model and its nonlinear extension are those of ``kalman``; only the gain differs. With the noises w of process
    and sensors scaled by their covariances, it keeps::

        Σ |W (x − x̂)|²  <  γ² · Σ |w|²        for every w of finite energy

    where γ = ``margin`` times the smallest level for which such a gain exists. P and the gain follow from

        P = Φ P (I + (Cᵀ R⁻¹ C − γ⁻² Wᵀ W) P)⁻¹ Φᵀ + Q,    K = Φ P (I + (…) P)⁻¹ Cᵀ R⁻¹

    Parameters
    ----------
    drivetrain, measured, dt, process_covariance, measurement_covariance : as in ``kalman``
    speed_from_counts, load_torque, largest_innovation
        As in ``kalman``.
    weights : mapping of state → 1/unit, optional
        Weights of the errors in the bound; default ``WEIGHTS``.
    margin : float
        Above 1; larger gives a lower gain.

    Returns
    -------
    DiscreteSystem
        Inputs and outputs as those of ``kalman``.

    Raises
    ------
    InvalidInput
        For unknown names, a margin of 1 or less, and sensors from which the state is not observable.

    Notes
    -----
    Peter, Scholing & Orlik 2003, IEEE Trans. Industry Applications 39, 637–644 (a linear H∞ design with a nonlinear
    observer for a two-mass system with backlash); discrete equations: Simon 2006, Optimal State Estimation,
    section 11.3.
    """
    margin = number("h_infinity.margin", margin)
    if not (math.isfinite(margin) and margin > 1.0):
        raise InvalidInput("h_infinity.margin", repr(margin), "a number above 1", "Choose 1.1 to 10.")
    design = sampled_model(drivetrain, measured, dt, speed_from_counts, load_torque)
    q, r = covariances_of(design, process_covariance, measurement_covariance)
    w = _weight_rows(
        design, _weights(drivetrain) if weights is None else mapping("h_infinity.weights", weights)
    )
    level = margin * _smallest_level(design, q, r, w)
    gain = _gain(design, q, r, w, level)
    if gain is None:
        raise InvalidInput(
            "h_infinity", f"no gain at level {level:g}", "a solvable Riccati equation", "Raise the margin."
        )
    return design.assembly.system(
        design.measured,
        gain,
        design.c,
        name="h_infinity",
        limits=mapping("largest_innovation", largest_innovation),
    )


def _weights(drivetrain: Drivetrain) -> dict[str, float]:
    unit = {name: 1.0 / size for name, size in sized({n: 1.0 for n in WEIGHTS}, scale_of(drivetrain)).items()}
    return {name: value * unit[name] for name, value in WEIGHTS.items()}


def _weight_rows(design: SampledModel, weights: Mapping[str, float]) -> Array:
    unknown = sorted(set(weights) - set(design.model.states))
    values = {name: number(f"h_infinity.weights[{name!r}]", value) for name, value in weights.items()}
    bad = [name for name, value in values.items() if not (math.isfinite(value) and value > 0.0)]
    if unknown or bad or not weights:
        raise InvalidInput(
            "h_infinity.weights",
            f"{dict(weights)}",
            f"positive weights of {design.model.states}",
            "Name states.",
        )
    rows = np.zeros((len(weights), design.c.shape[1]))
    for row, (name, value) in zip(rows, weights.items(), strict=True):
        row[design.model.states.index(name)] = value
    return rows


def _gain(design: SampledModel, q: Array, r: Array, w: Array, level: float) -> Array | None:
    """The gain of one level, None where the level is too low."""
    from scipy.linalg import block_diag, solve_discrete_are

    phi, noise, r_d = design.step(design.model.A), design.noise(design.model.A, q), r / design.dt
    both = np.vstack([design.c, w])
    try:
        p = solve_discrete_are(phi.T, both.T, noise, block_diag(r_d, -(level**2) * np.eye(len(w))))
        information = design.c.T @ np.linalg.solve(r_d, design.c) - w.T @ w / level**2
        filtered = np.linalg.solve(np.eye(len(p)) + p @ information, p)
        gain = np.asarray(phi @ filtered @ design.c.T @ np.linalg.inv(r_d))
        radius = np.max(np.abs(np.linalg.eigvals(phi - gain @ design.c)))
    except np.linalg.LinAlgError:
        return None
    # A level is reached if P and the filtered P are covariances and the error decays.
    smallest = min(np.min(np.linalg.eigvalsh(0.5 * (m + m.T))) / np.max(np.abs(m)) for m in (p, filtered))
    return gain if smallest > -1e-9 and radius < 1.0 else None


def _smallest_level(design: SampledModel, q: Array, r: Array, w: Array) -> float:
    """The smallest level with a gain, by bisection of its logarithm; starts at the scale of the weights."""
    predictor_gain(design, design.model.A, q, r)  # raises if the state is not observable
    high = low = float(np.min(w[w > 0.0]))
    while _gain(design, q, r, w, high) is None:
        low, high = high, 8.0 * high
    while low == high or _gain(design, q, r, w, low) is not None:
        low, high = low / 8.0, low
    while high / low > TOLERANCE:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if _gain(design, q, r, w, middle) is None else (low, middle)
    return high
