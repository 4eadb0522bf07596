"""The largest share of the gap's slope, against the criteria in the frequency domain and against textbook loops."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from table_i import PAPER, TABLE_I

import lostmotion as lm
from lostmotion.certificates import (
    continuous_observer_feedback,
    continuous_pi,
    continuous_state_feedback,
    largest_share,
)
from lostmotion.certificates.continuous.continuous_loop import continuous_loop
from lostmotion.certificates.lure import LureLoop
from lostmotion.certificates.rational import identity, rational, zeros
from lostmotion.certificates.robustness.gap_share import Question, share_of_loop
from lostmotion.certificates.static_curves import StaticCurve
from lostmotion.errors import InvalidInput

GAP_ALONE = lm.Drivetrain.two_mass(**{**TABLE_I, "coulomb": 0.0}, contact="dead_zone")


def textbook(poles: tuple[float, ...], steepest: int) -> LureLoop:
    """ẋ = A x − b·w(c x) with c (s − A)⁻¹ b = 1/∏(s + pole), as a chain of lags."""
    n = len(poles)
    a = rational(np.diag([-pole for pole in poles]) + np.eye(n, k=-1))
    e, z = zeros(n, 1), zeros(1, n)
    e[0, 0], z[0, -1] = Fraction(-1), Fraction(1)
    half = Fraction(1, 2)
    curve = StaticCurve(((-half / steepest, -half), (half / steepest, half)))
    none = zeros(n, 0)
    return LureLoop(
        dt=Fraction(1, 8), states=tuple(f"x{i}" for i in range(n)), plant_size=n, A=a, E=e, L=zeros(n, 1), Z=z,
        R=zeros(n, 1), S=identity(n), S_w=zeros(n, 1), S_v=none, N=none.T, N_w=zeros(0, 1), N_v=zeros(0, 0),
        M=zeros(0, 1), plant_curves=(curve,), law_curves=(), names=("curve",),
    )  # fmt: skip


def circle(response: np.ndarray) -> float:
    """Largest slope of the circle criterion: −1/min Re G."""
    return float(-1.0 / np.min(response.real))


@pytest.mark.parametrize(
    ("poles", "popov"), [((1.0, 1.0, 1.0), 8.0), ((1.0, 2.0, 3.0), 60.0), ((1.0, 1.0, 10.0), 242.0)]
)
def test_textbook_loops_of_three_lags(poles: tuple[float, ...], popov: float) -> None:
    """For three lags Popov's criterion reaches Routh's and Hurwitz's limit: (Σ poles)(Σ products) − ∏."""
    assert popov == sum(poles) * (poles[0] * poles[1] + poles[0] * poles[2] + poles[1] * poles[2]) - np.prod(
        poles
    )
    omega = np.linspace(1e-3, 60.0, 1_000_001)
    response = 1.0 / np.prod([1j * omega + pole for pole in poles], axis=0)
    steepest = 500
    loop = textbook(poles, steepest)
    assert steepest * share_of_loop(loop, "popov") == pytest.approx(popov, rel=1e-3, abs=0.05)
    assert steepest * share_of_loop(loop, "circle") == pytest.approx(circle(response), rel=1e-3, abs=0.05)


def test_pi_by_the_circle_and_by_popov() -> None:
    law = continuous_pi()
    loop = continuous_loop(GAP_ALONE, law)
    a, e, z = (matrix.astype(float) for matrix in (loop.A, loop.E, loop.Z))
    poles, vectors = np.linalg.eig(a)
    omega = np.geomspace(0.1, 1e5, 400_001)
    rows = (z @ vectors)[0] * np.linalg.solve(vectors, -e)[:, 0]
    response = (rows[np.newaxis] / (1j * omega[:, np.newaxis] - poles)).sum(axis=1)
    expected = circle(response) * GAP_ALONE.backlash  # a curve of height 1 over the backlash has share 1
    assert largest_share(GAP_ALONE, law, "circle") == pytest.approx(expected, abs=2e-4)
    assert expected == pytest.approx(0.891, abs=5e-4)
    assert largest_share(GAP_ALONE, law, "popov") >= 0.9998


def test_the_papers_loops() -> None:
    assert largest_share(GAP_ALONE, continuous_state_feedback(GAP_ALONE), "popov") == 1.0
    for measured, shares in (
        (("speed_motor",), {"circle": (0.76, 0.79), "popov": (0.95, 0.97), "cross": (0.995, 1.0)}),
        (
            ("torque_shaft", "speed_motor"),
            {"circle": (0.73, 0.77), "popov": (0.92, 0.94), "cross": (0.975, 1.0)},
        ),
    ):
        loop = continuous_loop(GAP_ALONE, continuous_observer_feedback(GAP_ALONE, measured=measured))
        for criterion, (proved, not_proved) in shares.items():
            question = Question(loop, criterion)
            assert question.is_proved(Fraction(proved)), (measured, criterion)
            assert not question.is_proved(Fraction(not_proved)), (measured, criterion)


def test_what_is_no_gap_alone_is_refused() -> None:
    with pytest.raises(InvalidInput, match="gap alone"):
        largest_share(PAPER, continuous_pi())
    with pytest.raises(InvalidInput, match="circle"):
        largest_share(GAP_ALONE, continuous_pi(), "nyquist")
