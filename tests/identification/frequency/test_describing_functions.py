"""Describing functions: limits, a check against simulation, and the virtual rig's zero and pole under random torque."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.identification.frequency.analysis import frequency_analysis
from lostmotion.identification.frequency.describing_functions import gaussian_equivalent


def torque(rms=16.0, duration=30.0, dt=5e-4):
    return np.clip(lm.signals.noise(1.0, 300.0, rms, duration, dt, seed=2), -73.5, 73.5)


def test_without_gap_and_friction_it_is_the_drivetrain_itself():
    plain = PAPER.with_parameters(backlash=0.0, coulomb=0.0)
    found = gaussian_equivalent(plain, torque(), 5e-4)
    assert found.gap_gain == 1.0
    assert found.drivetrain == plain
    simulated = lm.simulate(plain, dt=5e-4, torque_motor=torque())
    assert found.twist == pytest.approx(simulated["twist"].std(), rel=0.02)


def test_gain_and_spread_agree_with_each_other():
    found = gaussian_equivalent(PAPER, torque(), 5e-4)
    assert found.settled
    assert found.gap_gain == pytest.approx(math.erfc(0.006 / (math.sqrt(2.0) * found.twist)), rel=1e-5)
    expected = 0.0175 + 2.0 * math.sqrt(2.0 / math.pi) / found.speed_load
    assert found.drivetrain.viscous == pytest.approx(expected, rel=1e-5)
    assert found.zero == pytest.approx(PAPER.zero_frequency * math.sqrt(found.gap_gain))


def test_more_torque_hides_the_gap():
    gains = [gaussian_equivalent(PAPER, torque(rms), 5e-4).gap_gain for rms in (4.0, 8.0, 16.0, 32.0)]
    assert all(a < b for a, b in zip(gains, gains[1:], strict=False))


def test_spread_of_the_nonlinear_simulation():
    found = gaussian_equivalent(PAPER, torque(), 5e-4)
    simulated = lm.simulate(PAPER, dt=5e-4, torque_motor=torque())
    assert found.twist == pytest.approx(simulated["twist"].std(), rel=0.15)
    assert found.speed_load == pytest.approx(simulated["speed_load"].std(), rel=0.15)


def test_the_rig_shows_zero_and_pole_lower_as_predicted():
    """Figures 8 and 9 of the paper: both lie below the linear ones; the coherence is low at the zero in either."""
    rig, signal = lm.rig.nominal_rig(), torque(16.0, 40.0, 1e-4)
    shut = replace(
        rig,
        drivetrain=replace(
            rig.drivetrain, shafts=tuple(replace(s, backlash=0.0) for s in rig.drivetrain.shafts)
        ),
    )
    zeros, poles, lowest = [], [], []
    for plant in (rig, shut):
        recording, _ = lm.rig.record(plant, torque_motor=signal)
        found = frequency_analysis(recording, segment=2.0, band=(3.0, 250.0), fit_band=(5.0, 180.0))
        zeros.append(found.fit.values["zero"])
        poles.append(found.fit.values["pole"])
        near = found.response.band(0.9 * zeros[-1], 1.1 * zeros[-1])
        lowest.append(found.response.coherence[near].min() / np.median(found.response.coherence))
    assert zeros[1] == pytest.approx(38.0, abs=1.0)
    assert poles[1] == pytest.approx(100.4, abs=1.0)
    assert max(lowest) < 0.75
    equivalent = lm.rig.two_mass_equivalent(rig.drivetrain, np.linspace(-20.0, 20.0, 401))
    model = lm.Drivetrain.two_mass(**{**equivalent, "coulomb": 2.0, "viscous": 0.0175})
    predicted = gaussian_equivalent(model, signal, 1e-4)
    assert zeros[0] == pytest.approx(predicted.zero, rel=0.08)
    assert poles[0] == pytest.approx(predicted.pole, rel=0.04)
    assert zeros[0] < 0.87 * zeros[1]
    assert poles[0] < 0.85 * poles[1]


def test_a_constant_torque_is_refused():
    with pytest.raises(InvalidInput):
        gaussian_equivalent(PAPER, np.ones(100), 1e-3)
