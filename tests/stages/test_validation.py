"""Stage 4: withheld signals stay withheld, and controllers meet a plant they were not designed with."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.stages.design import design, observer
from lostmotion.stages.figures import figures
from lostmotion.stages.material import from_rig
from lostmotion.stages.parameters import find_parameters
from lostmotion.stages.speed_step import SpeedStep
from lostmotion.stages.validation import validate, validate_controllers, validate_observers


@pytest.fixture(scope="module")
def prepared():
    material, truth = from_rig(1)
    return material, find_parameters(material), truth


def test_withheld_signals_change_no_estimate(prepared) -> None:
    material, found, _ = prepared
    falsified = material.validate.with_signals(
        "measured",
        speed_load=np.full(len(material.validate), 7.0),
        twist=np.full(len(material.validate), 1.0),
    )
    _, honest = validate_observers(material, found)
    _, blind = validate_observers(replace(material, validate=falsified), found)
    for name in ("observer_1", "observer_2"):
        for signal in honest[name]:
            assert np.array_equal(honest[name][signal], blind[name][signal]), (name, signal)


def test_missing_signals_are_skipped_with_a_reason(prepared) -> None:
    material, found, _ = prepared
    poor = replace(material, validate=material.validate.only("torque_motor", "speed_motor"))
    table, estimates = validate_observers(poor, found)
    assert set(estimates) == {"observer_1"}
    assert table["observer_2"] == {"skipped": "no torque_shaft in the recording"}
    assert table["observer_1"]["speed_load"] == {"skipped": "no speed_load in the recording"}
    without = replace(material, validate=material.validate.only("speed_motor"))
    assert validate_observers(without, found)[0] == {"skipped": "no torque_motor in the recording"}


def test_user_plant_is_finer_than_the_model_and_within_the_intervals(prepared) -> None:
    material, found, _ = prepared
    plants = [lm.rig.finer_rig(found.drivetrain, found.intervals, seed).drivetrain for seed in range(20)]
    for plant in plants:
        assert len(plant.inertias) == 4
        assert plant.shafts[2].contact == "physical"
        low, high = found.intervals["backlash"]
        assert low <= plant.shafts[2].backlash <= high
        low, high = found.intervals["inertia_load"]
        assert low <= plant.inertias[3] <= high
    assert len({plant.shafts[1].stiffness for plant in plants}) == 20
    table, _, _, _ = validate_controllers(replace(material, virtual=False), found, design(material, found))
    assert "simulated" in table["plant"]
    assert table["pole_placement"]["overshoot"] < 3.0


def test_no_gap_and_no_friction_validate_as_well(prepared) -> None:
    material, found, _ = prepared
    plain = replace(found, drivetrain=found.drivetrain.with_parameters(backlash=0.0, coulomb=0.0), table={})
    table, _, _, _ = validate_controllers(replace(material, virtual=False), plain, design(material, plain))
    assert table["pi"]["steady_error"] < 0.01
    assert table["soft_landing"] == {"skipped": "no backlash to land in"}


def test_soft_landing_is_as_quick_and_lands_softly(prepared) -> None:
    material, found, _ = prepared
    table, responses, _, _ = validate_controllers(material, found, design(material, found))
    hard, soft = table["pole_placement"], table["soft_landing"]
    assert set(responses) == {"pi", "pole_placement", "soft_landing"}
    assert soft["impact_speed"] < 0.25 * hard["impact_speed"]
    assert soft["rise_time"] < 1.1 * hard["rise_time"] and soft["overshoot"] < 1.0


def test_torque_of_the_rig_reaches_the_observer_in_time(prepared) -> None:
    """The recorded torque is the set-point that acts in its row: one sample off would show in the estimate."""
    material, _, truth = prepared
    model = lm.Drivetrain.two_mass(**truth.parameters)
    recording = material.validate
    estimate = observer(model, "observer_1", recording.dt, True).run(
        recording.only("torque_motor", "speed_motor")
    )
    errors = []
    for shift in (-2, 0, 2):
        moved = recording.with_signals("measured", torque_motor=np.roll(recording["torque_motor"], shift))
        estimate = observer(model, "observer_1", recording.dt, True).run(
            moved.only("torque_motor", "speed_motor")
        )
        errors.append(
            np.sqrt(np.mean((estimate["speed_load_estimated"] - recording["speed_load"])[3000:] ** 2))
        )
    assert errors[1] < min(errors[0], errors[2])


def test_a_loop_that_runs_away_is_a_result_with_a_warning(prepared) -> None:
    """A PI far too strong for the drive: no overshoot of 0 %, no abort, the other law stays."""
    material, found, _ = prepared
    wild = replace(
        material, virtual=False, settings=replace(material.settings, kp=400.0, torque_limit=np.inf)
    )
    unlimited = replace(found, drivetrain=found.drivetrain.with_parameters(torque_limit=np.inf))
    table, responses, _, problems = validate_controllers(wild, unlimited, design(wild, unlimited))
    assert "unstable" in table["pi"]["skipped"]
    assert set(responses) == {"pole_placement"}
    assert any("pi" in p.where for p in problems)
    assert table["pole_placement"]["overshoot"] < 3.0


def test_a_step_that_is_too_short_for_the_law_is_lengthened_until_both_settle(prepared) -> None:
    material, found, _ = prepared
    laws = design(material, found)
    short = replace(laws, step=SpeedStep(-2.0, 2.0, 0.03, 0.06, 0.09))
    table, responses, step, problems = validate_controllers(material, found, short)
    assert step.stop - step.start >= 0.12  # the PI of the paper settles in 0.13 s
    assert all(table[name]["settling_time"] < step.stop - step.start for name in responses)
    assert problems == ()


def test_a_loop_that_never_arrives_has_no_overshoot(prepared) -> None:
    """A torque limit below the friction: the load does not follow, on any processor."""
    material, found, _ = prepared
    own = replace(
        material.settings, torque_limit=0.5 * found.drivetrain.coulomb, poles=(-100.0, -100.0, -100.0)
    )
    weak = replace(material, settings=own)
    table, _, _, problems = validate_controllers(weak, found, design(weak, found))
    assert table["pole_placement"]["overshoot"] is None
    assert any("pole_placement" in p.where for p in problems)


def test_a_pi_that_cannot_be_designed_leaves_the_law(prepared) -> None:
    material, found, _ = prepared
    laws = design(replace(material, settings=replace(material.settings, ki=200_000.0)), found)
    assert laws.pi is None
    assert "pi.ki" in laws.pi_skipped
    assert laws.law is not None
    assert [p.severity for p in laws.problems] == ["warning"]


def test_nothing_of_the_virtual_rig_is_called_measured(prepared) -> None:
    material, found, _ = prepared
    laws = design(material, found)
    validation = validate(material, found, laws)
    for recording in (*material.recordings.values(), *validation.responses.values()):
        assert set(recording.origin.values()) <= {"simulated", "reference", "estimated"}
    shown = figures(material, found, laws, validation, None)
    labels = {str(line.get_label()) for one in shown for axis in one.image.axes for line in axis.lines}
    assert {"simulated", "virtual rig (simulated)"} <= labels
    assert not [text for text in (*labels, *(one.caption for one in shown)) if "measured" in text.lower()]
