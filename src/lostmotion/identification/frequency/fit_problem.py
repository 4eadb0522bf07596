"""The weighted residual of trial two-mass drivetrains against a measured response, its minimum and its covariance."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from .response import FrequencyResponse
from .two_mass_response import two_mass_response

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Fitted by their logarithms, because they are positive; the others, which may be zero, as they are.
LOGARITHMIC = ("inertia_motor", "inertia_load", "stiffness", "damping")
NAMES = (*LOGARITHMIC, "viscous", "delay")
#: Lower bound on 1 − coherence (numerics): a linear model is never better than that, and no line outweighs all others.
COHERENCE_FLOOR = 1e-3
#: Residuals beyond this many standard deviations (by their median) are weighted linearly instead of squared (numerics:
#: of normal ones 1 % are).
ROBUST = 2.5
#: Correlation of the estimate between neighbouring lines reaches this far (Hann's window: two lines) (numerics).
CORRELATED_LINES = 4
#: Number of successive fits, each with the residual scale (and the images) of the one before (numerics).
PASSES = 4
#: Weight of the parameter that is not identifiable and kept from the start (numerics: it stays to about 1e-6).
KEPT_WEIGHT = 1e6
#: Factor on a variance by the correlation of neighbouring lines under Hann's window: 1 + 2·((2/3)² + (1/6)²).
#: (Numerics.)
NEIGHBOURS = 1.944
#: Lines over which coherence is averaged, and multiple of its mean by chance, 1/averages, that counts as clear
#: (numerics: the mean over 21 lines, of which about half are independent, scatters by 30 % by chance).
NEIGHBOURHOOD, CLEARLY = 21, 3.0
#: Lines at either end into which Hann's window smears what lies beyond the band (numerics).
SMEARED = 2
#: Grid of the search for a start: zeros, poles, damping ratio (numerics).
SEARCH_POINTS, SEARCH_DAMPING = 40, 0.05


def coherent_band(measured: FrequencyResponse) -> tuple[float, float]:
    """From the first to the last line whose neighbourhood is clearly more coherent than unrelated signals are."""
    lines = min(NEIGHBOURHOOD, measured.frequency.size)
    mean = np.convolve(measured.coherence, np.full(lines, 1.0 / lines), mode="same")
    clear = np.flatnonzero(mean > CLEARLY / measured.averages)
    if clear.size == 0:
        raise InvalidInput(
            "two_mass_fit",
            f"no coherence between {measured.input} and {measured.output}",
            "a response that the input causes",
            "Excite more, record longer, or check that the channels belong together.",
        )
    return float(measured.frequency[clear[0]]), float(measured.frequency[clear[-1]])


class WeightedResponse:
    """The weighted residual of a trial drivetrain."""

    def __init__(
        self, measured: FrequencyResponse, keep: NDArray[np.bool_], held: tuple[str, float] | None
    ) -> None:
        self.held = held
        self.measured, self.frequency, self.response = (
            measured,
            measured.frequency[keep],
            measured.response[keep],
        )
        coherence = np.maximum(measured.coherence[keep], 1e-12)
        floor = np.abs(self.response) ** 2 / coherence * COHERENCE_FLOOR / max(measured.averages - 1.0, 1.0)
        self.sigma = np.sqrt(np.maximum(measured.variance[keep], floor))

        self.s = np.asarray(2j * np.pi * self.frequency, dtype=complex)
        self.images = np.zeros_like(self.s)

    def images_of(self, theta: Floats) -> Complexes:
        """Contribution of the sampling images; so smooth in the parameters that it is updated between fits only."""
        parameters, how = parameters_of(theta), self.measured.sampling
        return how.images(lambda s: two_mass_response(parameters, how.source, s), self.frequency)

    def model(self, theta: Floats) -> Complexes:
        """The trial's response as measured, (m,)."""
        how = self.measured.sampling
        source = two_mass_response(parameters_of(theta), how.source, self.s)
        return np.asarray((source + self.images) * self.s**how.power, dtype=complex)

    def residual(self, theta: Floats) -> Complexes:
        """Measured − model in standard deviations of the measured response, (m,)."""
        return np.asarray((self.response - self.model(theta)) / self.sigma, dtype=complex)

    def kept(self, theta: Floats) -> float:
        """Weighted distance from the inertia kept from the start; 0 where nothing is kept."""
        if self.held is None:
            return 0.0
        name, value = self.held
        inertia = math.exp(theta[0]) if name == "inertia_motor" else float(np.exp(theta[:2]).sum())
        return KEPT_WEIGHT * math.log(inertia / value)

    def search(self) -> Floats:
        """Best of a grid of zeros and poles, the total inertia from the weighted mean of response over model."""
        low, high = max(self.frequency[0], 1e-3), self.frequency[-1]
        raster = np.geomspace(low, high, SEARCH_POINTS)
        best: dict[str, float] = {}
        cost = math.inf
        thin = slice(None, None, max(1, self.frequency.size // 400))
        s = np.asarray(self.s[thin], dtype=complex)
        measured, sigma = self.response[thin], self.sigma[thin]
        power = self.measured.sampling.power
        for i, zero in enumerate(raster):
            for pole in raster[i + 1 :]:
                trial = unit_drivetrain(zero, pole)
                shape = two_mass_response(trial, self.measured.sampling.source, s) * s**power
                # On a logarithmic scale: a missed resonance costs as much as a missed zero.
                scale = np.exp(np.median(np.log(np.abs(measured / shape))))
                error = np.abs(np.log(np.abs(measured / (scale * shape))))
                total = float(
                    np.mean(np.minimum(error, 1.0) * np.minimum(1.0, np.abs(measured) / sigma / 3.0))
                )
                if total < cost:
                    best, cost = {**trial, "scale": float(scale)}, total
        if not best:
            raise InvalidInput(
                "two_mass_fit", "no finite response", "a measured response", "Check the signals."
            )
        inertia = 1.0 / best.pop("scale")
        return theta_of({name: value * inertia for name, value in best.items()} | {"delay": 0.0})

    def fit(self, theta: Floats, free: Sequence[str] = NAMES) -> tuple[Floats, Floats, Complexes]:
        """The best parameters from theta on, with the free ones' Jacobian (zero for the others) and the residual."""
        from scipy.optimize import least_squares

        places = [NAMES.index(name) for name in free]

        def whole(part: Floats) -> Floats:
            full = theta.copy()
            full[places] = part
            return full

        def both(part: Floats) -> Floats:
            t = whole(part)
            r = self.residual(t)
            return np.concatenate([r.real, r.imag, [self.kept(t)]])

        scales = np.array([1.0, 1.0, 1.0, 1.0, math.exp(theta[0]) * 10.0, 1e-3])[places]
        for _ in range(PASSES):
            self.images = self.images_of(theta)
            unit = self.deviation(theta)
            found = least_squares(
                both, theta[places], x_scale=scales, loss="soft_l1", f_scale=ROBUST * unit, max_nfev=200
            )
            theta = whole(found.x)
        jacobian = np.zeros((2 * self.s.size + 1, len(NAMES)))
        jacobian[:, places] = jacobian_of(both, theta[places], scales)
        return theta, jacobian, self.residual(theta)

    def cost(self, theta: Floats, deviation: float) -> float:
        """Twice the negative logarithm of the likelihood, robust as in ``fit``, without the lines at the ends.

        ``deviation``: of one part of the residual.
        """
        self.images = self.images_of(theta)
        r = self.residual(theta)[SMEARED:-SMEARED]
        squares = (np.concatenate([r.real, r.imag]) / (ROBUST * deviation)) ** 2
        return float(2.0 * ROBUST**2 * np.sum(np.sqrt(1.0 + squares) - 1.0))

    def deviation(self, theta: Floats) -> float:
        """Standard deviation of one part of the residual, from its median."""
        return max(float(np.median(np.abs(self.residual(theta)))) / 1.1774, 1e-9)


def covariance_of(jacobian: Floats, residual: Complexes) -> Floats:
    """Sandwich: outside the curvature, inside the scores, neighbouring lines correlated (Newey & West)."""
    m = residual.size
    real, imag, held = jacobian[:m], jacobian[m : 2 * m], jacobian[2 * m :]
    deviation = np.median(np.abs(residual)) / 1.1774
    weight = 1.0 / np.sqrt(1.0 + (np.abs(residual) / (ROBUST * max(deviation, 1e-300))) ** 2)
    bread = (real * weight[:, None]).T @ real + (imag * weight[:, None]).T @ imag + held.T @ held
    scores = real * (weight * residual.real)[:, None] + imag * (weight * residual.imag)[:, None]
    meat = scores.T @ scores
    for lag in range(1, CORRELATED_LINES + 1):
        cross = scores[lag:].T @ scores[:-lag]
        meat += (1.0 - lag / (CORRELATED_LINES + 1)) * (cross + cross.T)
    inverse = np.linalg.pinv(bread, hermitian=True, rcond=1e-14)
    sandwich = inverse @ meat @ inverse * m / max(m - len(NAMES), 1)
    # A few lines of high leverage reduce their own residuals: never below the variances of the lines themselves.
    claimed = inverse * max(float(deviation), 1.0) ** 2 * NEIGHBOURS
    return np.asarray(sandwich if np.trace(bread @ sandwich) > np.trace(bread @ claimed) else claimed)


def jacobian_of(function: Callable[[Floats], Floats], theta: Floats, scales: Floats) -> Floats:
    """Central differences, (residuals, parameters)."""
    columns = []
    for i, scale in enumerate(scales):
        step = np.zeros(theta.size)
        step[i] = 1e-5 * scale
        columns.append((function(theta + step) - function(theta - step)) / (2.0 * step[i]))
    return np.column_stack(columns)


def theta_of(parameters: Mapping[str, float]) -> Floats:
    """The fitted vector of parameters given by name."""
    logs = [math.log(max(parameters[name], 1e-12)) for name in LOGARITHMIC]
    return np.array([*logs, parameters.get("viscous", 0.0), parameters.get("delay", 0.0)])


def parameters_of(theta: Floats) -> dict[str, float]:
    """Parameters by name, SI, of a fitted vector."""
    logs = np.exp(np.clip(theta[:4], -60.0, 60.0))
    return dict(zip(NAMES, [*map(float, logs), float(theta[4]), float(theta[5])], strict=True))


def unit_drivetrain(zero: float, pole: float) -> dict[str, float]:
    """Two masses of 1 kg m² together; as the paper's four equations."""
    motor = (zero / pole) ** 2
    stiffness = (1.0 - motor) * (2.0 * math.pi * zero) ** 2
    damping = SEARCH_DAMPING * stiffness / (math.pi * pole)
    return {"inertia_motor": motor, "inertia_load": 1.0 - motor, "stiffness": stiffness, "damping": damping}
