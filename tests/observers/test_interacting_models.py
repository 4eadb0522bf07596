"""Interacting models: probabilities that know the contact, and estimates as good as one filter's."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import gap_f1, relative_rmse

from lostmotion.errors import InvalidInput
from lostmotion.observers import interacting_models

DT = 1e-4
CHANCES = ("probability_contact_positive", "probability_gap", "probability_contact_negative")


@pytest.fixture(scope="module")
def result(experiment):
    return interacting_models(experiment.drivetrain, dt=DT, count_averaged=True).run(experiment.recording)


def test_probabilities_are_probabilities(result):
    chances = np.array([result[name] for name in CHANCES])
    assert chances.min() >= 0.0
    assert chances.sum(axis=0) == pytest.approx(1.0, abs=1e-12)


def test_the_likelier_model_is_the_true_contact(result, experiment):
    chances = np.array([result[name] for name in CHANCES])[:, 5000:]
    twist, half = experiment.exact["twist_3"][5000:], 0.5 * experiment.drivetrain.backlash
    truth = np.where(twist > half, 0, np.where(twist < -half, 2, 1))
    assert np.mean(np.argmax(chances, axis=0) == truth) > 0.97
    assert gap_f1(result["probability_gap"] > 0.5, experiment.exact, experiment.drivetrain.backlash) > 0.95


def test_estimates_the_rig(result, experiment):
    assert relative_rmse(result, experiment.exact, "speed_load") < 0.0015
    assert relative_rmse(result, experiment.exact, "torque_shaft") < 0.012


def test_deviations_grow_in_the_gap(result):
    gap = result["probability_gap"][5000:] > 0.99
    contact = result["probability_gap"][5000:] < 0.01
    twist = result["twist_deviation"][5000:]
    assert np.median(twist[gap]) > np.median(twist[contact])


def test_starts_in_the_wrong_contact(experiment):
    """The models begin with equal chances; from a drivetrain pressed on the lower side the right one is found."""
    rec = experiment.recording
    late = {name: rec[name][12345:20000] for name in ("torque_motor", "speed_motor")}
    result = interacting_models(experiment.drivetrain, dt=DT, count_averaged=True).run(late)
    error = result["speed_load_estimated"] - experiment.exact["speed_load"][12345:20000]
    assert np.max(np.abs(error[2000:])) < 0.01 * np.ptp(experiment.exact["speed_load"])


def test_misuse_is_refused(experiment):
    with pytest.raises(InvalidInput, match="measured"):
        interacting_models(experiment.drivetrain, dt=DT, measured=())
    with pytest.raises(InvalidInput, match="unknown_torque"):
        interacting_models(experiment.drivetrain, dt=DT, unknown_torque={"wheel": 1.0})
