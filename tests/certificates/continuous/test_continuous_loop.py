"""Laws in continuous time: where they rest, what is proved of them, what is refused."""

from __future__ import annotations

import json
from fractions import Fraction

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import prove_box, verdict
from lostmotion.certificates.continuous.continuous_law import (
    ContinuousLaw,
    continuous_observer_feedback,
    continuous_pi,
)
from lostmotion.certificates.continuous.continuous_loop import continuous_loop
from lostmotion.certificates.equilibrium import equilibrium
from lostmotion.errors import InvalidInput


@pytest.mark.parametrize(
    ("law", "speed"),
    [
        (continuous_pi(), 0.01),
        (continuous_observer_feedback(PAPER), 0.08),
        (continuous_observer_feedback(PAPER, compensation=False), 0.03),
    ],
)
def test_the_nominal_loop_is_proved_exactly(law: ContinuousLaw, speed: float) -> None:
    proof = prove_box(PAPER, law, {}, speed=speed, workers=1)
    assert proof.proved and proof.cells == 1
    assert verdict(json.loads(json.dumps(proof.certificate))) is None
    claim = {**proof.certificate["claim"], "speed_from": 0.2 * speed}
    assert verdict({**proof.certificate, "claim": claim}) is not None, "another claim is not proved by it"


def test_it_rests_where_the_sampled_loop_does() -> None:
    """The exact simulation of the sampled law, at a tenth of the usual sample time, settles at the equilibrium."""
    rest = equilibrium(
        continuous_loop(PAPER, continuous_observer_feedback(PAPER, compensation=False)), Fraction(2)
    )
    assert rest is not None
    dt = 2e-5
    parts = [
        lm.observers.kalman(PAPER, dt=dt),
        lm.controllers.pole_placement(PAPER, dt=dt, friction_compensation="none"),
    ]
    law = lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",)).without_checks()
    run = lm.simulate(PAPER, law=law, dt=dt, speed_reference=np.full(40_000, float(rest.reference)))
    assert run["speed_load"][-1] == pytest.approx(2.0, rel=1e-3)


def test_its_linear_part_is_the_design() -> None:
    """In contact and slipping the poles are those of feedback and observer: the separation theorem."""
    loop = continuous_loop(PAPER, continuous_observer_feedback(PAPER))
    poles = np.linalg.eigvals(loop.A.astype(float))
    a, _ = PAPER.linear()
    gain = lm.observers.kalman_gain(PAPER)
    observer = np.linalg.eigvals(a - gain @ [[0.0, 1.0, 0.0]])
    for pole in observer:
        assert np.min(np.abs(poles - pole)) < 1e-6 * abs(pole)
    assert np.sum(np.abs(poles + 400.0) < 0.1) == 3


def test_what_it_does_not_know_is_refused() -> None:
    with pytest.raises(InvalidInput, match="torque limit"):
        continuous_loop(PAPER.with_parameters(torque_limit=50.0), continuous_pi())
    with pytest.raises(InvalidInput, match="lag"):
        continuous_observer_feedback(PAPER.with_parameters(lag=1e-3))
