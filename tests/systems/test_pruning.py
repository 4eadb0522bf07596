"""A law without what its outputs do not read gives the same numbers."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.controllers import pole_placement
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.systems import DiscreteSystem, connect, pruned


def law(drivetrain: Drivetrain) -> DiscreteSystem:
    parts = [
        kalman(drivetrain, dt=1e-4),
        pole_placement(drivetrain, dt=1e-4, friction_compensation="none"),
    ]
    return connect(parts, ("speed_reference", "speed_motor"), ("torque_motor", "torque_shaft_estimated"))


@pytest.fixture
def drivetrain() -> Drivetrain:
    return PAPER


def test_the_torque_is_the_same_to_the_last_bit(drivetrain: Drivetrain) -> None:
    whole = law(drivetrain)
    small = pruned(whole, ("torque_motor",))
    # The shaft torque's own curve, and the friction that only an output shows, are read by nobody else.
    assert len(small.curves) == len(whole.curves) - 1
    assert "coulomb_load" in whole.states and "coulomb_load" not in small.states
    rng = np.random.default_rng(1)
    data = {"speed_reference": np.full(500, 2.0), "speed_motor": rng.normal(size=500)}
    expected = whole.without_checks().run(data)["torque_motor"]
    assert np.array_equal(small.run(data)["torque_motor"], expected)


def test_all_outputs_keep_all_that_they_read(drivetrain: Drivetrain) -> None:
    whole = law(drivetrain)
    assert pruned(whole).outputs == whole.outputs
    assert len(pruned(whole).curves) == len(whole.curves)


def test_an_unknown_output_is_an_error(drivetrain: Drivetrain) -> None:
    with pytest.raises(InvalidInput, match="torque"):
        pruned(law(drivetrain), ("torque",))
