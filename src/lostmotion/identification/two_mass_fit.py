"""The two-mass drivetrain that a measured frequency response fits best, with intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from .frequency_response import FrequencyResponse
from .two_mass_response import OUTPUTS, two_mass_response

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Fitted by their logarithms, being positive by nature; the others, which may vanish, as they are.
LOGARITHMIC = ("inertia_motor", "inertia_load", "stiffness", "damping")
NAMES = (*LOGARITHMIC, "viscous", "delay")
#: 1 − coherence counts as at least this much (chosen): a linear model is never better than that.
COHERENCE_FLOOR = 1e-3
#: Residuals beyond this many of their median deviations count linearly instead of squared (chosen, as Huber's 2…3).
ROBUST = 2.5
#: Correlation of the estimate between neighbouring lines reaches this far (Hann's window: two lines).
CORRELATED_LINES = 4
#: Fits one after the other, each with the scale of the residuals (and the images) that the one before left (chosen).
PASSES = 4
#: What the other outputs do not tell beside the pole: behind the shaft there is no zero. It is kept as in the start.
KEPT = {
    "angle_load": "inertia_motor",
    "speed_load": "inertia_motor",
    "torque_shaft": "inertia_motor",
    "twist": "inertia_total",
}
#: Weight that keeps it (chosen: to about 1e-6).
KEPT_WEIGHT = 1e6
#: What the correlation of neighbouring lines under Hann's window adds to a variance: 1 + 2·((2/3)² + (1/6)²).
NEIGHBOURS = 1.944
#: Lines over which coherence is averaged, and how many times its mean by chance, 1/averages, counts as clear (chosen).
NEIGHBOURHOOD, CLEARLY = 21, 3.0
#: Raster of the search for a start: zeros, poles, damping ratio (chosen).
SEARCH_POINTS, SEARCH_DAMPING = 40, 0.05


@dataclass(frozen=True, eq=False)
class TwoMassFit:
    """A linear two-mass drivetrain fitted to a frequency response.

    Parameters
    ----------
    drivetrain : Drivetrain
        Closed gap. ``viscous`` is the load's equivalent viscous friction, at the amplitude of the test.
    values : mapping
        ``inertia_motor``, ``inertia_load``, ``stiffness``, ``damping``, ``viscous``, ``delay`` (torque lag and sensor
        delay together, s), and from them ``zero`` and ``pole`` (undamped, Hz) and ``inertia_total``.
    intervals : mapping of the same names → (low, high)
        95 % intervals.
    frequency : (m,) array, Hz
        The lines used.
    fitted : (m,) complex array
        The fitted response there, as the measured one was sampled.
    residual : (m,) complex array
        Measured − fitted, in standard deviations of the measured one.
    problems : tuple of Problem
    """

    drivetrain: Drivetrain
    values: Mapping[str, float]
    intervals: Mapping[str, tuple[float, float]]
    frequency: Floats
    fitted: Complexes
    residual: Complexes
    problems: tuple[Problem, ...]

    def as_dict(self) -> dict[str, Any]:
        """Numbers and lists, for JSON."""
        return {
            "values": dict(self.values),
            "intervals": {name: list(interval) for name, interval in self.intervals.items()},
            "problems": [problem.as_dict() for problem in self.problems],
        }


def two_mass_fit(
    measured: FrequencyResponse,
    *,
    band: tuple[float, float] | None = None,
    start: Drivetrain | None = None,
) -> TwoMassFit:
    """Fit the linear two-mass drivetrain to a response over the motor torque, real and imaginary part together.

    Each line counts with 1/σ², σ² = abs(H)²·max(1 − γ², 0.001)/(γ²·n) for H1: the coherence decides. Around the zero,
    where H1 and γ² are small together, that stays the noise of the output and does not vanish. Lines that fit badly
    count linearly (soft L1), so that a foreign mode or a disturbance pulls little. Without a start, zero and pole are
    searched on a raster. Intervals: sandwich with the correlation of neighbouring lines, Student's t.

    A gap, friction and too coarse a resolution bias the result beyond its intervals: it describes the drivetrain at the
    amplitude of the test.

    Parameters
    ----------
    measured : FrequencyResponse
        Of ``torque_motor`` to one of angle, speed, twist or shaft torque.
    band : (float, float), optional, Hz
        Lines to use. Default: from the first to the last with more coherence than chance gives. It should hold both
        zero and pole and end below the next mode.
    start : Drivetrain, optional
        Two masses, where the search should not choose. Needed for what lies behind the motor: load angle, load
        speed and shaft torque tell one parameter less, as does the twist. The start's ``inertia_motor`` (twist:
        ``inertia_total``) is kept then and has no interval.

    Raises
    ------
    InvalidInput
        If the response is not one of the motor torque to a two-mass output, or fewer lines than parameters are left.
    """
    if measured.output not in OUTPUTS or measured.input != "torque_motor":
        raise InvalidInput(
            "two_mass_fit",
            f"{measured.output} over {measured.input}",
            f"one of {OUTPUTS} over torque_motor",
            "Choose those signals.",
        )
    keep = measured.band(*(_coherent_band(measured) if band is None else band))
    if np.count_nonzero(keep) < 2 * len(NAMES):
        raise InvalidInput(
            "two_mass_fit: band", f"{keep.sum()} lines", f"at least {2 * len(NAMES)}", "Widen it."
        )
    kept = KEPT.get(measured.output)
    if kept is not None and start is None:
        raise InvalidInput(
            "two_mass_fit: start",
            "none",
            f"a drivetrain whose {kept} is right, for {measured.output}",
            "This response does not tell it: give start, or fit the motor's angle or speed instead.",
        )
    problem = _Problem(
        measured, keep, None if kept is None or start is None else (kept, getattr(start, kept))
    )
    theta = problem.search() if start is None else _theta({**start.parameters(), "delay": start.lag})
    theta, jacobian, residual = problem.fit(theta)
    return _result(problem, theta, jacobian, residual)


def _coherent_band(measured: FrequencyResponse) -> tuple[float, float]:
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


class _Problem:
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
        """What the images of sampling add; so smooth in the parameters that they are renewed between fits only."""
        parameters, how = _parameters(theta), self.measured.sampling
        return how.images(lambda s: two_mass_response(parameters, how.source, s), self.frequency)

    def model(self, theta: Floats) -> Complexes:
        how = self.measured.sampling
        source = two_mass_response(_parameters(theta), how.source, self.s)
        return np.asarray((source + self.images) * self.s**how.power, dtype=complex)

    def residual(self, theta: Floats) -> Complexes:
        return np.asarray((self.response - self.model(theta)) / self.sigma, dtype=complex)

    def kept(self, theta: Floats) -> float:
        if self.held is None:
            return 0.0
        name, value = self.held
        inertia = math.exp(theta[0]) if name == "inertia_motor" else float(np.exp(theta[:2]).sum())
        return KEPT_WEIGHT * math.log(inertia / value)

    def search(self) -> Floats:
        """Best of a raster of zeros and poles, the total inertia from the weighted mean of response over model."""
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
                trial = _from_frequencies(zero, pole)
                shape = two_mass_response(trial, self.measured.sampling.source, s) * s**power
                # On a logarithmic scale, where a resonance that is missed costs as much as a zero.
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
        return _theta({name: value * inertia for name, value in best.items()} | {"delay": 0.0})

    def fit(self, theta: Floats) -> tuple[Floats, Floats, Complexes]:
        from scipy.optimize import least_squares

        def both(t: Floats) -> Floats:
            r = self.residual(t)
            return np.concatenate([r.real, r.imag, [self.kept(t)]])

        scales = np.array([1.0, 1.0, 1.0, 1.0, math.exp(theta[0]) * 10.0, 1e-3])
        for _ in range(PASSES):
            self.images = self.images_of(theta)
            unit = self._deviation(theta)
            found = least_squares(
                both, theta, x_scale=scales, loss="soft_l1", f_scale=ROBUST * unit, max_nfev=200
            )
            theta = found.x
        return theta, _jacobian(both, theta, scales), self.residual(theta)

    def _deviation(self, theta: Floats) -> float:
        """Standard deviation of one part of the residual, from its median."""
        return max(float(np.median(np.abs(self.residual(theta)))) / 1.1774, 1e-9)


def _result(problem: _Problem, theta: Floats, jacobian: Floats, residual: Complexes) -> TwoMassFit:
    from scipy.stats import t as student

    covariance = _covariance(jacobian, residual)
    factor = float(student.ppf(0.975, max(2 * residual.size - len(NAMES), 1)))
    values, intervals = _parameters(theta), {}
    for i, name in enumerate(NAMES):
        half = factor * math.sqrt(max(covariance[i, i], 0.0))
        v = values[name]
        intervals[name] = (
            (v * math.exp(-half), v * math.exp(half)) if name in LOGARITHMIC else (v - half, v + half)
        )
    for name, value, row in _derived(values):
        half = factor * math.sqrt(max(float(row @ covariance @ row), 0.0))
        values[name], intervals[name] = value, (value * math.exp(-half), value * math.exp(half))
    if problem.held is not None:
        del intervals[problem.held[0]]
    drivetrain = Drivetrain.two_mass(
        inertia_motor=values["inertia_motor"],
        inertia_load=values["inertia_load"],
        stiffness=values["stiffness"],
        damping=values["damping"],
        viscous=max(values["viscous"], 0.0),
        lag=max(values["delay"], 0.0),
    )
    return TwoMassFit(
        drivetrain=drivetrain,
        values=values,
        intervals=intervals,
        frequency=problem.frequency,
        fitted=problem.model(theta),
        residual=residual,
        problems=tuple(_findings(problem, values)),
    )


def _derived(values: Mapping[str, float]) -> list[tuple[str, float, Floats]]:
    """Zero, pole and total inertia, each with its logarithm's gradient by the fitted parameters."""
    motor, load, k = (values[name] for name in ("inertia_motor", "inertia_load", "stiffness"))
    total = motor + load
    zero = math.sqrt(k / load) / (2.0 * math.pi)
    pole = math.sqrt(k * total / (motor * load)) / (2.0 * math.pi)
    return [
        ("zero", zero, np.array([0.0, -0.5, 0.5, 0.0, 0.0, 0.0])),
        ("pole", pole, np.array([-0.5 * load / total, -0.5 * motor / total, 0.5, 0.0, 0.0, 0.0])),
        ("inertia_total", total, np.array([motor / total, load / total, 0.0, 0.0, 0.0, 0.0])),
    ]


def _covariance(jacobian: Floats, residual: Complexes) -> Floats:
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
    # Few lines of high leverage pull their own residuals down: never below what the lines' variances themselves say.
    claimed = inverse * max(float(deviation), 1.0) ** 2 * NEIGHBOURS
    return np.asarray(sandwich if np.trace(bread @ sandwich) > np.trace(bread @ claimed) else claimed)


def _jacobian(function: Any, theta: Floats, scales: Floats) -> Floats:
    columns = []
    for i, scale in enumerate(scales):
        step = np.zeros(theta.size)
        step[i] = 1e-5 * scale
        columns.append((function(theta + step) - function(theta - step)) / (2.0 * step[i]))
    return np.column_stack(columns)


def _theta(parameters: Mapping[str, float]) -> Floats:
    logs = [math.log(max(parameters[name], 1e-12)) for name in LOGARITHMIC]
    return np.array([*logs, parameters.get("viscous", 0.0), parameters.get("delay", 0.0)])


def _parameters(theta: Floats) -> dict[str, float]:
    logs = np.exp(np.clip(theta[:4], -60.0, 60.0))
    return dict(zip(NAMES, [*map(float, logs), float(theta[4]), float(theta[5])], strict=True))


def _from_frequencies(zero: float, pole: float) -> dict[str, float]:
    """Two masses of 1 kg m² together; as the paper's four equations."""
    motor = (zero / pole) ** 2
    stiffness = (1.0 - motor) * (2.0 * math.pi * zero) ** 2
    damping = SEARCH_DAMPING * stiffness / (math.pi * pole)
    return {"inertia_motor": motor, "inertia_load": 1.0 - motor, "stiffness": stiffness, "damping": damping}


def _findings(problem: _Problem, values: Mapping[str, float]) -> list[Problem]:
    found = []
    low, high = problem.frequency[0], problem.frequency[-1]
    for name in ("zero", "pole"):
        if not low < values[name] < high:
            found.append(
                Problem(
                    "warning",
                    f"two_mass_fit: {name}",
                    f"{values[name]:.4g} Hz, outside the band",
                    f"a {name} between {low:.4g} and {high:.4g} Hz",
                    "Widen the band or excite more there: inertias and stiffness rest on it.",
                )
            )
    resolution = problem.measured.resolution
    # The full width of the sharpest resonance that the output has: the zero, else the pole.
    inverse = 1.0 / values["inertia_load"]
    if not problem.measured.output.endswith("_motor"):
        inverse += 1.0 / values["inertia_motor"]
    width = values["damping"] * inverse / (2.0 * math.pi)
    if width < 2.0 * resolution:
        found.append(
            Problem(
                "warning",
                "two_mass_fit: damping",
                f"a resonance {width:.3g} Hz wide at a resolution of {resolution:.3g} Hz",
                "a resolution of at most half that width",
                "Take longer segments: the damping comes out too large.",
            )
        )
    return found
