"""A law with straight lines in the place of its curves."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.curves import dead_zone, saturation
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.systems import DiscreteSystem, linearised

LAW = DiscreteSystem(
    inputs=("u",), outputs=("y",), states=("x",), dt=1e-3, curves=(dead_zone(1.0), saturation(2.0)),
    A=[[0.9]], B=[[0.1]], E=[[0.3, -0.2]], F=[[1.0], [0.5]], G=[[0.2], [1.0]], H=[[0.0, 0.0], [0.7, 0.0]],
    C=[[1.0]], D=[[0.0]], J=[[0.4, 1.5]],
)  # fmt: skip


def test_where_the_curves_are_straight_both_are_the_same():
    """Far outside the dead zone it has slope one, within the limit the saturation too: small changes agree."""
    linear = linearised(LAW, (0.0, 1.0))
    inputs = {"u": 0.2 * np.sin(np.arange(50))}
    assert np.allclose(LAW.run(inputs)["y"], linear.run(inputs)["y"], rtol=1e-12, atol=1e-15)
    assert linear.curves == ()


def test_an_observer_with_its_gap_closed_is_the_observer_without_backlash():
    plant = Drivetrain.two_mass(
        inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.4, backlash=0.01
    )
    with_gap = kalman(plant, dt=1e-4).without_checks()
    closed = [1.0 if curve.slopes[1] == 0.0 else 0.0 for curve in with_gap.curves]
    without = kalman(plant.with_parameters(backlash=0.0), dt=1e-4).without_checks()
    linear = linearised(with_gap, closed)
    for name in ("A", "B", "C", "D"):
        assert np.allclose(getattr(linear, name), getattr(without, name), rtol=1e-9, atol=1e-9), name


@pytest.mark.parametrize("slopes", [(1.0,), (1.0, np.nan), (1.0, 1.0, 1.0)])
def test_one_slope_for_each_curve(slopes):
    with pytest.raises(InvalidInput, match="slopes"):
        linearised(LAW, slopes)


def test_a_law_that_rejects_samples_is_not_linear():
    plant = Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0)
    with pytest.raises(InvalidInput, match="without_checks"):
        linearised(kalman(plant, dt=1e-4), ())
