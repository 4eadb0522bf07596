"""Limits of the plant: linear, conservative, at rest, on an edge; and what each contact law may do."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plants import trajectory
from scipy.linalg import expm
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Drivetrain, Friction, Shaft

DT = 1e-4


def noise(n: int, rms: float, seed: int) -> np.ndarray:
    return rms * np.random.default_rng(seed).standard_normal(n)


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("backlash", [0.0, 1e-10])
def test_no_backlash_is_the_matrix_exponential(contact, backlash):
    plant = Drivetrain.two_mass(**{**TABLE_I, "backlash": backlash, "coulomb": 0.0}, contact=contact)
    a, b = plant.linear()
    step = expm(DT * np.block([[a, b], [np.zeros((1, 4))]]))
    torque = noise(300, 10.0, 1)
    x = np.array([0.001, 1.0, -1.0])
    exact = [x]
    for u in torque:
        x = step[:3, :3] @ x + step[:3, 3] * u
        exact.append(x)
    got = trajectory(lm.simulate(plant, torque_motor=torque, dt=DT, state=exact[0]))
    exact = np.array(exact)
    assert np.max(np.abs(got - exact) / np.ptp(exact, axis=0)) < 2e-13


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_small_backlash_comes_to_the_linear_plant(contact):
    torque = 5.0 + noise(300, 1.0, 2)  # always on the same flank
    linear = Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.0}, contact=contact)
    start = (0.0005, 1.0, 1.0)
    expected = trajectory(lm.simulate(linear, torque_motor=torque, dt=DT, state=start))
    for backlash in (1e-6, 1e-8):
        got = trajectory(
            lm.simulate(linear.with_parameters(backlash=backlash), torque_motor=torque, dt=DT, state=start)
        )
        difference = np.max(np.abs(got - expected) / np.ptp(expected, axis=0))
        assert 0.0 < difference < 1e4 * backlash


def stored_energy(recording: lm.Recording, plant: Drivetrain) -> np.ndarray:
    """Kinetic energy and that of the spring, J; the physical law's spring is known from its torque and rate."""
    kinetic = 0.5 * plant.inertia_motor * recording["speed_motor"] ** 2
    kinetic += 0.5 * plant.inertia_load * recording["speed_load"] ** 2
    twist = recording["twist"]
    if plant.contact == "physical":
        damper = plant.damping * (recording["speed_motor"] - recording["speed_load"])
        elastic = (recording["torque_shaft"] - damper) / plant.stiffness
        elastic[np.abs(recording["torque_shaft"]) == 0.0] = 0.0
    else:
        elastic = twist - np.clip(twist, -plant.backlash / 2, plant.backlash / 2)
    return kinetic + 0.5 * plant.stiffness * elastic**2


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("damping", [0.0, 0.397])
def test_passive_plant_never_gains_energy(contact, damping):
    plant = Drivetrain.two_mass(**{**TABLE_I, "damping": damping, "coulomb": 0.1}, contact=contact)
    rng = np.random.default_rng(3)
    for _ in range(5):
        start = rng.uniform(-1, 1, 3) * (0.02, 20.0, 20.0)
        recording = lm.simulate(plant, torque_motor=np.zeros(2000), dt=DT, state=start)
        energy = stored_energy(recording, plant)
        # With the physical law the spring keeps some energy in the gap, which torque and twist do not show.
        rows = recording["torque_shaft"] != 0.0 if contact == "physical" else slice(None)
        energy = energy[rows]
        assert np.max(np.diff(energy)) <= 1e-13 * energy[0]
        assert energy[-1] < 0.99 * energy[0]


def test_conservative_bouncing_keeps_its_energy():
    plant = Drivetrain.two_mass(**{**TABLE_I, "damping": 0.0, "coulomb": 0.0, "viscous": 0.0})
    recording = lm.simulate(plant, torque_motor=np.zeros(100_000), dt=DT, state=(0.0, 3.0, -1.0))
    energy = stored_energy(recording, plant)
    impacts = sum(e.kind == "impact" for e in recording.events)
    assert impacts > 1000
    assert np.max(np.abs(energy / energy[0] - 1.0)) <= 1e-12


def torque_by_hand(plant: Drivetrain, twist: float, rate: float) -> float:
    """Section 1 of the design: torque of each law at a twist and its rate."""
    k, d, half = plant.stiffness, plant.damping, plant.backlash / 2
    dz = twist - min(max(twist, -half), half)
    if plant.contact == "viscoelastic":
        z = twist + d / k * rate
        return k * (z - min(max(z, -half), half))
    if plant.contact == "dead_zone":
        return k * dz + d * rate
    if plant.contact == "limited":
        return k * dz + min(max(d * rate, -abs(k * dz)), abs(k * dz))
    total = k * dz + d * rate  # clipped
    return 0.0 if dz == 0.0 else max(total, 0.0) if dz > 0.0 else min(total, 0.0)


@pytest.mark.parametrize("contact", [c for c in CONTACT_LAWS if c != "physical"])
def test_torque_of_each_law(contact, paper):
    plant = paper.with_contact(contact)
    recording = lm.simulate(plant, torque_motor=noise(3000, 20.0, 4), dt=DT)
    rate = recording["speed_motor"] - recording["speed_load"]
    expected = [torque_by_hand(plant, *row) for row in zip(recording["twist"], rate, strict=True)]
    shown = recording["torque_shaft"]
    assert np.ptp(shown) > 20.0
    np.testing.assert_allclose(shown, expected, rtol=0.0, atol=1e-10)


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_only_the_dead_zone_law_pulls(contact, paper):
    plant = paper.with_contact(contact)
    recording = lm.simulate(plant, torque_motor=noise(20_000, 20.0, 5), dt=DT)
    twist, torque, half = recording["twist"], recording["torque_shaft"], plant.backlash / 2
    pulls = (twist > half) & (torque < -1e-10) | (twist < -half) & (torque > 1e-10)
    in_gap = (np.abs(twist) < half) & (np.abs(torque) > 1e-10)
    assert np.any(np.abs(twist) > half)
    if contact == "dead_zone":
        assert pulls.any() and in_gap.any()
    else:
        assert not pulls.any()
    if contact in ("limited", "clipped", "physical"):
        assert not in_gap.any()


def test_stuck_load_stays_at_exactly_zero(paper):
    push = 1.0 + 0.5 * np.sin(np.arange(4000) * 0.03)
    recording = lm.simulate(paper, torque_motor=push, dt=DT, state=(0.0061, 0.0, 0.0))
    load = recording["speed_load"]
    assert recording["speed_motor"].any()
    stuck = load == 0.0
    assert stuck[-2000:].all()
    assert np.ptp(recording["angle_load"][-2000:]) < 1e-15


def test_torque_at_breakaway_starts_no_motion():
    plant = Drivetrain((0.1,), frictions=(Friction(coulomb=2.0, breakaway=2.5),))
    held = lm.simulate(plant, torque_motor=np.full(10, 2.5), dt=DT)
    assert not held["speed_motor"].any()
    assert held.events == ()
    freed = lm.simulate(plant, torque_motor=np.full(10, 2.5 + 2e-15), dt=DT)
    assert freed.events[0].kind == "slip"
    # Once it moves, Coulomb friction alone is left.
    assert freed["speed_motor"][-1] == pytest.approx(9 * DT * 0.5 / 0.1, rel=1e-12)


def test_directions_of_friction_differ():
    plant = Drivetrain((0.1,), frictions=(Friction(coulomb=(2.0, 0.5)),))
    forth = lm.simulate(plant, torque_motor=np.full(11, 3.0), dt=DT)["speed_motor"][-1]
    back = lm.simulate(plant, torque_motor=np.full(11, -3.0), dt=DT)["speed_motor"][-1]
    assert forth == pytest.approx(10 * DT * 1.0 / 0.1, rel=1e-12)
    assert back == pytest.approx(-10 * DT * 2.5 / 0.1, rel=1e-12)


def test_no_friction_and_no_damping_is_an_oscillator():
    plant = Drivetrain.two_mass(inertia_motor=1.0, inertia_load=1e6, stiffness=100.0)
    recording = lm.simulate(plant, torque_motor=np.zeros(20_000), dt=1e-3, state=(0.1, 0.0, 0.0))
    wave = 0.1 * np.cos(math.sqrt(100.0 * (1.0 + 1e-6)) * recording.time)
    assert np.max(np.abs(recording["twist"] - wave)) < 1e-13 * 20_000 * 0.1


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("twist", [0.0, 0.006, -0.006, np.nextafter(0.006, 1.0), 0.05])
def test_starts_in_at_and_beyond_the_gap(contact, twist, paper):
    """From each start, halving the sample time changes nothing: no crossing at the start is lost."""
    plant = paper.with_contact(contact)
    for rate in (-1.0, 0.0, 1.0):
        coarse = lm.simulate(plant, torque_motor=np.full(50, 3.0), dt=DT, state=(twist, rate, 0.0))
        fine = lm.simulate(plant, torque_motor=np.full(100, 3.0), dt=DT / 2, state=(twist, rate, 0.0))
        np.testing.assert_allclose(trajectory(coarse), trajectory(fine)[::2], rtol=0.0, atol=1e-12)


def test_input_step_that_lands_on_an_event():
    """Contact is left in exact arithmetic at a sample, where the torque also steps."""
    plant = Drivetrain.two_mass(inertia_motor=1.0, inertia_load=1.0, stiffness=100.0, backlash=0.02)
    omega = math.sqrt(200.0)
    dt = math.pi / omega / 64.0
    torque = np.concatenate([np.zeros(64), np.full(64, -3.0)])
    # Half a period in contact from the edge back to the edge, rate 1 → −1 rad/s.
    start = (0.01, 0.5, -0.5)
    recording = lm.simulate(plant, torque_motor=torque, dt=dt, state=start)
    rate = recording["speed_motor"] - recording["speed_load"]
    assert recording["twist"][64] == pytest.approx(0.01, abs=1e-14)
    assert rate[64] == pytest.approx(-1.0, abs=1e-12)
    t = np.arange(6) * dt
    np.testing.assert_allclose(recording["twist"][64:70], 0.01 - t - 1.5 * t**2, atol=1e-12)


def test_grazing_contact_is_free_flight():
    """A parabola in the gap whose top touches the edge from inside by less than rounding can tell."""
    plant = Drivetrain.two_mass(inertia_motor=1.0, inertia_load=1e9, stiffness=1e4, backlash=0.02)
    # Twist 0.01 − (t − 1)²/2 · 0.01 with torque −0.01 Nm: rate zero at t = 1 s.
    for clearance, hits in ((1e-9, False), (-1e-9, True)):
        start = (0.005 - clearance, 0.01, 0.0)
        recording = lm.simulate(plant, torque_motor=np.full(1999, -0.01), dt=1e-3, state=start)
        assert any(e.kind == "impact" for e in recording.events) == hits


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_contact_pole_beyond_the_sample_rate(contact):
    """k/d·T = 20: ten times finer sampling gives the same."""
    stiff = {**TABLE_I, "damping": 6285.896 / 2e5}
    plant = Drivetrain.two_mass(**stiff, contact=contact)
    torque = noise(200, 30.0, 6)
    coarse = trajectory(lm.simulate(plant, torque_motor=torque, dt=DT))
    fine = trajectory(lm.simulate(plant, torque_motor=np.repeat(torque, 10), dt=DT / 10))[::10]
    assert np.max(np.abs(coarse - fine) / np.ptp(fine, axis=0)) < 1e-11


def test_long_chain_of_backlashes_runs():
    n = 6
    shafts = tuple(Shaft(5000.0, 0.3, 0.004 if i in (1, 3, 4) else 0.0) for i in range(n - 1))
    frictions = tuple(Friction(0.2 if i in (0, 2, 5) else 0.0, 0.01) for i in range(n))
    chain = Drivetrain((0.02,) * n, shafts, frictions)
    torque = noise(2000, 10.0, 7)
    coarse = lm.simulate(chain, torque_motor=torque[:200], dt=DT)
    fine = lm.simulate(chain, torque_motor=np.repeat(torque[:200], 10), dt=DT / 10)
    places = {e.place for e in lm.simulate(chain, torque_motor=torque, dt=DT).events}
    assert {"shaft 2", "shaft 4", "shaft 5", "friction 1", "friction 3", "friction 6"} <= places
    np.testing.assert_allclose(trajectory(coarse), trajectory(fine)[::10], rtol=0.0, atol=1e-10)
