"""Random chains and short windows on them, each simulated exactly and by the independent reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from independent import Independent
from plants import trajectory

import lostmotion as lm
from lostmotion.drivetrain import Actuator, Drivetrain, Friction, Shaft


@dataclass(frozen=True)
class Judged:
    """One window: error against the reference and that of the reference against itself, as fractions of the range."""

    error: float
    disagreement: float
    events: int

    @property
    def counts(self) -> bool:
        """Whether the reference's runs at rtol 1e-12 and 1e-13 agree."""
        return self.disagreement <= 1e-10


DT = 1e-4


def friction(rng: np.random.Generator, kind: int) -> Friction:
    """Plain, with a breakaway level, or with two directions and a Stribeck curve."""
    level = float(rng.uniform(0.2, 1.0))
    if kind == 0:
        return Friction(level, 0.01)
    if kind == 1:
        return Friction(level, 0.01, breakaway=1.6 * level)
    stribeck = ((0.0, 0.4 * level), (0.5, 0.1 * level), (1.5, 0.0))
    return Friction((level, 0.7 * level), 0.02, stribeck=stribeck)


def random_chain(n: int, contact: str, rng: np.random.Generator) -> Drivetrain:
    """n inertias, backlash in three shafts (two of three masses), friction at three inertias, modes to 300 Hz.

    Every other one has an actuator lag.
    """
    loose = rng.choice(n - 1, size=min(3, n - 1), replace=False)
    rough = rng.choice(n, size=3, replace=False)
    shafts = []
    for i in range(n - 1):
        backlash = rng.uniform(0.001, 0.008) if i in loose else 0.0
        shafts.append(Shaft(rng.uniform(3000.0, 9000.0), rng.uniform(0.1, 0.5), backlash, contact))
    frictions = [Friction(viscous=0.01)] * n
    for kind, i in enumerate(rough):
        frictions[i] = friction(rng, kind)
    inertias = rng.uniform(0.008, 0.02, n)
    inertias[-1] *= 4.0
    return Drivetrain(tuple(inertias), tuple(shafts), tuple(frictions), Actuator(3e-4 * int(rng.integers(2))))


def judge(n: int, contact: str, seed: int, samples: int, max_step: float = np.inf) -> Judged:
    """One window of `samples` samples, everything drawn from the seed; max_step in s is the reference's."""
    rng = np.random.default_rng([seed, n, *contact.encode()])
    plant = random_chain(n, contact, rng)
    torque = 20.0 * rng.standard_normal(samples) + 15.0 * np.sign(rng.uniform(-1.0, 1.0))
    gaps = np.array([shaft.backlash for shaft in plant.shafts])
    start = np.concatenate([rng.uniform(-0.6, 0.6, n - 1) * gaps, rng.uniform(-4.0, 4.0, n)])
    fine, coarse = (Independent(plant, rtol, max_step=max_step) for rtol in (1e-13, 1e-12))
    got = trajectory(lm.simulate(plant, torque_motor=torque, dt=DT, state=start))
    try:
        expected, other = (reference.run(torque, DT, start) for reference in (fine, coarse))
    except RuntimeError:  # the reference switches endlessly: it does not count
        return Judged(float("nan"), float("inf"), fine.events)
    span = np.ptp(expected, axis=0)
    return Judged(
        error=float(np.max(np.abs(got - expected) / span)),
        disagreement=float(np.max(np.abs(other - expected) / span)),
        events=fine.events,
    )
