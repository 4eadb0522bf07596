"""The parameter vector θ of the contact-switching filter: what is in it, and how each value enters."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: The kernel's parameters in its order, SI units, and how each enters the parameter vector θ: as a logarithm, as that
#: of lag + sample time, or plainly in a unit of its own. Friction is plain, as either end may have none: a descent can
#: then move it from one end to the other and keep the sum. In logarithms the way to none is a curve that none follows.
PARAMETERS = {
    "inertia_motor": "log", "inertia_load": "log", "stiffness": "log", "damping": "log", "backlash": "log",
    "coulomb": "friction", "viscous": "damper", "coulomb_motor": "friction", "viscous_motor": "damper", "lag": "lag",
    "delay": "samples", "torque_offset": "torque", "share": "log", "compliance": "log", "loss": "log",
    "motor_rate": "log", "load_rate": "log", "torque_rate": "log", "rise": "plain", "fade": "log",
    "rise_motor": "plain", "fade_motor": "log", "impact": "log", "share_fourth": "log", "compliance_fourth": "log",
    "loss_fourth": "log",
}  # fmt: skip
NAMES = tuple(PARAMETERS)
INDEX = {name: i for i, name in enumerate(NAMES)}
#: Which of them enter as a logarithm, and which as that of lag + sample time.
LOGARITHM, LAG = (np.array([kind == wanted for kind in PARAMETERS.values()]) for wanted in ("log", "lag"))
#: Friction of the load's end and of the motor's.
FRICTIONS = ("coulomb", "viscous", "coulomb_motor", "viscous_motor")
#: Numbers of the kinds of parameters in the kernel (layout).
KINDS = {"log": 0, "lag": 1, "samples": 2, "plain": 2, "torque": 2, "friction": 2, "damper": 2}


def units_of(dt: float, torque: float, friction: float, damper: float) -> Array:
    """(26,) units of the parameters that enter plainly, one for the others: the sample time (s), those given for torque
    and Coulomb friction (Nm), and for viscous friction (Nm s/rad)."""
    units = {"samples": dt, "torque": torque, "friction": friction, "damper": damper}
    return np.array([units.get(kind, 1.0) for kind in PARAMETERS.values()])


def vector_of(values: Mapping[str, float], dt: float, units: Array) -> Array:
    """θ (26,) of values, SI, zero where there is none; −inf for the logarithm of zero."""
    given = np.array([values.get(name, 0.0) for name in NAMES])
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(LOGARITHM, np.log(given), np.where(LAG, np.log(given + dt), given / units))


def values_of(theta: Array, dt: float, units: Array) -> Array:
    """(26,) values of θ, SI."""
    with np.errstate(over="ignore", invalid="ignore"):
        grown = np.exp(theta)
        return np.where(LOGARITHM, grown, np.where(LAG, np.maximum(grown - dt, 0.0), theta * units))


def pole_of(theta: Array) -> float:
    """Torsional frequency of a parameter vector, Hz."""
    motor, load, stiffness = np.exp(theta[:3])
    return float(np.sqrt(stiffness * (1.0 / motor + 1.0 / load)) / (2.0 * np.pi))
