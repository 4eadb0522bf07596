"""What inertias that the model does not have may change: the recording says how much there can be of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import CORE, TOLD, distance
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.intervals import further_inertias
from lostmotion.identification.prediction_error.contact_switching.intervals.further_inertias import (
    HIDDEN_MODES,
    OTHER_SIDE,
    SEVERAL,
    SHARES,
    room_for_further_inertias,
    stiff_place,
)
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.structures.shaft_inertias import (
    Place,
    has_fourth,
    placed,
    without_last_inertia,
)
from lostmotion.identification.prediction_error.innovations import Predictor
from lostmotion.kernels.innovations.intermediate_inertia import two_springs

THIRD = {"share": 0.3, "compliance": 0.1, "loss": 1.0}


def fitted(flt: ContactFilter, values: dict[str, float], *more: str) -> tuple[Candidate, Box]:
    theta = flt.theta(values)
    box = Box.around(flt, theta, 10.0)
    free = sorted(INDEX[name] for name in (*TOLD, *more))
    return polish(Candidate("fitted", theta, 0.0, flt, free), flt, box), box


def of_a_chain(plant: lm.Drivetrain, mode: float) -> tuple[ContactFilter, lm.Drivetrain]:
    """A recording of three inertias, the highest mode at this multiple of the torsional frequency."""
    motor, share = plant.inertias[0], 0.4
    shaft = plant.shafts[0]
    near = (2.0 * np.pi * mode * plant.pole_frequency) ** 2 * share * (1.0 - share) * motor
    stiff = lm.Shaft(stiffness=near, damping=2e-5 * near)
    chain = lm.Drivetrain(
        inertias=((1.0 - share) * motor, share * motor, plant.inertias[1]),
        shafts=(stiff, shaft),
        frictions=(plant.frictions[0], lm.Friction(), plant.frictions[1]),
        actuator=plant.actuator,
    )
    dt = 2e-4
    torque = lm.signals.excitation(2.0, dt, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    speed = lm.simulate(chain, torque_motor=torque, dt=dt)["speed_motor"]
    noisy = speed + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
    return ContactFilter.of(Predictor(torque, noisy, dt, False, plant, skip=0), 300.0), chain


@pytest.mark.parametrize("third", [False, True])
def test_a_model_that_lacks_nothing_needs_hardly_any(
    flt: ContactFilter, values: dict[str, float], third: bool
):
    given = values | (THIRD if third else {})
    best, box = fitted(flt.liveliest(2000), given, *(THIRD if third else ()))
    assert np.max(room_for_further_inertias(best, [], box)[CORE]) < 0.01


def test_an_inertia_that_the_model_lacks_is_seen(plant: lm.Drivetrain, values: dict[str, float]):
    exact, lacking = (fitted(of_a_chain(plant, mode)[0].liveliest(2000), values) for mode in (200.0, 9.0))
    wide = room_for_further_inertias(lacking[0], [], lacking[1])[CORE]
    assert np.all(wide > 3.0 * room_for_further_inertias(exact[0], [], exact[1])[CORE])
    motor = INDEX["inertia_motor"]
    error = abs(lacking[0].theta[motor] - lacking[0].flt.theta(values)[motor])
    assert 0.7 * error < wide[0] < 5.0 * error


def test_what_shows_nothing_changes_nothing(flt: ContactFilter, values: dict[str, float]):
    best, box = fitted(flt.liveliest(3000), values)
    still = replace(best.flt, torque=np.zeros(best.flt.rows), measured=np.zeros(best.flt.rows))
    assert not np.any(room_for_further_inertias(replace(best, flt=still), [], box))


@pytest.mark.parametrize("behind", [False, True])
@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("mode", HIDDEN_MODES[1:])
def test_the_mode_is_where_it_should_be(
    flt: ContactFilter, values: dict[str, float], mode: float, share: float, behind: bool
):
    best = Candidate("truth", flt.theta(values), 0.0, flt, [])
    other, theta = placed(best, stiff_place(best, mode, share, behind), best.flt)
    assert other.behind is behind
    value = dict(zip(INDEX, other.values(theta), strict=True))
    near, far = value["inertia_motor"], value["inertia_load"]
    near, far = (far, near) if behind else (near, far)
    first, last = two_springs(near, far, value["stiffness"], share, value["compliance"])
    chain = lm.Drivetrain(
        inertias=((1.0 - share) * near, share * near, far),
        shafts=(lm.Shaft(stiffness=first), lm.Shaft(stiffness=last)),
    )
    modes = lm.rig.eigenfrequencies(chain)
    assert modes[2] / modes[1] == pytest.approx(mode, rel=0.1)


def test_effects_are_those_of_the_lowest_hidden_mode(flt: ContactFilter, values: dict[str, float]):
    best, _ = fitted(flt.liveliest(3000), values)
    run, effects = best.run, further_inertias.effects(best)
    assert len(effects) == 2 * len(SHARES) * len(HIDDEN_MODES)
    assert all(effect.shape == run.weighted.shape for effect in effects)
    mode = HIDDEN_MODES[-1]
    flt, theta = placed(best, stiff_place(best, mode, SHARES[-1], True), best.flt)
    other = flt.run(theta)
    moved = other.weighted * other.deviations / run.deviations - run.weighted
    assert effects[-1] == pytest.approx(moved * (mode / HIDDEN_MODES[0]) ** 2)


def test_a_fourth_inertia_that_explains_much_leaves_little(
    four_inertias: Callable[[bool, bool], tuple[ContactFilter, dict[str, float]]],
):
    flt, values = four_inertias(False, True)
    further = [name for name in values if name.startswith(("share", "compliance", "loss"))]
    best, box = fitted(flt, values | {"motor_rate": 3.0, "load_rate": 1.0}, *further)
    without = without_last_inertia(best, box)
    assert without.cost > best.cost + 0.2 and not has_fourth(without) and Place.of(without) is not None
    # A friction at its bound is at it with either, or with one of them.
    away = distance(without, best)
    differs = np.isfinite(away) & (away > 0.0)
    assert np.all(differs[CORE])
    assert np.all(room_for_further_inertias(best, [], box)[differs] < 0.5 * away[differs])
    unexplained = replace(best, cost=without.cost)
    whole = SEVERAL * distance(without, best)
    assert room_for_further_inertias(unexplained, [], box) == pytest.approx(whole, rel=1e-3)


def test_a_third_inertia_on_the_other_side_that_does_about_as_well_says_what_there_may_be(
    flt: ContactFilter, values: dict[str, float]
):
    """With inertias on both sides of the gap, either side's third one is wrong."""
    best, box = fitted(flt.liveliest(3000), values | THIRD, *THIRD)
    best = replace(best, cost=0.1)
    alone, away = room_for_further_inertias(best, [], box), best.theta.copy()
    away[INDEX["inertia_load"]] += 0.2
    opposite = replace(best, theta=away, flt=replace(best.flt, behind=True))
    load = TOLD.index("inertia_load")
    wide = room_for_further_inertias(best, [best, opposite], box)
    expected = np.zeros(len(TOLD))
    expected[load] = SEVERAL * OTHER_SIDE * 0.2
    assert wide == pytest.approx(np.hypot(alone, expected))
    # It predicts worse: e^(2·cost) by more than what is left, e^0.2 − 1.
    worse = room_for_further_inertias(best, [replace(opposite, cost=0.4)], box)
    part = np.sqrt(np.expm1(0.2) / (np.exp(0.8) - np.exp(0.2)))
    assert worse[load] == pytest.approx(np.hypot(alone[load], SEVERAL * part * OTHER_SIDE * 0.2))
    same = replace(opposite, flt=best.flt)
    gapless = replace(
        opposite, theta=np.where(np.arange(away.size) == INDEX["backlash"], -np.inf, best.theta)
    )
    elsewhere = replace(opposite, theta=away + 0.2 * (np.arange(away.size) == INDEX["inertia_load"]))
    for other in (same, gapless, elsewhere, replace(opposite, theta=flt.changed(away, share=0.0))):
        assert room_for_further_inertias(best, [other], box) == pytest.approx(alone)
