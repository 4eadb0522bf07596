"""Chains of three, four and six masses against an independent integration from switching event to event."""

from __future__ import annotations

import numpy as np
import pytest
from independent import Independent
from plants import trajectory

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Actuator, Drivetrain, Friction, Shaft

STRIBECK = ((0.0, 0.4), (0.5, 0.1), (1.5, 0.0))


def chain(n: int, contact: str, lag: float = 0.0) -> Drivetrain:
    """n inertias, two backlashes, friction at two places, modes of 80 to 700 Hz."""
    shafts = tuple(
        Shaft(4000.0 + 1500.0 * i, 0.25, 0.006 if i in (0, n - 2) else 0.0, contact) for i in range(n - 1)
    )
    frictions = [Friction(viscous=0.01)] * n
    frictions[1] = Friction(0.5, 0.01, breakaway=0.8)
    frictions[-1] = Friction((1.0, 0.8), 0.02, stribeck=STRIBECK)
    return Drivetrain((0.02, *(0.01,) * (n - 2), 0.05), shafts, tuple(frictions), Actuator(lag))


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("n", [3, 4, 6])
def test_chain_with_two_backlashes(contact, n):
    plant = chain(n, contact, lag=3e-4 if n == 3 else 0.0)
    rng = np.random.default_rng([n, len(contact)])
    samples = 80 if n == 6 else 150
    torque = 20.0 * rng.standard_normal(samples) + np.where(np.arange(samples) % 100 < 50, 15.0, -15.0)
    start = np.concatenate([np.zeros(n - 1), rng.uniform(-4.0, 4.0, n)])
    fine, coarse = Independent(plant, 1e-13), Independent(plant, 1e-12)
    expected = fine.run(torque, 1e-4, start)
    span = np.ptp(expected, axis=0)
    assert np.max(np.abs(coarse.run(torque, 1e-4, start) - expected) / span) < 1e-10
    recording = lm.simulate(plant, torque_motor=torque, dt=1e-4, state=start)
    assert fine.events >= 4
    assert np.max(np.abs(trajectory(recording) - expected) / span) <= 1e-9
