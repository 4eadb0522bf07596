"""Injection: the gap curve that sees the sensors solves its implicit equation, and leaves a right estimate alone."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.simulation import simulate

DT = 1e-4
BOTH = ("torque_shaft", "speed_motor")
INJECTION = {"torque_shaft": 1.39e-4, "speed_motor": 5e-4}


@pytest.mark.parametrize("contact", ["viscoelastic", "dead_zone"])
def test_the_gap_solves_its_implicit_equation(contact):
    plant = PAPER.with_contact(contact)
    law = kalman(plant, measured=BOTH, dt=DT, injection=INJECTION).without_checks()
    curve = len(law.curves) - 1  # the gap at the sample
    k, d, half = plant.stiffness, plant.damping, 0.5 * plant.backlash
    lead = d / k if contact == "viscoelastic" else 0.0
    rng, inside = np.random.default_rng(3), 0
    for _ in range(200):
        twist, motor, load = rng.normal(size=3) * (half, 1.0, 1.0)
        torque, speed = rng.normal(size=2) * (10.0, 1.0)
        state = np.zeros(len(law.states))
        state[:3] = twist, motor, load
        given = dict(zip(law.inputs, (0.0, torque, speed), strict=True))
        z = law.F[curve] @ state + law.G[curve] @ [given[name] for name in law.inputs]
        gap = np.clip(z, -half, half)
        rate = motor - load
        own = twist + lead * rate
        expected = k * (own - gap) + (d * rate if contact == "dead_zone" else 0.0)
        seen = INJECTION["torque_shaft"] * (torque - expected) + INJECTION["speed_motor"] * (speed - motor)
        assert gap == pytest.approx(np.clip(own + seen, -half, half), abs=1e-12)
        inside += abs(gap) < half
    assert 20 < inside < 180


@pytest.mark.parametrize(
    "measured, injection", [(("speed_motor",), {"speed_motor": 1.43e-3}), (BOTH, INJECTION)]
)
def test_a_right_estimate_stays_right(measured, injection):
    recording = simulate(PAPER, dt=DT, torque_motor=8.0 * np.sin(2.0 * np.pi * 3.0 * DT * np.arange(10_000)))
    assert len(recording.events) > 5
    run = kalman(PAPER, measured=measured, dt=DT, injection=injection).run(recording)
    # Without injection it is 0.004 mrad: the sample is not infinitely short.
    assert np.std(run["twist_estimated"] - recording["twist"]) < 1e-5


def test_a_wrong_start_is_forgotten_sooner():
    """In contact, with the estimate inside the gap: the torque sensor says at once that the gap is closed."""
    recording = simulate(PAPER, dt=DT, torque_motor=np.full(200, 30.0), state=(0.0065, 5.0, 5.0))
    left = []
    for injection in (None, {"torque_shaft": 1.39e-4}):
        law = kalman(PAPER, measured=BOTH, dt=DT, injection=injection).without_checks()
        start = np.zeros(len(law.states))
        start[:3] = -0.006, 5.0, 5.0
        run = replace(law, initial_state=start).run(recording)
        left.append(np.mean(np.abs(run["twist_estimated"] - recording["twist"])))
    assert left[1] < 0.7 * left[0]


def test_without_a_factor_it_is_the_observer_without():
    plain = kalman(PAPER, measured=BOTH, dt=DT)
    assert kalman(PAPER, measured=BOTH, dt=DT, injection={"torque_shaft": 0.0}).to_dict() == plain.to_dict()
    linear = PAPER.with_parameters(backlash=0.0)
    injected = kalman(linear, measured=BOTH, dt=DT, injection=INJECTION)
    assert injected.to_dict() == kalman(linear, measured=BOTH, dt=DT).to_dict()


@pytest.mark.parametrize(
    "given, wrong",
    [
        ({"twist": 1.0}, "Check the names"),
        ({"torque_shaft": 1.0 / PAPER.stiffness}, "less than 1/stiffness"),
        ({"speed_motor": np.nan}, "zero or more"),
        ({"speed_motor": "much"}, "a number"),
        ([1e-4], "a mapping"),
    ],
)
def test_misuse(given, wrong):
    with pytest.raises(InvalidInput, match=wrong):
        kalman(PAPER, measured=BOTH, dt=DT, injection=given)
