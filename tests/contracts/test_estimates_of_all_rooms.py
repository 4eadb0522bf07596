"""Every result of an identification has the same form, whether it found something or nothing."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import identification as i
from lostmotion.identification import Estimates
from lostmotion.identification.statistics.estimates import UNITS

DT = 1e-3
PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.9, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175, coulomb_motor=0.3,
)  # fmt: skip
T = np.arange(12_000) * DT


@cache
def still() -> lm.Recording:
    """A drive that nothing moves: all signals that any of them reads, each with a little noise."""
    noise = 1e-9 * np.random.default_rng(1).standard_normal((7, T.size))
    names = (
        "torque_motor",
        "angle_motor",
        "angle_load",
        "speed_motor",
        "speed_load",
        "torque_shaft",
        "twist",
    )
    reference = {"speed_reference": np.where(T < 6.0, 1.0, 2.0)}
    return lm.Recording(T, dict(zip(names, noise, strict=True)) | reference)


@cache
def driven() -> lm.Recording:
    torque = 12.0 * np.sin(4.4 * T) + lm.signals.noise(2.0, 100.0, 4.0, 12.0, DT, seed=1)
    return lm.simulate(PLANT, dt=DT, torque_motor=torque)


@cache
def excited() -> lm.Recording:
    """What the fit alone makes of it stands: what is looked at here is the form."""
    dt = 2e-4
    torque = lm.signals.excitation(1.0, dt, seed=3, inertia=0.13, coulomb=2.3, viscous=0.0175)
    run = lm.simulate(PLANT, dt=dt, torque_motor=torque)
    noise = 1e-3 * np.random.default_rng(1).standard_normal(len(run))
    return run.with_signals("measured", speed_motor=run["speed_motor"] + noise)


def locked() -> lm.Recording:
    torque = 15.0 * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * T / 4.0))
    held = lm.Drivetrain(PLANT.inertias, PLANT.shafts, PLANT.frictions, locked="load")
    return lm.simulate(held, dt=DT, torque_motor=torque)


def stepped() -> lm.Recording:
    return lm.simulate(PLANT, dt=DT, torque_motor=np.where(T < 6.0, 12.0, 0.0))


def ramped() -> lm.Recording:
    ramp = np.concatenate([np.linspace(0.0, 4.0, 4000), np.zeros(3000)])
    return lm.simulate(PLANT, dt=DT, torque_motor=np.concatenate([ramp, -ramp]))


def rungs() -> lm.Recording:
    reference = np.repeat([0.5, 1.0, 2.0, 5.0, 10.0, 20.0], 2000)
    return lm.simulate(PLANT, dt=DT, law=lm.controllers.pi(dt=DT, kp=1.0, ki=5.0), speed_reference=reference)


def shaken() -> lm.Recording:
    torque = lm.signals.noise(2.0, 200.0, 5.0, 12.0, DT, seed=1)
    return lm.simulate(PLANT.with_parameters(backlash=0.0, coulomb=0.0), dt=DT, torque_motor=torque)


def ringing() -> lm.Recording:
    freely = PLANT.with_parameters(backlash=0.0, coulomb=0.0, coulomb_motor=0.0)
    return lm.simulate(freely, dt=DT, torque_motor=np.where(T < 6.0, 1.0, 9.0))


def two_mass(recording: lm.Recording) -> Estimates:
    return i.two_mass_fit(i.frequency_response(recording, segment=1.0))


#: How each is read from a recording that tells something.
CASES: dict[str, tuple[Callable[[], lm.Recording], Callable[[lm.Recording], Estimates]]] = {
    "torque_step": (stepped, i.torque_step),
    "torque_step, inertia given": (stepped, lambda r: i.torque_step(r, inertia=0.13)),
    "rigid_drive": (driven, i.rigid_drive),
    "friction_ladder": (rungs, i.friction_ladder),
    "breakaway": (ramped, i.breakaway),
    "locked_backlash": (locked, i.locked_backlash),
    "lost_motion": (driven, i.lost_motion),
    "ring_down": (ringing, i.ring_down),
    "shaft_stiffness": (shaken, i.shaft_stiffness),
    "shaft_stiffness, delay given": (shaken, lambda r: i.shaft_stiffness(r, torque_delay=0.0)),
    "two_mass_fit": (shaken, two_mass),
    "identify": (excited, lambda r: i.identify(r, start=PLANT)),
}
#: This one refuses a drive at rest: its response has no coherence.
REFUSED = ("two_mass_fit",)
#: These are linear in all they look for: a drive at rest gives values whose intervals hold zero.
LINEAR = ("rigid_drive", "lost_motion")


@cache
def told(case: str) -> Estimates:
    recording, estimate = CASES[case]
    return estimate(recording())


@cache
def untold(case: str) -> Estimates:
    return CASES[case][1](still())


def check_form(found: Estimates) -> None:
    assert isinstance(found, Estimates)
    assert list(found.values) == list(found.sources) == list(found.units) == list(found.table())
    assert set(found.intervals) <= set(found.values) <= set(UNITS)
    for name, value in found.values.items():
        assert (value is None) == (found.sources[name] == "not excited"), name
        if found.sources[name] == "nameplate":
            assert name not in found.intervals
        if found.sources[name] == "identified":
            low, high = found.intervals[name]
            assert np.isfinite([low, high]).all() and low <= value <= high, name


def check_short(found: Estimates) -> None:
    lines = repr(found).splitlines()
    assert len(lines) <= 6 and max(map(len, lines)) <= 100 and "array" not in repr(found)
    assert all(name in repr(found) for name in found.values)
    beside = len(found.problems) + len(found.remarks())
    assert len(found.summary().splitlines()) == 1 + len(found.values) + beside


@pytest.mark.parametrize("case", CASES)
def test_what_is_told_has_the_common_form(case: str) -> None:
    found = told(case)
    check_form(found)
    check_short(found)
    assert "identified" in found.sources.values()


@pytest.mark.usefixtures("short_search")
@pytest.mark.parametrize("case", [case for case in CASES if case not in REFUSED])
def test_what_is_not_told_has_the_same_names_and_a_problem(case: str) -> None:
    found = untold(case)
    check_form(found)
    check_short(found)
    assert found.problems
    given = [{n for n, s in f.sources.items() if s == "nameplate"} for f in (found, told(case))]
    assert given[0] == given[1]
    if case not in LINEAR:
        assert "identified" not in found.sources.values() and found.intervals == {}


def test_what_holds_arrays_does_not_print_them() -> None:
    for shown in (
        i.frequency_response(shaken(), segment=1.0),
        told("identify").prediction,
        i.frequency_analysis(shaken()),
    ):
        assert "array" not in repr(shown) and "..." not in repr(shown)


def test_a_comparison_of_contact_laws_is_a_line_and_its_summary_both_identifications() -> None:
    found = i.compare_contacts(excited(), start=PLANT)
    assert len(repr(found).splitlines()) == 1
    assert ("cannot be distinguished" in repr(found)) == (found.better is None)
    assert found.summary().count("Identification: ") == 2
