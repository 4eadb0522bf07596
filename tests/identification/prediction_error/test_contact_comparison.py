"""The contact law by prediction error: the true one, or an honest "cannot be told"."""

from __future__ import annotations

import numpy as np
import pytest
from lagged_drive import DT, PLANT, speed_from_counts

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_comparison import compare_contacts


def recorded(plant: lm.Drivetrain, bits: int, seed: int = 1) -> lm.Recording:
    torque = lm.signals.excitation(2.0, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(plant, torque_motor=torque, dt=DT)
    count = 2.0 * np.pi / 2**bits
    speed = speed_from_counts(run, count)
    return run.only("torque_motor").with_signals("measured", speed_motor=speed)


@pytest.mark.parametrize("true", ["viscoelastic", "dead_zone"])
def test_the_true_law_predicts_better(true: str):
    """In most recordings, and never the wrong one: a single block that stands out makes it "cannot be told"."""
    told = []
    for seed in (1, 2, 3):
        result = compare_contacts(recorded(PLANT.with_contact(true), 20, seed), start=PLANT)
        assert result.better in (true, None)
        if result.better == true:
            assert result.problems == () and result.gain > 0.1 and result.certainty > 3.0
            assert result.found[true].drivetrain.contact == true
            assert result.found[true].values["damping"] == pytest.approx(PLANT.damping, rel=0.02)
        told.append(result.better)
    assert told.count(true) >= 2


def test_without_much_damping_they_cannot_be_told_apart():
    plant = PLANT.with_parameters(damping=0.004)
    result = compare_contacts(recorded(plant, 18), start=plant, fixed=("damping", "viscous", "lag"))
    assert result.better is None
    (problem,) = result.problems
    assert "cannot be distinguished" in problem.remedy
    assert set(result.found) == {"viscoelastic", "dead_zone"}
