"""Variants: each number within its spread, a friction that stays one, the same for any count."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import Actuator, Drivetrain, Friction, Shaft
from lostmotion.simulation import variants


def test_every_number_is_within_the_spread_and_its_own():
    middle = Drivetrain.two_mass(**TABLE_I, lag=1e-3)
    made = variants(middle, 400, spread=0.2, seed=3)
    ratios = np.array(
        [[plant.parameters()[name] / value for name, value in TABLE_I.items()] for plant in made]
    )
    assert ratios.min() >= 0.8 and ratios.max() <= 1.2
    assert np.all(ratios.min(axis=0) < 0.82) and np.all(ratios.max(axis=0) > 1.18)
    correlation = np.corrcoef(ratios.T) - np.eye(len(TABLE_I))
    assert np.abs(correlation).max() < 0.2  # 4 standard deviations
    assert len({plant.lag for plant in made}) == 400


def test_a_friction_stays_one():
    friction = Friction((1.0, 2.0), 0.1, 2.5, ((0.0, 0.3), (1.0, 0.0)))
    middle = Drivetrain((0.1, 0.1), (Shaft(1e3),), (Friction(), friction), Actuator(0.0, 9.0, 8.0), "motor")
    for plant in variants(middle, 20, spread=0.3):
        one = plant.frictions[1]
        factor = one.coulomb_plus
        assert (one.coulomb_minus, one.breakaway) == pytest.approx((2.0 * factor, 2.5 * factor))
        assert one.stribeck == ((0.0, pytest.approx(0.3 * factor)), (1.0, 0.0))
        assert plant.actuator == middle.actuator and plant.locked == "motor"


def test_seed_and_count():
    middle = Drivetrain.two_mass(**TABLE_I)
    assert variants(middle, 5, seed=7) == variants(middle, 9, seed=7)[:5]
    assert variants(middle, 5, seed=7) != variants(middle, 5, seed=8)
    assert variants(middle, 1, spread=0.0)[0].parameters() == middle.parameters()
    for arguments in (dict(count=0), dict(count=1, spread=1.0), dict(count=1, spread=float("nan"))):
        with pytest.raises(lm.InvalidInput, match="variants"):
            variants(middle, **arguments)
