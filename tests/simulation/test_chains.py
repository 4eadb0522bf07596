"""Chains of three to twenty masses against an independent integration from switching event to event."""

from __future__ import annotations

import numpy as np
import pytest
from independent import Independent
from plants import trajectory
from windows import judge

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Actuator, Drivetrain, Friction, Shaft

STRIBECK = ((0.0, 0.4), (0.5, 0.1), (1.5, 0.0))


def chain(n: int, contact: str, lag: float = 0.0) -> Drivetrain:
    """n inertias, two backlashes (from seven on three), friction at two (three) places, modes of 80 to 700 Hz."""
    loose = (0, n // 2, n - 2) if n > 6 else (0, n - 2)
    shafts = tuple(
        Shaft(4000.0 + 1500.0 * (i % 5), 0.25, 0.006 if i in loose else 0.0, contact) for i in range(n - 1)
    )
    frictions = [Friction(viscous=0.01)] * n
    frictions[1] = Friction(0.5, 0.01, breakaway=0.8)
    frictions[-1] = Friction((1.0, 0.8), 0.02, stribeck=STRIBECK)
    if n > 6:
        frictions[n // 2] = Friction(0.3, 0.01)
    return Drivetrain((0.02, *(0.01,) * (n - 2), 0.05), shafts, tuple(frictions), Actuator(lag))


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("n", [3, 4, 6, 7, 12, 20])
def test_chain_with_several_backlashes(contact, n):
    plant = chain(n, contact, lag=3e-4 if n in (3, 12) else 0.0)
    rng = np.random.default_rng([n, len(contact)])
    samples = {3: 150, 4: 150, 6: 80}.get(n, 40)
    torque = 20.0 * rng.standard_normal(samples) + np.where(np.arange(samples) % 100 < 50, 15.0, -15.0)
    start = np.concatenate([np.zeros(n - 1), rng.uniform(-4.0, 4.0, n)])
    fine, coarse = Independent(plant, 1e-13), Independent(plant, 1e-12)
    expected = fine.run(torque, 1e-4, start)
    span = np.ptp(expected, axis=0)
    assert np.max(np.abs(coarse.run(torque, 1e-4, start) - expected) / span) < 1e-10
    recording = lm.simulate(plant, torque_motor=torque, dt=1e-4, state=start)
    assert fine.events >= 4
    assert np.max(np.abs(trajectory(recording) - expected) / span) <= 1e-9


def test_random_windows_and_the_share_left_out():
    """Random chains with three backlashes and three frictions; benchmarks/accuracy.py does the same on thousands."""
    windows = [
        judge(n, contact, seed, samples=25)
        for n, seeds in ((3, 8), (4, 4), (7, 2))
        for contact in CONTACT_LAWS
        for seed in range(1000, 1000 + seeds)
    ]
    assert sum(window.events for window in windows) > 200
    assert np.mean([not window.counts for window in windows]) <= 0.02
    assert max(window.error for window in windows if window.counts) <= 1e-9
