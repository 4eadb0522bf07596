"""A chain with a joint beside the gap, as the contact-switching filter takes it, and two masses like it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter

DT = 2e-4
TWO_MASSES = {
    "inertia_motor": 0.05, "inertia_load": 0.08, "stiffness": 3000.0, "damping": 0.6, "backlash": 0.01, "coulomb": 1.0,
    "motor_rate": 30.0, "load_rate": 10.0,
}  # fmt: skip


@pytest.fixture
def two_masses() -> dict[str, float]:
    return dict(TWO_MASSES)


@pytest.fixture
def recorded() -> Callable[..., ContactFilter]:
    return _recorded


def _recorded(
    behind: bool, further: float = 9000.0, own: float = 4000.0, backlash: float = 0.01
) -> ContactFilter:
    """20 bits of a chain with a joint of a tenth of the motor's or load's inertia beside the gap."""
    shafts = [lm.Shaft(further, 3.0), lm.Shaft(own, 0.3, backlash=backlash)]
    inertias, friction = [0.045, 0.005, 0.08], lm.Friction(1.0)
    if behind:
        shafts, inertias = shafts[::-1], [0.05, 0.008, 0.072]
    chain = lm.Drivetrain(inertias, shafts, (lm.Friction(), lm.Friction(), friction))
    torque = lm.signals.excitation(0.6, DT, seed=3, inertia=0.13, coulomb=1.0, viscous=0.0)
    count = 2.0 * np.pi / 2**20
    angle = np.floor(lm.simulate(chain, torque_motor=torque, dt=DT)["angle_motor"] / count) * count
    floor = count / np.sqrt(12.0)
    return ContactFilter(torque, angle, DT, True, floor, floor, 6, (0, torque.size))
