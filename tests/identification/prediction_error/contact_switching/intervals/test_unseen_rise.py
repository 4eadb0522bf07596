"""Room for a friction that rises towards rest where none was found."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import TOLD
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.intervals.unseen_rise import (
    room_for_unseen_rise,
)
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate, polish
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.told import told_vector
from lostmotion.rig.equivalent import friction_line

DT = 2e-4
FRICTION = [TOLD.index("coulomb"), TOLD.index("viscous")]
Seen = Callable[[lm.Drivetrain, np.ndarray, int | None, float], ContactFilter]


def rubbing(plant: lm.Drivetrain, rise: float) -> lm.Drivetrain:
    """With a friction at the load that rises by this part of its Coulomb level below 15 rad/s."""
    load = plant.frictions[1]
    most = rise * load.coulomb
    points = ((0.0, most), (5.0, 0.5 * most), (15.0, 0.0))
    return replace(
        plant, frictions=(plant.frictions[0], lm.Friction(load.coulomb, load.viscous, stribeck=points))
    )


def reversals() -> np.ndarray:
    return lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)


def fitted(seen: Seen, plant: lm.Drivetrain, values: dict[str, float]) -> Candidate:
    """Without a rise."""
    flt = seen(plant, reversals(), 14, 300.0)
    theta = flt.theta(values)
    free = sorted(INDEX[name] for name in TOLD)
    return polish(Candidate("fitted", theta, 0.0, flt, free), flt, Box.around(flt, theta, 10.0))


@pytest.mark.parametrize("rise", [0.02, 0.05])
def test_it_has_the_rise_that_the_fit_lacks(
    plant: lm.Drivetrain, values: dict[str, float], seen: Seen, rise: float
):
    drive = rubbing(plant, rise)
    best = fitted(seen, drive, values)
    speed = lm.simulate(drive, torque_motor=reversals(), dt=DT)["speed_load"]
    line = np.array(friction_line(drive.frictions[1], speed), dtype=float)
    error = np.abs(told_vector(best)[FRICTION] - np.log(line))
    room = room_for_unseen_rise(best)[FRICTION]
    assert np.all(error < 2.0 * room)


def test_where_reversals_show_that_there_is_none_it_is_small(
    plant: lm.Drivetrain, values: dict[str, float], seen: Seen
):
    best = fitted(seen, plant, values)
    room = room_for_unseen_rise(best)
    assert np.all(room[FRICTION] < 0.05) and np.any(room[FRICTION] > 0.0)


def test_a_fitted_rise_and_a_drive_without_friction_need_none(flt: ContactFilter, values: dict[str, float]):
    free = sorted(INDEX[name] for name in (*TOLD, "rise", "fade"))
    rising = Candidate("truth", flt.theta(values | {"rise": 0.2, "fade": 3.0}), 0.0, flt, free)
    smooth = replace(rising, theta=flt.theta(values | {"coulomb": 0.0}))
    for one in (rising, smooth):
        assert not np.any(room_for_unseen_rise(one))
