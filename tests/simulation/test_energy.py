"""Energies: each integrated on its own, so that the balance is a check; energy of impacts."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import TABLE_I
from test_chains import chain

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Drivetrain, Friction, Shaft

DT = 1e-4


def noise(n: int, rms: float, seed: int) -> np.ndarray:
    return rms * np.random.default_rng(seed).standard_normal(n)


def assert_balanced(recording: lm.Recording, power: np.ndarray) -> None:
    energy = recording.energy()
    exchanged = np.sum(np.abs(power)) * DT
    assert exchanged > 0.0
    assert np.max(np.abs(energy["balance"])) <= 1e-9 * exchanged
    assert np.min(np.diff(energy["dissipated"])) >= -1e-12 * exchanged


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("lag", [0.0, 1e-3])
def test_balance_of_two_masses(contact, lag):
    plant = Drivetrain.two_mass(**TABLE_I, contact=contact, lag=lag)
    recording = lm.simulate(plant, torque_motor=noise(3000, 15.0, 1), dt=DT, energy=True)
    assert len(recording.events) > 30
    assert_balanced(recording, recording["torque_motor"] * recording["speed_motor"])
    assert recording.energy()["dissipated"][-1] > 1e-3


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_balance_of_a_chain(contact):
    recording = lm.simulate(
        chain(4, contact), torque_motor=noise(2000, 20.0, 2), torque_3=noise(2000, 5.0, 3), dt=DT, energy=True
    )
    assert_balanced(recording, recording["torque_motor"] * recording["speed_motor"])


def test_dissipation_of_viscous_friction_alone():
    """A rigid drive coasts down: all its kinetic energy goes into friction."""
    plant = Drivetrain((0.5,), frictions=(Friction(viscous=0.2),))
    recording = lm.simulate(plant, torque_motor=np.zeros(20_000), dt=1e-3, state=(3.0,), energy=True)
    expected = 0.5 * 0.5 * 9.0 * (1.0 - np.exp(-2.0 * 0.2 / 0.5 * recording.time))
    np.testing.assert_allclose(recording.energy()["dissipated"], expected, rtol=0.0, atol=1e-12)


def test_moved_end_puts_energy_in():
    plant = Drivetrain((0.02, 1.0), (Shaft(5000.0, 0.3, 0.01),), locked="load")
    speed = 2.0 * np.sin(np.arange(3000) * 0.02)
    recording = lm.simulate(plant, torque_motor=np.zeros(3000), speed_load=speed, dt=DT, energy=True)
    assert_balanced(recording, recording["torque_shaft"] * recording["speed_load"])
    assert np.max(recording.energy()["stored"]) > 1e-3


def test_impacts_carry_the_energy_of_the_reduced_inertia(paper):
    recording = lm.simulate(paper, torque_motor=noise(3000, 15.0, 4), dt=DT)
    reduced = 0.0182 * 0.111 / (0.0182 + 0.111)
    impacts = [e for e in recording.events if e.kind == "impact"]
    assert impacts
    for event in impacts:
        assert event.energy == pytest.approx(0.5 * reduced * event.speed**2, rel=1e-12)
    assert all(e.energy == 0.0 for e in recording.events if e.kind != "impact")


def test_recording_without_energies_says_so(paper):
    with pytest.raises(lm.InvalidInput, match="energy"):
        lm.simulate(paper, torque_motor=np.zeros(10), dt=DT).energy()
