"""Zero, pole and lag from the frequency response of what the search has."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.starts.frequency_response import (
    linear_drive,
)
from lostmotion.identification.prediction_error.innovations import Predictor


def test_a_drive_without_a_gap_is_shown_whole(plant: lm.Drivetrain):
    """By a PRBS in 16 bit. The exact lag is a sample and a half."""
    dt, drive = 2e-4, plant.with_parameters(backlash=0.0, coulomb=0.0)
    torque = 10.0 * np.sign(np.random.default_rng(1).standard_normal(2500)).repeat(4)
    count = 2.0 * np.pi / 2**16
    angle = np.floor(lm.simulate(drive, torque_motor=torque, dt=dt)["angle_motor"] / count) * count
    flt = ContactFilter.of(
        Predictor(torque, np.diff(angle, prepend=0.0) / dt, dt, True, drive, skip=0), 300.0
    )
    shown = linear_drive(flt, drive)
    assert shown["delay"] == pytest.approx(3e-4, abs=0.2 * dt)
    for name in ("inertia_motor", "inertia_load", "stiffness"):
        assert shown[name] == pytest.approx(getattr(drive, name), rel=0.33), name
    found = drive.with_parameters(**{name: value for name, value in shown.items() if name != "delay"})
    assert found.pole_frequency == pytest.approx(drive.pole_frequency, rel=0.05)


def test_torque_and_speed_that_do_not_belong_together_show_nothing(flt: ContactFilter, plant: lm.Drivetrain):
    noise = np.random.default_rng(1).standard_normal((2, flt.rows))
    apart = replace(flt, torque=noise[0], measured=np.cumsum(noise[1]) if flt.counted else noise[1])
    assert "stiffness" not in linear_drive(apart, plant)


def test_the_longest_segment_counts(flt: ContactFilter, plant: lm.Drivetrain):
    """A short segment before it, in another direction, changes nothing."""
    whole = linear_drive(flt, plant)
    first = 200
    pieces = replace(
        flt,
        torque=np.r_[-flt.torque[:first], flt.torque],
        measured=np.r_[flt.measured[:first], flt.measured],
        bounds=(0, first, first + flt.rows),
    )
    assert linear_drive(pieces, plant) == whole


def test_a_mode_of_another_inertia_is_none(flt: ContactFilter, plant: lm.Drivetrain):
    shown, heavy = linear_drive(flt, plant), plant.with_parameters(inertia_load=1.0)
    assert "stiffness" in shown and linear_drive(flt, heavy) == {"delay": shown["delay"]}
