"""Zames and Falb's multipliers: a limit in closed form, the condition over frequency, what must not be proved."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import continuous_observer_feedback, continuous_pi
from lostmotion.certificates.continuous.continuous_loop import continuous_loop
from lostmotion.certificates.lure import LureLoop
from lostmotion.certificates.rational import identity, rational, zeros
from lostmotion.certificates.robustness.gap_share import Question, share_of_loop
from lostmotion.certificates.robustness.zames_falb import POLES, is_stable_with_flow, weights
from lostmotion.certificates.static_curves import StaticCurve

GAP_ALONE = lm.Drivetrain.two_mass(**{**TABLE_I, "coulomb": 0.0}, contact="dead_zone")
STEEPEST = 10


def third_order() -> LureLoop:
    """G = (s² − 0.2 s − 0.1)/(s³ + 2 s² + s + 1), which turns so far that circle and linear limit lie far apart."""
    a = rational([[-2.0, -1.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    half = Fraction(1, 2)
    curve = StaticCurve(((-half / STEEPEST, -half), (half / STEEPEST, half)))
    none = zeros(3, 0)
    return LureLoop(
        dt=Fraction(1, 8), states=("x0", "x1", "x2"), plant_size=3, A=a, E=rational([[-1.0], [0.0], [0.0]]),
        Z=rational([[1.0, -0.2, -0.1]]), L=zeros(3, 1), R=zeros(3, 1), S=identity(3), S_w=zeros(3, 1), S_v=none,
        N=none.T, N_w=zeros(0, 1), N_v=zeros(0, 0), M=zeros(0, 1), plant_curves=(curve,), law_curves=(),
        names=("curve",),
    )  # fmt: skip


def test_a_loop_of_third_order_is_proved_up_to_its_linear_limit() -> None:
    """With slope m it is s³ + (2 + m) s² + (1 − 0.2 m) s + 1 − 0.1 m, stable while (2 + m)(1 − 0.2 m) > 1 − 0.1 m
    (Routh and Hurwitz): up to the root of 0.2 m² − 0.7 m − 1. No criterion can prove more; the circle −1/min Re G.
    """
    hurwitz = (0.7 + math.sqrt(0.7**2 + 4.0 * 0.2)) / (2.0 * 0.2)
    s = 1j * np.geomspace(0.1, 10.0, 20_001)
    circle = -1.0 / np.min(((s**2 - 0.2 * s - 0.1) / (s**3 + 2.0 * s**2 + s + 1.0)).real)
    loop = third_order()
    proved = STEEPEST * share_of_loop(loop, "zames_falb")
    assert hurwitz - 2e-3 < proved < hurwitz
    assert STEEPEST * share_of_loop(loop, "circle") == pytest.approx(circle, abs=2e-3)
    assert circle < 0.3 * hurwitz


def test_its_weights_satisfy_the_condition_in_the_frequency_domain() -> None:
    """Re M(jω)·(1 + slope·G(jω)) > 0, with M the own weight minus filters whose impulse responses weigh less."""
    loop = third_order()
    found = weights(loop, Fraction(45, 100), np.ones(3))
    assert found is not None
    problem, unknowns = found
    assert problem.odd and problem.kinds == [(0, 0, "w 0"), (0, 0, "u 0")]
    s = 1j * np.geomspace(1e-3, 1e3, 20_001)
    g = (s**2 - 0.2 * s - 0.1) / (s**3 + 2.0 * s**2 + s + 1.0)
    pole = float(problem.poles[0] / loop.dt)
    past, ahead = (float(m - p) for m, p in zip(unknowns["minus"], unknowns["plus"], strict=True))
    popov = float(unknowns["popov_plus"][0] - unknowns["popov_minus"][0]) * float(loop.dt)
    # u past is w ahead: the mean product of w with u filtered is that of w filtered backwards, with u.
    multiplier = float(unknowns["own"][0]) - past * np.conj(pole / (s + pole)) - ahead * pole / (s + pole)
    slope = float(problem.slope)
    assert np.all((multiplier * (1.0 + slope * g) - popov * (-s * g)).real > 0.0)
    assert np.any((1.0 + slope * g).real < 0.0), "the circle criterion fails"
    assert abs(past) + abs(ahead) < float(unknowns["own"][0])


@pytest.mark.parametrize("measured", [(), ("speed_motor",), ("torque_shaft", "speed_motor")])
def test_the_papers_loops_are_proved_up_to_the_open_gap(measured: tuple[str, ...]) -> None:
    """With the gap open the linear loop has an eigenvalue at 0: the whole gap cannot be proved, and is not."""
    law = continuous_observer_feedback(GAP_ALONE, measured=measured) if measured else continuous_pi()
    question = Question(continuous_loop(GAP_ALONE, law), "zames_falb")
    assert question.is_proved(Fraction(9999, 10_000)) and not question.is_proved(Fraction(1))


def test_weights_that_outweigh_the_curves_own_are_refused() -> None:
    loop = continuous_loop(GAP_ALONE, continuous_observer_feedback(GAP_ALONE))
    found = weights(loop, Fraction(1, 2), np.ones(len(loop.states)))
    assert found is not None
    problem, unknowns = found
    assert len(problem.kinds) == 9 * 2 * len(POLES) + 6
    for sign in ("minus", "plus"):
        more = {**unknowns, sign: unknowns[sign] + unknowns["own"].max()}
        assert any(left[0, 0] <= 0 for left in problem.conditions(more)[1:])


def test_a_curve_that_is_not_odd_has_positive_filters_alone() -> None:
    loop = third_order()
    half = Fraction(1, 2)
    curve = StaticCurve(((-half / STEEPEST, -half), (2 * half / STEEPEST, 2 * half)))
    found = weights(replace(loop, plant_curves=(curve,)), Fraction(1, 10), np.ones(3))
    assert found is not None and not found[0].odd and "plus" not in found[1]


def test_an_unstable_flow_is_seen() -> None:
    loop = third_order()
    assert is_stable_with_flow(loop.A) and not is_stable_with_flow(-loop.A)
