"""The two-mass drivetrain that a measured frequency response fits best, with intervals."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Actuator, Drivetrain, Friction
from ...errors import InvalidInput, Problem
from ..statistics.estimates import Estimates, Source
from . import problems
from .fit_problem import (
    LOGARITHMIC,
    NAMES,
    WeightedResponse,
    coherent_band,
    covariance_of,
    parameters_of,
    theta_of,
)
from .response import FrequencyResponse
from .rigid_fit import FREE, chance_of_a_mode, rigid_start
from .two_mass_response import OUTPUTS

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Not identifiable from the other outputs, which have a pole but no zero behind the shaft: kept from the start.
KEPT = {
    "angle_load": "inertia_motor",
    "speed_load": "inertia_motor",
    "torque_shaft": "inertia_motor",
    "twist": "inertia_total",
}

#: Outputs that a rigid drive has too.
SHOWN_WITHOUT_A_SHAFT = ("angle_motor", "speed_motor", "angle_load", "speed_load")
#: A mode is identified where noise alone makes it with at most this probability (option: as the 95 % of the intervals).
CHANCE = 0.05
#: Half width of a logarithm from which on a value may be anything (numerics: 1e43 either way).
ANYTHING = 100.0
#: What only the torsional mode shows.
OF_THE_MODE = ("inertia_motor", "inertia_load", "stiffness", "damping", "zero", "pole")


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class TwoMassFit(Estimates):
    """A linear two-mass drivetrain fitted to a frequency response.

    Values: ``inertia_motor``, ``inertia_load``, ``stiffness``, ``damping``, ``viscous``, ``delay`` (torque lag and
    sensor delay together, s), and from them ``zero`` and ``pole`` (undamped, Hz) and ``inertia_total``. What the start
    keeps has the source "nameplate".

    Parameters
    ----------
    drivetrain : Drivetrain
        Closed gap. ``viscous`` is the load's equivalent viscous friction, at the amplitude of the test. One inertia
        where the response shows no torsional mode.
    frequency : (m,) array, Hz
        The lines used.
    fitted : (m,) complex array
        The fitted response there, as the measured one was sampled.
    residual : (m,) complex array
        Measured − fitted, in standard deviations of the measured one.
    """

    drivetrain: Drivetrain
    frequency: Floats
    fitted: Complexes
    residual: Complexes


@checks_arguments
def two_mass_fit(
    measured: FrequencyResponse,
    *,
    band: tuple[float, float] | None = None,
    start: Drivetrain | None = None,
) -> TwoMassFit:
    """Fit the linear two-mass drivetrain to a response over the motor torque, real and imaginary part together.

    Each line has the weight 1/σ², σ² = abs(H)²·max(1 − γ², 0.001)/(γ²·n) for H1. Around the zero, where H1 and γ² are
    both small, that is the noise of the output and does not vanish. Lines that fit badly are down-weighted (soft L1),
    so another eigenmode or a disturbance has little influence. Without a start, zero and pole are searched on a grid.
    Intervals: sandwich with the correlation of neighbouring lines, Student's t.

    Where a rigid drive fits as well (likelihood ratio), no mode is identified.

    A gap, friction and too coarse a resolution bias the result beyond its intervals: it describes the drivetrain at the
    amplitude of the test.

    Parameters
    ----------
    measured : FrequencyResponse
        Of ``torque_motor`` to one of angle, speed, twist or shaft torque.
    band : (float, float), optional, Hz
        Lines to use. Default: from the first to the last that is clearly coherent. It should contain both zero
        and pole and end below the next eigenmode.
    start : Drivetrain, optional
        Two masses, instead of the search. Needed for load angle, load speed, shaft torque and twist, which identify
        one parameter less: the start's ``inertia_motor`` (twist: ``inertia_total``) is then kept and has no interval.

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
    keep = measured.band(*(coherent_band(measured) if band is None else band))
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
            "It cannot be identified from this response: give start, or fit the motor's angle or speed instead.",
        )
    problem = WeightedResponse(
        measured, keep, None if kept is None or start is None else (kept, getattr(start, kept))
    )
    theta = problem.search() if start is None else theta_of({**start.parameters(), "delay": start.lag})
    fitted = problem.fit(theta)
    if measured.output in SHOWN_WITHOUT_A_SHAFT:
        rigid = problem.fit(rigid_start(problem), FREE)
        if not chance_of_a_mode(problem, fitted[0], rigid[0]) <= CHANCE:
            return _result(problem, *rigid, is_rigid=True)
    return _result(problem, *fitted)


def _result(
    problem: WeightedResponse, theta: Floats, jacobian: Floats, residual: Complexes, is_rigid: bool = False
) -> TwoMassFit:
    from scipy.stats import t as student

    covariance = covariance_of(jacobian, residual)
    factor = float(student.ppf(0.975, max(2 * residual.size - len(NAMES), 1)))
    values, intervals = parameters_of(theta), {}
    for i, name in enumerate(NAMES):
        half = factor * math.sqrt(max(covariance[i, i], 0.0))
        v = values[name]
        intervals[name] = _around(v, half) if name in LOGARITHMIC else (v - half, v + half)
    for name, value, row in _derived(values):
        half = factor * math.sqrt(max(float(row @ covariance @ row), 0.0))
        values[name], intervals[name] = value, _around(value, half)
    sources: dict[str, Source] = {}
    if problem.held is not None:
        del intervals[problem.held[0]]
        sources[problem.held[0]] = "nameplate"
    # What hangs on a mode that the band does not contain is not identified, however narrow a local fit makes it.
    lost = {name for name, (_, high) in intervals.items() if not math.isfinite(high)}
    if not problem.frequency[0] < values["pole"] < problem.frequency[-1]:
        lost |= set(OF_THE_MODE)
    findings = [problems.no_mode()] if is_rigid else _findings(problem, values)
    return TwoMassFit(
        drivetrain=_drivetrain(values, is_rigid),
        values={n: None if n in lost and n not in sources else v for n, v in values.items()},
        intervals={n: interval for n, interval in intervals.items() if n not in lost},
        sources=sources,
        frequency=problem.frequency,
        fitted=problem.model(theta),
        residual=residual,
        problems=tuple(findings),
    )


def _around(value: float, half: float) -> tuple[float, float]:
    """Interval of a value from the half width of its logarithm; anything where that is beyond all sense."""
    if not half < ANYTHING:
        return 0.0, math.inf
    return value * math.exp(-half), value * math.exp(half)


def _drivetrain(values: Mapping[str, float], is_rigid: bool) -> Drivetrain:
    viscous, lag = max(values["viscous"], 0.0), max(values["delay"], 0.0)
    if is_rigid:
        friction = Friction(viscous=viscous)
        return Drivetrain((values["inertia_total"],), frictions=(friction,), actuator=Actuator(lag))
    mode = {name: values[name] for name in ("inertia_motor", "inertia_load", "stiffness", "damping")}
    return Drivetrain.two_mass(**mode, viscous=viscous, lag=lag)  # type: ignore[arg-type]


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


def _findings(problem: WeightedResponse, values: Mapping[str, float]) -> list[Problem]:
    low, high = problem.frequency[0], problem.frequency[-1]
    found = [
        problems.outside_the_band(name, values[name], low, high)
        for name in ("zero", "pole")
        if not low < values[name] < high
    ]
    resolution = problem.measured.resolution
    # The full width of the sharpest resonance that the output has: the zero, else the pole.
    inverse = 1.0 / values["inertia_load"]
    if not problem.measured.output.endswith("_motor"):
        inverse += 1.0 / values["inertia_motor"]
    width = values["damping"] * inverse / (2.0 * math.pi)
    if width < 2.0 * resolution:
        found.append(problems.resonance_too_sharp(width, resolution))
    return found
