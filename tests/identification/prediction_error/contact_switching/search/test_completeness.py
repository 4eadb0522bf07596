"""Whether a candidate lacks a part that its recording shows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import (
    Box,
    Candidate,
    cost_of,
    polish,
)
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX, NAMES
from lostmotion.identification.prediction_error.contact_switching.search.completeness import lacks_nothing
from lostmotion.rig.equivalent import two_mass_equivalent

DT = 2e-4
FRICTIONS = ("coulomb", "viscous", "coulomb_motor", "viscous_motor")
Seen = Callable[[lm.Drivetrain, np.ndarray, int | None, float], ContactFilter]


def excitation() -> np.ndarray:
    return lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)


def fitted(flt: ContactFilter, values: dict[str, float], **more: float) -> Candidate:
    theta = flt.theta(values | more)
    free = sorted({*(INDEX[name] for name in TOLD), *(INDEX[name] for name in FRICTIONS)})
    return polish(Candidate("fitted", theta, np.inf, flt, free), flt, Box.around(flt, theta, 10.0))


def test_the_drive_itself_lacks_nothing(flt: ContactFilter, values: dict[str, float]):
    assert lacks_nothing(fitted(flt, values))


def with_a_third_inertia(plant: lm.Drivetrain) -> lm.Drivetrain:
    """Its mode is at twelve times the torsional frequency."""
    return lm.Drivetrain(
        inertias=(0.0182, 0.011, 0.1),
        shafts=(lm.Shaft(6285.896, 0.397, 0.012), lm.Shaft(3e5, 3.0)),
        frictions=(lm.Friction(), lm.Friction(), plant.frictions[1]),
        actuator=plant.actuator,
    )


def with_a_rising_friction(plant: lm.Drivetrain) -> lm.Drivetrain:
    load = plant.frictions[1]
    rising = lm.Friction(load.coulomb, load.viscous, stribeck=((0.0, 0.4), (5.0, 0.2), (15.0, 0.0)))
    return replace(plant, frictions=(plant.frictions[0], rising))


@pytest.mark.parametrize("bits", [None, 18], ids=["noise", "counts"])
@pytest.mark.parametrize("lacking", [with_a_third_inertia, with_a_rising_friction])
def test_a_part_that_the_model_lacks_shows(
    lacking: Callable[[lm.Drivetrain], lm.Drivetrain],
    bits: int | None,
    plant: lm.Drivetrain,
    values: dict[str, float],
    seen: Seen,
):
    drive = lacking(plant)
    known = {}
    if len(drive.inertias) > 2:
        equivalent = two_mass_equivalent(drive, np.empty(0))
        known = {name: value for name, value in equivalent.items() if name in NAMES and value is not None}
    best = fitted(seen(drive, excitation(), bits, 300.0), values, **known)
    assert best.cost < 0.25 and not lacks_nothing(best)


def test_another_law_of_the_contact_shows(flt: ContactFilter, values: dict[str, float]):
    best = fitted(flt, values)
    other = replace(best, flt=replace(best.flt, law="dead_zone"))
    other = min([other, polish(other, other.flt, Box.around(flt, other.theta, 10.0))], key=cost_of)
    assert not lacks_nothing(other)


def test_a_torque_that_does_not_go_straight_shows(flt: ContactFilter, values: dict[str, float]):
    best = fitted(flt, values)
    straight = replace(best, flt=replace(best.flt, ramp=True))
    assert not lacks_nothing(polish(straight, straight.flt, Box.around(flt, straight.theta, 10.0)))


def test_values_that_change_half_way_show(plant: lm.Drivetrain, values: dict[str, float]):
    """A load that is taken off while the drive runs: one tenth of its inertia."""
    torque = excitation()
    first = lm.simulate(plant, torque_motor=torque, dt=DT)["speed_motor"]
    other = plant.with_parameters(inertia_load=0.9 * plant.inertia_load)
    second = lm.simulate(other, torque_motor=torque, dt=DT)["speed_motor"]
    noise = 0.01 * np.random.default_rng(1).standard_normal(2 * torque.size)
    speed = np.concatenate([first, second - second[0] + first[-1]]) + noise
    floor = 0.01
    flt = ContactFilter(np.tile(torque, 2), speed, DT, False, floor, floor, 6, (0, speed.size))
    assert not lacks_nothing(fitted(flt, values, inertia_load=0.95 * plant.inertia_load))


def test_a_third_inertia_that_is_there_is_not_lacking(
    four_inertias: Callable[[bool, bool], tuple[ContactFilter, dict[str, float]]],
):
    """Nothing can be added to four inertias; without the fourth, that shows."""
    flt, values = four_inertias(True, False)
    names = [name for name in values if name in INDEX]
    free = sorted(INDEX[name] for name in names)
    theta = flt.theta(values)
    box = Box.around(flt, theta, 10.0)
    four = polish(Candidate("four", theta, np.inf, flt, free), flt, box)
    assert lacks_nothing(four)
    three_free = [place for place in free if not NAMES[place].endswith("_fourth")]
    theta = four.theta.copy()
    theta[[INDEX[f"{name}_fourth"] for name in ("share", "compliance", "loss")]] = -np.inf
    three = replace(four, theta=theta, free=three_free, flt=replace(four.flt, fourth_behind=False))
    assert not lacks_nothing(polish(three, three.flt, box))
