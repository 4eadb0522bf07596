"""Remedies help: each test meets a problem, does what its remedy says, and the problem is gone."""

from __future__ import annotations

import re
import sys
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.drivetrain import Actuator
from lostmotion.errors import Problem
from lostmotion.rig import Rig
from lostmotion.stages.design import design
from lostmotion.stages.material import Material, Settings
from lostmotion.stages.parameters import Found, find_parameters
from lostmotion.stages.validation import control_step, judged_step, validate_controllers

# What a remedy changes shows after a short search as well.
pytestmark = pytest.mark.usefixtures("short_search")

DT = 2e-4
KNOWN = {
    "inertia_motor": 0.018, "inertia_load": 0.11, "stiffness": 6000.0, "damping": 0.4, "backlash": 0.012,
    "coulomb": 2.0, "viscous": 0.0175, "lag": 3e-4,
}  # fmt: skip
START = {"inertia_motor": 0.015, "inertia_load": 0.13, "stiffness": 5000.0, "backlash": 0.015, "coulomb": 1.5}


def material(
    recording: lm.Recording | None = None, nameplate: dict[str, float] = KNOWN, **settings: Any
) -> Material:
    return Material(
        nameplate,
        Settings(**settings),
        1,
        False,
        recording,
        None,
        {} if recording is None else {"log": recording},
        {} if recording is None else {"log": "identify"},
    )


def recorded(
    seconds: float = 2.0,
    torque_load: float = 0.0,
    sign: float = 1.0,
    step: float = 0.0,
    size: float = 1.0,
    levels: tuple[float, ...] = (6.0, 30.0, -30.0, -6.0) * 2,
    **changed: float,
) -> lm.Recording:
    """A two-mass drive under the usual excitation: noise on the speed, and counts of this step (rad/s)."""
    plant = lm.Drivetrain.two_mass(**(KNOWN | changed))
    torque = size * lm.signals.excitation(
        seconds, DT, seed=3, inertia=0.128, coulomb=2.0, viscous=0.0175, levels=levels
    )
    run = lm.simulate(plant, torque_motor=torque, torque_load=np.full(torque.size, torque_load), dt=DT)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(len(run))
    if step:  # an encoder's angle in counts, and its difference over the sample
        angle = np.cumsum(np.concatenate([[0.0], speed]))
        speed = step * np.diff(np.round(angle / step))
    return lm.Recording(
        time=run.time, signals={"torque_motor": sign * run["torque_motor"], "speed_motor": speed}
    )


def told(found: Found, words: str) -> Problem:
    (problem,) = [p for p in found.problems if words in p.remedy]
    return problem


def about(found: Found, words: str) -> list[Problem]:
    return [p for p in found.problems if words in p.remedy]


@pytest.fixture(scope="module")
def sound() -> tuple[lm.Recording, Found]:
    """One second of the usual excitation, and what is found in it from a good nameplate."""
    recording = recorded(1.0)
    return recording, find_parameters(material(recording, START))


def without_second_estimator(monkeypatch: pytest.MonkeyPatch, reasons: Sequence[Problem] = ()) -> None:
    """The fit alone, with the reasons that the second estimator would give; it needs few remedies."""
    # The package's function hides the module of its name.
    module = sys.modules["lostmotion.identification.prediction_error.identify"]
    monkeypatch.setattr(module, "confirmed", lambda *fit: (*fit[:3], list(reasons)))


def coulomb_error(found: Found) -> float:
    return abs(found.table["coulomb"]["value"] / KNOWN["coulomb"] - 1.0)


def test_friction_of_the_motor_that_the_nameplate_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """``coulomb_motor`` under [nameplate], for the fit; the second estimator finds it without."""
    assert coulomb_error(find_parameters(material(recorded(coulomb_motor=1.0), START))) < 0.02
    without_second_estimator(monkeypatch)
    recording = recorded(5.0, coulomb_motor=1.0)
    without = find_parameters(material(recording, START))
    assert "coulomb_motor under [nameplate]" in told(without, "coulomb_motor").remedy
    helped = find_parameters(material(recording, START | {"coulomb_motor": 1.0}))
    assert coulomb_error(without) > 0.1 and coulomb_error(helped) < 0.02
    residual = [found.identification.prediction.rms for found in (without, helped) if found.identification]
    assert residual[1] < 0.5 * residual[0]


def test_a_torque_on_the_load(monkeypatch: pytest.MonkeyPatch) -> None:
    """``load_torque = true`` under [identify], for the fit; the second estimator finds it without."""
    recording = recorded(torque_load=-1.5)
    assert coulomb_error(find_parameters(material(recording, START))) < 0.01
    without_second_estimator(monkeypatch)
    without = find_parameters(material(recording, START))
    assert "load_torque = true under [identify]" in told(without, "load_torque").remedy
    helped = find_parameters(material(recording, START, load_torque=True))
    assert coulomb_error(helped) < 0.3 * coulomb_error(without)


def test_parameters_that_cannot_be_told_apart(monkeypatch: pytest.MonkeyPatch) -> None:
    """``fixed = [...]`` under [identify]: at one speed, Coulomb and viscous friction act alike."""
    without_second_estimator(monkeypatch)
    recording = recorded(seconds=3.0, levels=(20.0,))
    without = find_parameters(material(recording, KNOWN))
    problem = told(without, "fixed = [...] under [identify]")
    name = problem.where.split(", ")[-1]
    helped = find_parameters(material(recording, KNOWN, fixed=(name,)))
    assert not [p for p in helped.problems if "fixed" in p.remedy]
    assert helped.table[name]["source"] == "nameplate"


def test_a_torque_of_the_wrong_sign() -> None:
    """``sign`` in the torque's channel."""
    from lostmotion.io import check_recording

    wrong = [p for p in check_recording(recorded(sign=-1.0)) if "sign = -1" in p.remedy]
    assert len(wrong) == 1
    assert not [p for p in check_recording(recorded()) if "sign" in p.remedy]


def test_counts_that_are_too_coarse(monkeypatch: pytest.MonkeyPatch) -> None:
    """Faster motion with more torque, for the fit: what is lost in the counts no estimator finds."""
    without_second_estimator(monkeypatch)
    coarse = find_parameters(material(recorded(step=600.0), START))
    assert "faster motion with more torque" in told(coarse, "Nothing is identified").remedy
    helped = find_parameters(material(recorded(step=600.0, size=400.0), START))
    assert not about(helped, "Nothing is identified")
    assert helped.table["backlash"]["source"] == "identified"


def test_counts_that_are_too_coarse_are_one_message(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever the second estimator says besides: it saw the same counts."""
    from lostmotion.identification.prediction_error import problems

    without_second_estimator(monkeypatch, [problems.rigid()])
    coarse = find_parameters(material(recorded(1.0, step=15.0), START))
    assert told(coarse, "Nothing is identified").where == "speed_motor"
    fine = find_parameters(material(recorded(1.0), START))
    assert told(fine, "Nothing is identified").where == "identification"


@pytest.mark.parametrize("name", ["inertia_motor", "inertia_load", "stiffness"])
def test_a_parameter_that_is_not_known(name: str) -> None:
    """The nameplate's key."""
    missing = find_parameters(material(None, {n: v for n, v in KNOWN.items() if n != name}, sample_time=1e-4))
    assert missing.drivetrain is None
    assert f"{name} = ... under [nameplate]" in missing.missing
    assert find_parameters(material(None, KNOWN, sample_time=1e-4)).drivetrain is not None


def test_start_values_that_are_not_given(sound: tuple[lm.Recording, Found]) -> None:
    recording, helped = sound
    missing = find_parameters(material(recording, {"stiffness": 5000.0}))
    assert missing.skipped == "no start value for inertia_motor, inertia_load: add it to [nameplate]"
    assert not helped.skipped


@pytest.mark.parametrize(("name", "factor"), [("inertia_load", 4.0), ("backlash", 4.0), ("stiffness", 0.2)])
def test_a_nameplate_that_is_far_off(
    sound: tuple[lm.Recording, Found], name: str, factor: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The value under [nameplate]; the fit finds what is far off."""
    recording, helped = sound
    without_second_estimator(monkeypatch)
    without = find_parameters(material(recording, START | {name: factor * START[name]}))
    problem = told(without, "Check the value under [nameplate]")
    assert problem.where == name
    assert not about(helped, "Check the value under [nameplate]")


def test_a_torque_in_another_unit(sound: tuple[lm.Recording, Found], monkeypatch: pytest.MonkeyPatch) -> None:
    """``scale`` and ``unit`` in the channel of the torque: here it was recorded as a tenth of what it is."""
    recording, helped = sound
    without_second_estimator(monkeypatch)
    tenth = lm.Recording(
        recording.time,
        {"torque_motor": 0.1 * recording["torque_motor"], "speed_motor": recording["speed_motor"]},
    )
    without = find_parameters(material(tenth, START))
    assert about(without, "scale and unit in the channel")
    assert not about(helped, "scale and unit in the channel")


def test_a_backlash_far_off_on_the_nameplate(sound: tuple[lm.Recording, Found]) -> None:
    """Ten times too large: the fit did not converge; now it finds the same."""
    recording, helped = sound
    far = find_parameters(material(recording, START | {"backlash": 10.0 * START["backlash"]}))
    for name in ("inertia_motor", "inertia_load", "stiffness", "backlash"):
        assert far.table[name]["value"] == pytest.approx(helped.table[name]["value"], rel=0.03), name
    assert coulomb_error(helped) < 0.02


def test_a_fit_that_does_not_converge_for_the_sign_of_the_torque(sound: tuple[lm.Recording, Found]) -> None:
    """``sign`` in the torque's channel."""
    without = find_parameters(material(recorded(1.0, sign=-1.0), START))
    assert "the sign of the torque (sign in its channel)" in told(without, "Check the values").remedy
    assert not about(sound[1], "sign")


def test_a_nameplate_with_which_nothing_is_identified(sound: tuple[lm.Recording, Found]) -> None:
    """The values under [nameplate], before a finer encoder is bought."""
    recording, helped = sound
    without = find_parameters(material(recording, START | {"stiffness": 300.0 * START["stiffness"]}))
    assert told(without, "Check the values under [nameplate]").got
    assert without.table["backlash"]["value"] is None
    assert helped.table["backlash"]["source"] == "identified" and not about(helped, "Nothing is identified")


#: Nameplates with which a recording of little torque at one speed has two minima: seconds, size of the torque, values.
#: Of the last digits hangs whether the fit finds both, so there are several.
LITTLE = [
    (1.2, 0.3, {"stiffness": 8_000.0, "backlash": 0.03}),
    (1.2, 0.3, {"stiffness": 10_000.0, "backlash": 0.03}),
    (2.0, 0.3, {"stiffness": 10_000.0, "backlash": 0.03}),
]


def second_minima(found: Found) -> list[Problem]:
    return about(found, "fixed = [...] under [identify], or record more reversals")


def test_a_second_minimum_and_a_value_that_the_nameplate_knows(monkeypatch: pytest.MonkeyPatch) -> None:
    """``fixed = [...]`` under [identify], for the fit; the second estimator compares all minima."""
    recordings = [recorded(seconds, levels=(20.0,), size=size) for seconds, size, _ in LITTLE]
    wrong = [START | values for _, _, values in LITTLE]
    with monkeypatch.context() as patched:
        without_second_estimator(patched)
        without = [find_parameters(material(*each)) for each in zip(recordings, wrong, strict=True)]
    assert any(map(second_minima, without))
    knows = wrong[1] | {"backlash": KNOWN["backlash"]}
    helped = find_parameters(material(recordings[1], knows, fixed=("backlash",)))
    assert not second_minima(helped)
    for name in ("inertia_motor", "inertia_load", "stiffness"):
        assert helped.table[name]["value"] == pytest.approx(KNOWN[name], rel=0.02)


def test_the_second_estimator_leaves_no_second_minimum() -> None:
    seconds, size, values = LITTLE[1]
    found = find_parameters(material(recorded(seconds, levels=(20.0,), size=size), START | values))
    assert not second_minima(found)
    for name in ("inertia_motor", "inertia_load", "stiffness", "backlash"):
        assert found.table[name]["value"] == pytest.approx(KNOWN[name], rel=0.02)


def test_a_second_minimum_and_more_reversals(monkeypatch: pytest.MonkeyPatch) -> None:
    without_second_estimator(monkeypatch)
    helped = find_parameters(material(recorded(1.2), START | LITTLE[1][2]))
    assert not second_minima(helped)
    assert helped.table["backlash"]["value"] == pytest.approx(KNOWN["backlash"], rel=0.02)


def test_too_few_samples_in_a_period() -> None:
    """A higher rate: the mode of 99 Hz has ten samples at 1 ms."""
    fast = recorded(1.5)
    slow = lm.Recording(fast.time[::5], {name: values[::5] for name, values in fast.signals.items()})
    assert about(find_parameters(material(slow, START)), "Record at a higher rate")
    assert not about(find_parameters(material(fast, START)), "Record at a higher rate")


def test_too_short_a_recording(sound: tuple[lm.Recording, Found]) -> None:
    assert "Record longer" in find_parameters(material(recorded(0.3), START)).skipped
    assert not sound[1].skipped


def width(found: Found, name: str) -> float:
    """Of the 95 % interval over the value."""
    entry = found.table[name]
    return float((entry["high"] - entry["low"]) / entry["value"])


def test_gaps_in_the_recording(monkeypatch: pytest.MonkeyPatch) -> None:
    """One long segment. Widths are those of one estimator: the second may replace the fit with the gaps alone."""
    monkeypatch.setattr("lostmotion.stages.parameters.identify", partial(lm.identify, second_estimator=False))
    whole = recorded(3.4)
    speed = whole["speed_motor"].copy()
    speed[4250::4250] = np.nan
    pieces = find_parameters(material(whole.with_signals("measured", speed_motor=speed), START))
    assert "one long segment tells more" in told(pieces, "starts anew after each gap").remedy
    helped = find_parameters(material(whole, START))
    assert not about(helped, "gap")
    assert width(helped, "damping") < 0.5 * width(pieces, "damping")


def test_rows_that_are_taken_as_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """A finer encoder, for the fit."""
    without_second_estimator(monkeypatch)
    coarse = find_parameters(material(recorded(1.5, step=100.0), START))
    assert told(coarse, "A finer encoder tells more").where == "speed_motor"
    helped = find_parameters(material(recorded(1.5, step=0.15), START))
    assert not about(helped, "encoder")
    for name in ("stiffness", "damping", "backlash"):
        assert helped.table[name]["source"] == "identified"
        known = coarse.table[name]["source"] == "identified"
        assert not known or width(helped, name) < 0.5 * width(coarse, name), name
    assert width(helped, "inertia_total") < 0.5 * width(coarse, "inertia_total")


def pushed_one_way() -> lm.Recording:
    """The motor drives in one direction with more torque than its noise takes off: the gap stays closed."""
    torque = 4.0 + lm.signals.noise(2.0, 200.0, 0.5, 2.0, DT, seed=2)
    run = lm.simulate(lm.Drivetrain.two_mass(**KNOWN), torque_motor=torque, dt=DT)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(len(run))
    return lm.Recording(run.time, {"torque_motor": run["torque_motor"], "speed_motor": speed})


def test_a_backlash_that_is_not_excited() -> None:
    """Reversals of the shaft torque."""
    without = find_parameters(material(pushed_one_way(), START))
    assert told(without, "Record reversals of the shaft torque").where == "backlash"
    assert without.table["backlash"]["value"] is None
    helped = find_parameters(material(recorded(1.5), START))
    assert not about(helped, "Record reversals of the shaft torque")
    assert helped.table["backlash"]["value"] == pytest.approx(KNOWN["backlash"], rel=0.02)


def test_a_mode_beyond_the_model() -> None:
    """Smaller ``kp`` and ``ki`` under [law], where the mode of a third inertia (640 Hz, hardly damped) rings."""
    plant = lm.Drivetrain(
        (0.012, 0.006, 0.11),
        (lm.Shaft(60_000.0, damping=0.02), lm.Shaft(9_000.0, damping=0.4, backlash=0.012)),
        (lm.Friction(), lm.Friction(), lm.Friction(coulomb=2.0, viscous=0.0175)),
        Actuator(3e-4, 40.0),
    )
    torque = lm.signals.excitation(2.0, DT, seed=3, inertia=0.128, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(plant, torque_motor=torque, dt=DT)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(len(run))
    recording = lm.Recording(run.time, {"torque_motor": run["torque_motor"], "speed_motor": speed})
    asked = material(recording, START, torque_limit=40.0)
    found = find_parameters(asked)
    # Its shaft hardly damps: a loss factor of its own.
    for name in ("inertia_motor", "inertia_load", "backlash"):
        true = plant.inertias[0] + plant.inertias[1] if name == "inertia_motor" else KNOWN[name]
        assert found.table[name]["value"] == pytest.approx(true, rel=0.005), name
    assert (
        "smaller kp and ki, or slower poles, under [law]" in told(found, "A further inertia or shaft").remedy
    )
    rig = Rig(plant, {name: lm.Sensor(name) for name in ("speed_motor", "speed_load")}, 1)
    default = design(asked, found)
    gains = {name: default.taken[f"pi_{name}"]["value"] for name in ("kp", "ki")}
    smaller = {"kp": gains["kp"] / 3.0, "ki": gains["ki"] / 9.0}
    helped = design(material(recording, START, torque_limit=40.0, **smaller), found)
    steady = []
    for laws in (default, helped):
        assert laws.pi is not None
        response = control_step(rig, laws.pi, DT, default.step)
        steady.append(judged_step(response, default.step)["steady_error"])
    assert steady[0] > 0.05 and steady[1] < 0.005, steady


def test_no_sample_time() -> None:
    """``sample_time`` under [law]."""
    found = find_parameters(material())
    assert "sample_time in [law]" in design(material(), found).skipped
    assert design(material(sample_time=1e-4), found).law is not None


def loop_problems(**settings: Any) -> tuple[dict[str, Any], list[Problem]]:
    """Controllers and problems of the validation, and those of the design."""
    asked = material(sample_time=1e-4, **settings)
    found = find_parameters(asked)
    laws = design(asked, found)
    table, _, _, problems = validate_controllers(asked, found, laws)
    return table, [*laws.problems, *problems]


@pytest.mark.parametrize(
    ("settings", "law", "remedy"),
    [
        ({"kp": 400.0, "ki": 200.0}, "pi", "Leave kp and ki out of [law]"),
        ({"kp": 1.0, "ki": 20_000.0}, "pi", "Leave kp and ki out of [law]"),
        ({"poles": (-4000.0, -4000.0, -4000.0)}, "pole_placement", "Leave poles out of [law]"),
    ],
)
def test_a_setting_that_does_not_suit_the_drive(settings: dict[str, Any], law: str, remedy: str) -> None:
    table, problems = loop_problems(torque_limit=70.0, **settings)
    assert "skipped" in table[law] or not table[law]["steady_error"] < 0.01
    assert [p for p in problems if remedy in p.remedy]
    helped, left = loop_problems(torque_limit=70.0)
    assert helped[law]["steady_error"] < 0.005 and helped[law]["overshoot"] < 10.0
    assert left == []


def test_a_torque_limit_below_friction() -> None:
    """``torque_limit`` under [law]."""
    table, problems = loop_problems(torque_limit=1.0)
    assert all("skipped" in table[law] for law in ("pi", "pole_placement", "soft_landing"))
    assert all("Raise torque_limit under [law]" in p.remedy for p in problems) and len(problems) == 2
    needed = float(re.search(r"holds ([\d.]+) Nm", problems[0].remedy)[1])  # type: ignore[index]
    helped, left = loop_problems(torque_limit=5.0 * needed)
    assert left == [] and helped["pole_placement"]["steady_error"] < 0.005


def test_a_sample_time_that_is_too_long() -> None:
    """``sample_time`` under [law]."""
    slow = replace(material(sample_time=1e-2), identify=None)
    laws = design(slow, find_parameters(slow))
    assert laws.law is None
    assert [p for p in laws.problems if "shorter sample_time under [law]" in p.remedy]
    assert loop_problems()[1] == []
