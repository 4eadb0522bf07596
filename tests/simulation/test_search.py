"""A search for counter-examples: no crossing is missed, whatever the plant, the torque and the start."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from plants import trajectory

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Actuator, Drivetrain, Friction, Shaft

DT = 1e-4
#: Short enough that rounding has no time to grow chaotically beyond the tolerance.
SAMPLES = 30


def exponent(low: float, high: float) -> st.SearchStrategy[float]:
    return st.floats(low, high).map(lambda x: 10.0**x)


@st.composite
def plants(draw) -> Drivetrain:
    """Two to four inertias; modes up to a twentieth of the sample rate, contact poles from far below to far above."""
    n = draw(st.integers(2, 4))
    inertias = [draw(exponent(-3, 0)) for _ in range(n)]
    shafts = []
    for i in range(n - 1):
        reduced = inertias[i] * inertias[i + 1] / (inertias[i] + inertias[i + 1])
        # Half of a twentieth: a neighbour's shaft raises the mode by up to a factor of two.
        frequency = draw(exponent(0.5, math.log10(0.5 / 20 / DT)))
        stiffness = reduced * (2.0 * math.pi * frequency) ** 2
        contact_pole = draw(exponent(2.5, 5.3))
        damping = draw(st.sampled_from([0.0, stiffness / contact_pole]))
        backlash = draw(st.sampled_from([0.0, 1e-4, 1e-3, 1e-2]))
        shafts.append(Shaft(stiffness, damping, backlash, draw(st.sampled_from(CONTACT_LAWS))))
    frictions = tuple(draw(rough()) for _ in range(n))
    actuator = Actuator(lag=draw(st.sampled_from([0.0, 5e-5, 1e-3])))
    return Drivetrain(
        tuple(inertias), tuple(shafts), frictions, actuator, draw(st.sampled_from([None, None, "load"]))
    )


@st.composite
def rough(draw) -> Friction:
    """No friction, one level, two directions, a breakaway level, a Stribeck curve."""
    viscous = draw(st.sampled_from([0.0, 0.02]))
    level = draw(st.sampled_from([0.3, 2.0]))
    kinds = {
        "none": Friction(0.0, viscous),
        "coulomb": Friction(level, viscous),
        "directions": Friction((level, 0.5 * level), viscous),
        "breakaway": Friction(level, viscous, 1.5 * level),
        "stribeck": Friction(level, viscous, stribeck=((0.0, 0.5 * level), (0.1, 0.2 * level), (1.0, 0.0))),
    }
    return kinds[draw(st.sampled_from(sorted(kinds)))]


@settings(max_examples=60, deadline=None, derandomize=True, database=None)
@given(plant=plants(), seed=st.integers(0, 10**6), rms=exponent(-1, 2), spread=exponent(-2, 1))
def test_ten_times_finer_sampling_changes_nothing(plant, seed, rms, spread):
    rng = np.random.default_rng(seed)
    n = len(plant.inertias)
    torque = rms * rng.standard_normal(SAMPLES)
    reach = max([s.backlash for s in plant.shafts if s.has_backlash], default=1e-3)
    # Every third start lies exactly on an edge, and some speeds are exactly zero.
    twists = rng.uniform(-1.0, 1.0, n - 1) * reach
    if seed % 3 == 0:
        twists = np.array([0.5 * s.backlash for s in plant.shafts])
    start = np.concatenate([twists, spread * rng.uniform(-1.0, 1.0, n) * rng.integers(0, 2, n)])
    moved, finer = {}, {}
    if plant.locked:
        # Linear between the samples, also where there are ten times as many.
        speed = np.linspace(0.0, spread * rng.uniform(-1.0, 1.0), SAMPLES)
        moved["speed_load"] = speed
        finer["speed_load"] = np.interp(np.arange(10 * SAMPLES) / 10.0, np.arange(SAMPLES), speed)
    coarse = trajectory(lm.simulate(plant, torque_motor=torque, dt=DT, state=start, **moved))
    fine = trajectory(
        lm.simulate(plant, torque_motor=np.repeat(torque, 10), dt=DT / 10, state=start, **finer)
    )
    fine = fine[::10]
    # Twists share one range and speeds another: one that hardly moves is wrong by the rounding of the others.
    range_twist, range_speed = (
        np.ptp(fine[:, : n - 1]) + np.max(np.abs(twists)),
        np.max(np.abs(fine[:, n - 1 :])),
    )
    span = np.concatenate([np.full(n - 1, range_twist), np.full(n, range_speed)]) + 1e-12
    assert np.max(np.abs(coarse - fine) / span) <= 1e-9
