"""Friction that rises towards rest: the filter follows it, a descent finds it, and it is told as a line."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.moves.choices import other_choices
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.structures.rising_friction import (
    friction_lines,
    with_rising_friction,
)
from lostmotion.identification.prediction_error.contact_switching.told import (
    room_for_rest,
    told_slopes,
    told_vector,
)
from lostmotion.rig.equivalent import friction_line

DT, RISE, FADE = 2e-4, 0.4, 2.0
FREE = ("inertia_motor", "inertia_load", "stiffness", "damping", "backlash", "coulomb", "viscous")


@pytest.fixture(scope="module")
def rubbing(plant: lm.Drivetrain) -> ContactFilter:
    return recorded(plant)[0]


def recorded(plant: lm.Drivetrain) -> tuple[ContactFilter, lm.Recording, lm.Friction]:
    """20 bits of the exact drive whose friction rises by 40 % towards rest, in a random motion through rest; the motion
    and the friction."""
    speeds = FADE * np.concatenate([np.linspace(0.0, 6.0, 200), [20.0]])
    curve = tuple((float(w), float(plant.coulomb * RISE * np.exp(-w / FADE))) for w in speeds[:-1])
    friction = lm.Friction(plant.coulomb, plant.viscous, stribeck=(*curve, (float(speeds[-1]), 0.0)))
    chain = replace(plant, frictions=(lm.Friction(), friction))
    torque = lm.signals.excitation(1.5, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    count = 2.0 * np.pi / 2**20
    motion = lm.simulate(chain, torque_motor=torque, dt=DT)
    angle = np.floor(motion["angle_motor"] / count) * count
    floor = count / np.sqrt(12.0)
    return ContactFilter(torque, angle, DT, True, floor, floor, 7, (0, torque.size)), motion, friction


@pytest.fixture(scope="module")
def constant(rubbing: ContactFilter, values: dict[str, float]) -> Candidate:
    """The true values but for the rise."""
    theta, free = rubbing.theta(values), sorted(INDEX[name] for name in FREE)
    return Candidate("truth", theta, rubbing.run(theta).cost, rubbing, free)


def test_the_filter_follows_it(rubbing: ContactFilter, values: dict[str, float], constant: Candidate):
    theta = rubbing.theta(values | {"rise": RISE, "fade": FADE, "motor_rate": 100.0, "load_rate": 30.0})
    assert rubbing.run(theta).cost == pytest.approx(0.0, abs=0.1)
    assert constant.cost > 0.5


def test_a_descent_finds_it(constant: Candidate, values: dict[str, float]):
    box = Box.around(constant.flt, constant.theta, 30.0)
    without = polish(constant, constant.flt, box)
    found = polish(with_rising_friction(without, 0.3, box), constant.flt, box)
    assert found.cost < 0.1 < without.cost - 0.1
    assert found.rises and not without.rises and found.structure != without.structure
    told = dict(zip(INDEX, found.flt.values(found.theta), strict=True))
    assert told["rise"] == pytest.approx(RISE, rel=0.05) and told["fade"] == pytest.approx(FADE, rel=0.05)
    for name in ("inertia_motor", "inertia_load", "stiffness", "backlash"):
        assert told[name] == pytest.approx(values[name], rel=0.005)
    # Once it rises there is nothing to choose.
    assert len(other_choices(without, box)) == len(other_choices(found, box)) + 2


def test_it_is_told_as_the_line_closest_to_it_at_the_speeds_of_its_end(constant: Candidate):
    theta, flt = constant.theta.copy(), constant.flt
    theta[[INDEX["rise"], INDEX["fade"]]] = RISE, np.log(FADE)
    rising = replace(constant, theta=theta, free=sorted({*constant.free, INDEX["rise"], INDEX["fade"]}))
    coulomb, viscous = flt.values(theta)[[INDEX["coulomb"], INDEX["viscous"]]]
    load, _ = rising.speeds
    torque = coulomb * (1.0 + RISE * np.exp(-load / FADE)) + viscous * load
    line = np.linalg.lstsq(np.column_stack([np.ones(torque.size), load]), torque, rcond=None)[0]
    lines = friction_lines(rising)
    assert [lines["coulomb"], lines["viscous"]] == pytest.approx([line[0], max(line[1], 0.0)])
    assert coulomb < lines["coulomb"] < (1.0 + RISE) * coulomb and lines["viscous"] < viscous
    assert np.exp(told_vector(rising)[5]) == pytest.approx(lines["coulomb"])
    # What the rise is known to belongs to the interval of the line.
    slopes = told_slopes(rising)
    assert slopes[5, rising.free.index(INDEX["rise"])] > 0.0
    assert slopes[0] == pytest.approx([1.0 if place == 0 else 0.0 for place in rising.free], abs=1e-6)


def test_the_line_is_over_the_speeds_of_the_load_not_of_the_motor(
    plant: lm.Drivetrain, values: dict[str, float]
):
    """A load behind a large gap rests and coasts while the motor moves."""
    flt, motion, friction = recorded(plant.with_parameters(backlash=0.3))
    theta = flt.theta(
        values | {"backlash": 0.3, "rise": RISE, "fade": FADE, "motor_rate": 100.0, "impact": 1e-3}
    )
    true = Candidate("truth", theta, flt.run(theta).cost, flt, [INDEX["coulomb"], INDEX["rise"]])
    load, motor = (friction_line(friction, motion[name])[0] for name in ("speed_load", "speed_motor"))
    assert load is not None and motor is not None and motor < 0.98 * load
    assert friction_lines(true)["coulomb"] == pytest.approx(load, rel=0.002)
    # A part of the recording has other speeds; the line stays that of all.
    part = replace(true, flt=flt.part(slice(0, flt.rows // 4)))
    alone = replace(part, flt=replace(part.flt, whole=None))
    assert friction_lines(part) == pytest.approx(friction_lines(true))
    assert friction_lines(alone)["coulomb"] != pytest.approx(load, rel=0.01)
    # Which of the slowest rows are no rest belongs to the interval.
    assert 0.0 < room_for_rest(true)[5] < 0.02
    assert not np.any(room_for_rest(replace(true, free=[INDEX["coulomb"]])))


def test_where_the_filter_loses_the_motion_the_motors_speeds_stand_for_the_loads(constant: Candidate):
    """A descent may end far off any drive: its line is as good as any, but there is one."""
    flt = constant.flt
    theta = flt.changed(constant.theta, rise=RISE, fade=FADE, stiffness=1e300)
    lost = replace(constant, theta=theta, cost=np.inf)
    assert not np.all(np.isfinite(flt.load_speed(theta)))
    assert np.all(np.isfinite(lost.speeds[0]))
    assert np.max(lost.speeds[0]) == pytest.approx(np.max(np.abs(flt.motor_speed)), rel=0.1)
    assert np.all(np.isfinite(list(friction_lines(lost).values())))
