"""Poles of the linear-quadratic optimum: stable, damped, in proportion to the drive."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import quadratic_poles
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput

PLANT = Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.1)
UNIT = PLANT.inertia_total * 2.0 * np.pi * PLANT.pole_frequency


def test_little_torque_leaves_the_mode_where_it_is_and_damps_it():
    poles = np.array(quadratic_poles(PLANT, 0.02 * UNIT))
    mode = poles[np.abs(poles.imag) > 0.0]
    assert np.allclose(np.abs(mode.imag), 2.0 * np.pi * PLANT.pole_frequency, rtol=0.01)
    own = np.linalg.eigvals(PLANT.linear()[0])
    assert np.max(mode.real) < 2.0 * np.min(own.real)


def test_more_torque_is_faster():
    slowest = [max(p.real for p in quadratic_poles(PLANT, share * UNIT)) for share in (0.02, 0.1, 0.4)]
    assert slowest[0] > slowest[1] > slowest[2]


@pytest.mark.parametrize(("inertia", "rate"), [(1e-4, 1.0), (1e3, 1.0), (1.0, 0.05), (1.0, 30.0)])
def test_drives_of_one_shape_have_poles_in_proportion_to_their_mode(inertia, rate):
    """Inertias × a, stiffness × a·b², damping × a·b: the same drive, b times as fast."""
    scaled = Drivetrain.two_mass(
        inertia_motor=0.02 * inertia, inertia_load=0.1 * inertia, stiffness=6000.0 * inertia * rate**2,
        damping=0.1 * inertia * rate,
    )  # fmt: skip
    expected = rate * np.sort_complex(quadratic_poles(PLANT, 0.2 * UNIT))
    assert np.allclose(
        np.sort_complex(quadratic_poles(scaled, 0.2 * UNIT * inertia * rate)), expected, rtol=1e-6
    )


@pytest.mark.parametrize("torque", [0.0, -1.0, np.inf, np.nan])
def test_misuse(torque):
    with pytest.raises(InvalidInput, match="torque_per_error"):
        quadratic_poles(PLANT, torque)
