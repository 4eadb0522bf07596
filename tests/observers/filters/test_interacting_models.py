"""Interacting models: probabilities that know the contact, and estimates as good as one filter's."""

from __future__ import annotations

import numpy as np
import pytest
from rig_runs import gap_f1, relative_rmse
from table_i import PAPER

from lostmotion.compare.cases import CASES
from lostmotion.compare.experiment import experiment as rig_case
from lostmotion.errors import InvalidInput
from lostmotion.kernels.estimators.interacting_models.mixing import PARTS, regions
from lostmotion.observers import interacting_models, kalman
from lostmotion.signals import excitation
from lostmotion.simulation import simulate

DT = 1e-4
CHANCES = ("probability_contact_positive", "probability_gap", "probability_contact_negative")


@pytest.fixture(scope="module")
def result(experiment):
    return interacting_models(experiment.drivetrain, dt=DT, speed_from_counts=True).run(experiment.recording)


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
    result = interacting_models(experiment.drivetrain, dt=DT, speed_from_counts=True).run(late)
    error = result["speed_load_estimated"] - experiment.exact["speed_load"][12345:20000]
    assert np.max(np.abs(error[2000:])) < 0.01 * np.ptp(experiment.exact["speed_load"])


def load_errors(name, seed, duration):
    """RMSE of the load speed (rad/s) of the interacting models and of Observer 1 in a case of the comparison."""
    case = next(c for c in CASES if c.name == name)
    data = rig_case(case, seed, duration)
    rec = data.recording.only("torque_motor", "speed_motor")
    estimates = [
        make(data.drivetrain, dt=DT, speed_from_counts=True).run(rec) for make in (interacting_models, kalman)
    ]
    errors = [(e["speed_load_estimated"] - data.truth["speed_load"])[data.judged] for e in estimates]
    return [float(np.sqrt(np.mean(error**2))) for error in errors]


@pytest.mark.parametrize("seed", [3, 6, 13, 20])
def test_does_not_lock_onto_a_wrong_twist_while_the_load_sticks(seed):
    """Lost between the edges, with a load torque that explained it: ten times Observer 1's error on these rigs."""
    models, first = load_errors("sticking", seed, 1.0)
    assert models < 0.5 * first


@pytest.mark.parametrize("seed", [3, 6, 13])
def test_finds_the_other_side_of_the_gap_as_fast_as_observer_1(seed):
    """The twist is off by the whole backlash and the models are sure of it; it took up to 2.4 times its error."""
    models, first = load_errors("wrong start", seed, 0.8)
    assert models < first


@pytest.mark.parametrize("z", [-0.004, 0.0, 0.0055, 0.009])
@pytest.mark.parametrize("deviation", [1e-3, 4e-3])
def test_parts_of_a_normal_distribution_have_their_own_moments(z, deviation):
    half = 0.006
    grid = z + deviation * np.linspace(-9.0, 9.0, 2000001)
    density = np.exp(-0.5 * ((grid - z) / deviation) ** 2)
    density /= density.sum()
    inside = [grid > half, np.abs(grid) <= half, grid < -half]
    found = np.zeros(1, PARTS)[0]
    regions(z, half, deviation, found)
    chance, shift, lost = found["chance"], found["shift"], found["lost_share"]
    for m, part in enumerate(inside):
        share = density[part].sum()
        assert chance[m] == pytest.approx(share, abs=1e-5)
        if share > 1e-3:
            mean = density[part] @ grid[part] / share
            variance = density[part] @ (grid[part] - mean) ** 2 / share
            assert z + shift[m] == pytest.approx(mean, abs=1e-3 * deviation)
            assert 1.0 - lost[m] == pytest.approx(variance / deviation**2, abs=2e-3)


def test_the_coulomb_level_is_found(experiment):
    wrong = experiment.drivetrain.with_parameters(coulomb=1.2 * experiment.drivetrain.coulomb)
    result = interacting_models(wrong, dt=DT, speed_from_counts=True).run(experiment.recording)
    found = np.mean(result["coulomb_estimated"][-5000:])
    assert found == pytest.approx(experiment.drivetrain.coulomb, rel=0.1)


def test_misuse_is_refused(experiment):
    with pytest.raises(InvalidInput, match="measured"):
        interacting_models(experiment.drivetrain, dt=DT, measured=())
    with pytest.raises(InvalidInput, match="process_torque"):
        interacting_models(experiment.drivetrain, dt=DT, process_torque={"wheel": 1.0})


@pytest.mark.parametrize(("offset", "told"), [(20.0, 0.85), (40.0, 0.95), (80.0, 0.95)])
def test_a_torque_that_jumps_is_no_touch(offset, told):
    """One of the three models expects nearly any torque; 0 to 30 % of these samples were flagged."""
    torque = excitation(2.0, DT, seed=2, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    exact = simulate(PAPER.with_parameters(contact="dead_zone"), dt=DT, torque_motor=torque)
    shown = exact["torque_shaft"] + 0.3 * np.random.default_rng(0).normal(size=torque.size)
    bad = np.zeros(torque.size, dtype=bool)
    for first in range(5000, 19000, 1500):
        bad[first : first + 30] = True
    law = interacting_models(PAPER, dt=DT, measured=("torque_shaft", "speed_motor"))
    given = {"torque_motor": torque, "speed_motor": exact["speed_motor"]}
    found = law.run({**given, "torque_shaft": shown + offset * bad})
    assert np.mean(found["input_fault"][bad]) > told
    assert np.mean(found["input_fault"][~bad]) < 0.01
