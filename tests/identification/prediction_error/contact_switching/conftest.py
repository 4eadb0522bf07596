"""A recording of an exact drive, as the contact-switching filter takes it, and the drive's parameters."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import NAMES
from lostmotion.identification.prediction_error.innovations import Predictor

DT = 2e-4
PLANT = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip


@pytest.fixture(scope="session")
def plant() -> lm.Drivetrain:
    return PLANT


@pytest.fixture(scope="session")
def values() -> dict[str, float]:
    """True parameters, and the rates of the filter's unknown torques."""
    true = {name: value for name, value in PLANT.parameters().items() if name in NAMES}
    return true | {"motor_rate": 30.0, "load_rate": 10.0, "torque_rate": 0.0}


@pytest.fixture(scope="session", params=[False, True], ids=["noise", "counts"])
def flt(request: pytest.FixtureRequest) -> ContactFilter:
    torque = lm.signals.excitation(2.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    return _seen(PLANT, torque, 18 if request.param else None, 300.0)


@pytest.fixture(scope="session")
def seen() -> Callable[[lm.Drivetrain, np.ndarray, int | None, float], ContactFilter]:
    """Filter, for poles up to some Hz, of what a sensor of so many bits or with noise shows of a drive."""
    return _seen


def _seen(plant: lm.Drivetrain, torque: np.ndarray, bits: int | None, pole: float) -> ContactFilter:
    run = lm.simulate(plant, torque_motor=torque, dt=DT)
    if bits is None:
        speed = run["speed_motor"] + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
    else:
        count = 2.0 * np.pi / 2**bits
        speed = np.diff(np.floor(run["angle_motor"] / count), prepend=0.0) * count / DT
    return ContactFilter.of(Predictor(torque, speed, DT, bits is not None, plant, skip=0), pole)


@pytest.fixture(scope="session")
def four_inertias() -> Callable[[bool, bool], tuple[ContactFilter, dict[str, float]]]:
    """Filter and values of four inertias, with the third and the fourth behind the gap or before it."""
    return _four_inertias


def _four_inertias(behind: bool, fourth_behind: bool) -> tuple[ContactFilter, dict[str, float]]:
    """20 bits of a chain whose three shafts have loss factors of their own."""
    inertias, share, share_fourth = [0.05, 0.08], 0.4, 0.3
    third = share * inertias[behind]
    inertias[behind] -= third
    # The fourth divides the third if it is on its side, else the other end.
    if fourth_behind == behind:
        fourth = share_fourth * third
        third -= fourth
    else:
        fourth = share_fourth * inertias[fourth_behind]
        inertias[fourth_behind] -= fourth
    shafts = of_third, of_fourth, at_gap = (
        lm.Shaft(2e4, 12.0), lm.Shaft(1.5e4, 3.0), lm.Shaft(6e3, 1.0, backlash=0.01)
    )  # fmt: skip
    sides: list[list[tuple[float, lm.Shaft]]] = [[], []]
    sides[behind].append((third, of_third))
    sides[fourth_behind].append((fourth, of_fourth))
    before, after = sides[0], sides[1][::-1]
    chain = lm.Drivetrain(
        (inertias[0], *(inertia for inertia, _ in (*before, *after)), inertias[1]),
        (*(shaft for _, shaft in before), at_gap, *(shaft for _, shaft in after)),
        (lm.Friction(), lm.Friction(), lm.Friction(), lm.Friction(1.0)),
    )
    compliances, rates = (
        np.array([1.0 / shaft.stiffness for shaft in shafts]),
        np.array([shaft.damping / shaft.stiffness for shaft in shafts]),
    )
    parts = compliances / compliances.sum()
    pole = 2.0 * np.pi * lm.rig.eigenfrequencies(chain)[1]
    values = {
        "inertia_motor": 0.05, "inertia_load": 0.08, "stiffness": pole**2 / (1.0 / 0.05 + 1.0 / 0.08),
        "damping": float(parts @ rates / compliances.sum()), "backlash": 0.01, "coulomb": 1.0, "share": share,
        "compliance": parts[0], "loss": rates[0] / rates[2], "share_fourth": share_fourth,
        "compliance_fourth": parts[1] / (1.0 - parts[0]), "loss_fourth": rates[1] / rates[2],
    }  # fmt: skip
    torque = lm.signals.excitation(1.0, DT, seed=3, inertia=0.13, coulomb=1.0, viscous=0.0)
    count = 2.0 * np.pi / 2**20
    angle = np.floor(lm.simulate(chain, torque_motor=torque, dt=DT)["angle_motor"] / count) * count
    floor = count / np.sqrt(12.0)
    flt = ContactFilter(torque, angle, DT, True, floor, floor, 6, (0, torque.size))
    return replace(flt, behind=behind, fourth_behind=fourth_behind), values
