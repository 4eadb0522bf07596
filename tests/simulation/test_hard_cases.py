"""Hard cases against the independent integration or a closed form: extreme ratios, edges, exact coincidences."""

from __future__ import annotations

import math

import numpy as np
import pytest
from independent import Independent
from plants import trajectory
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Drivetrain, Friction, Shaft
from lostmotion.simulation.plant_run import PlantRun

DT = 1e-4
#: A torque beyond the breakaway level by less than the rounding of its own sum does not exceed it.
ROUNDING = 4e-15
EVERY_LAW = pytest.mark.parametrize("contact", CONTACT_LAWS)


def error(plant: Drivetrain, torque: np.ndarray, start: tuple[float, ...]) -> tuple[float, int]:
    """Largest error as a fraction of each signal's range, and the reference's events."""
    reference = Independent(plant, 1e-13)
    expected = reference.run(torque, DT, np.array(start))
    got = trajectory(lm.simulate(plant, torque_motor=torque, dt=DT, state=start))
    span = np.ptp(expected, axis=0) + 1e-9
    return float(np.max(np.abs(got - expected) / span)), reference.events


@EVERY_LAW
def test_load_a_million_times_the_motor(contact):
    """Backlash and friction at both ends; the load's tiny motion is as exact as the motor's large one."""
    frictions = (Friction(0.1, 0.01), Friction(2.0, 0.02))
    plant = Drivetrain((0.01, 1e4), (Shaft(5000.0, 0.3, 0.01, contact),), frictions)
    torque = 20.0 * np.random.default_rng(3).standard_normal(150)
    worst, events = error(plant, torque, (0.0, 0.0, 1e-3))
    assert events >= 10
    assert worst <= 1e-9


@EVERY_LAW
def test_hard_contact_pole(contact):
    """k/d·T = 20."""
    plant = Drivetrain.two_mass(**{**TABLE_I, "damping": TABLE_I["stiffness"] / 2e5}, contact=contact)
    torque = 30.0 * np.random.default_rng(6).standard_normal(300)
    worst, events = error(plant, torque, (0.0, 0.0, 0.0))
    assert events >= 6
    assert worst <= 1e-9


@EVERY_LAW
def test_starts_inside_at_and_beyond_the_gap(contact, paper):
    plant = paper.with_contact(contact)
    half = 0.5 * TABLE_I["backlash"]
    for twist in (0.0, half, -half, np.nextafter(half, 1.0), 0.05, -0.05):
        for rate in (-1.0, 0.0, 1.0):
            worst, _ = error(plant, np.full(20, 3.0), (float(twist), rate, 0.0))
            assert worst <= 1e-9, (twist, rate)


@pytest.mark.parametrize("contact", [law for law in CONTACT_LAWS if law != "viscoelastic"])
@pytest.mark.parametrize("side", [1, -1])
def test_impact_comes_at_the_time_of_free_flight(contact, side):
    """A motor in the gap under constant torque before a held load: h = M t²/(2 J)."""
    plant = Drivetrain((0.02, 1.0), (Shaft(5000.0, 0.0, 0.01, contact),), locked="load")
    recording = lm.simulate(plant, torque_motor=np.full(400, side * 0.5), dt=DT)
    first = recording.events[0]
    time = math.sqrt(2.0 * 0.005 * 0.02 / 0.5)
    assert (first.kind, first.place) == ("impact", "shaft 1")
    assert first.time == pytest.approx(time, rel=1e-14)
    assert first.speed == pytest.approx(side * 0.5 / 0.02 * time, rel=1e-14)
    assert first.energy == pytest.approx(0.5 * 0.005, rel=1e-13)


def test_twist_exactly_at_breakaway_holds_a_stuck_load():
    """All numbers are powers of two: the shaft's torque on the load is its breakaway level, to the last bit."""
    friction = Friction(coulomb=2.0, breakaway=2.5)
    plant = Drivetrain((0.25, 0.5), (Shaft(4096.0),), (Friction(), friction))
    held = lm.simulate(plant, torque_motor=np.full(2000, 2.5), dt=DT, state=(2.5 / 4096.0, 0.0, 0.0))
    assert held.events == ()
    assert not held["speed_load"].any()
    assert np.max(np.abs(held["speed_motor"])) < 1e-15
    more = 2.5 * (1.0 + ROUNDING)
    freed = lm.simulate(plant, torque_motor=np.full(200, more), dt=DT, state=(more / 4096.0, 0.0, 0.0))
    assert (freed.events[0].kind, freed.events[0].time) == ("slip", 0.0)
    assert freed["speed_load"][-1] > 0.0


@pytest.mark.parametrize(("direction", "level"), [(1.0, 2.0), (-1.0, 0.5)])
def test_each_direction_has_its_own_level_at_rest(direction, level):
    plant = Drivetrain((0.1,), frictions=(Friction(coulomb=(2.0, 0.5)),))
    held = lm.simulate(plant, torque_motor=np.full(50, direction * level), dt=DT)
    assert not held["speed_motor"].any()
    freed = lm.simulate(plant, torque_motor=np.full(50, direction * level * (1.0 + ROUNDING)), dt=DT)
    assert freed.events[0].kind == "slip"


@pytest.mark.parametrize(("later", "moves"), [(1.0, False), (1.5, True), (-1.5, True), (0.0, False)])
def test_torque_step_that_lands_on_a_stop(later, moves):
    """Deceleration of 1 rad/s² from 1 rad/s in steps of 2⁻¹⁰ s: it stops exactly where the torque steps."""
    plant = Drivetrain((1.0,), frictions=(Friction(1.0),))
    torque = np.concatenate([np.zeros(1024), np.full(1024, later)])
    speed = lm.simulate(plant, torque_motor=torque, dt=2.0**-10, state=(1.0,))["speed_motor"]
    assert speed[1023] == pytest.approx(2.0**-10, abs=1e-13)
    assert abs(speed[1024]) < 1e-13
    t = np.arange(1, 1024) * 2.0**-10
    expected = math.copysign(abs(later) - 1.0, later) * t if moves else 0.0 * t
    np.testing.assert_allclose(speed[1025:], expected, rtol=0.0, atol=1e-12)
    if not moves:
        assert not speed[1025:].any()


def test_torque_step_that_lands_on_an_impact():
    """Free flight reaches the edge at 1/8 s, a sample, where the torque turns round: all numbers are powers of two."""
    plant = Drivetrain((1.0, 1.0), (Shaft(64.0, 0.0, 1.0 / 16.0),), locked="load")
    torque = np.concatenate([np.full(128, 4.0), np.full(128, -4.0)])
    recording = lm.simulate(plant, torque_motor=torque, dt=2.0**-10)
    assert recording.events[0].kind == "impact"
    assert recording.events[0].time == pytest.approx(0.125, abs=1e-14)
    t = (
        np.arange(128) * 2.0**-10
    )  # beyond the edge: an oscillator of 8 rad/s about −4/64 rad, from rest + 0.5 rad/s
    edge, middle = 1.0 / 32.0, -4.0 / 64.0
    expected = edge + middle - middle * np.cos(8.0 * t) + 0.5 / 8.0 * np.sin(8.0 * t)
    inside = expected > edge
    assert np.count_nonzero(inside) > 100
    np.testing.assert_allclose(recording["twist"][128:][inside], expected[inside], rtol=0.0, atol=1e-13)


def test_chain_of_bouncing_backlashes_keeps_its_energy():
    """Seven masses, three backlashes, nothing that dissipates: drift over 10 s."""
    shafts = tuple(Shaft(4000.0 + 500.0 * i, 0.0, 0.004 if i in (0, 3, 5) else 0.0) for i in range(6))
    plant = Drivetrain((0.02, 0.01, 0.015, 0.03, 0.01, 0.02, 0.05), shafts)
    start = (0.0,) * 6 + (3.0, -1.0, 2.0, 0.5, -2.0, 1.0, -0.5)
    recording = lm.simulate(plant, torque_motor=np.zeros(100_000), dt=DT, state=start)
    names = ("speed_motor", *(f"speed_{i}" for i in range(2, 7)), "speed_load")
    energy = sum(0.5 * j * recording[name] ** 2 for j, name in zip(plant.inertias, names, strict=True))
    for i, shaft in enumerate(shafts):
        twist, half = recording[f"twist_{i + 1}"], 0.5 * shaft.backlash
        energy = energy + 0.5 * shaft.stiffness * (twist - np.clip(twist, -half, half)) ** 2
    assert sum(event.kind == "impact" for event in recording.events) > 1000
    assert np.max(np.abs(energy / energy[0] - 1.0)) <= 1e-12


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"speed_reference": np.where(np.arange(50) == 49, np.nan, 1.0)}, "speed_reference.*sample 49"),
        ({"speed_reference": np.full(50, -np.inf)}, "speed_reference.*sample 0"),
        ({"torque_load": np.zeros(49)}, "lengths"),
        ({"state": (0.0, np.inf, 0.0)}, r"simulate\.state"),
        ({"dt": -1e-4}, r"simulate\.dt"),
    ],
)
def test_bad_numbers_are_refused_before_anything_runs(change, where, monkeypatch):
    """Also in a loop."""

    def never(*_arguments: object) -> None:
        raise AssertionError("the run began")

    monkeypatch.setattr(PlantRun, "finish", never)
    law = lm.DiscreteSystem(
        inputs=("speed_reference",), outputs=("torque_motor",), D=np.array([[1.0]]), dt=DT, name="forward"
    )
    arguments = {"dt": DT, "law": law, "speed_reference": np.ones(50), **change}
    with pytest.raises(lm.InvalidInput, match=where):
        lm.simulate(Drivetrain.two_mass(**TABLE_I), **arguments)
