"""The two-mass drivetrain as an observer sees it: linear, with gap and friction as further inputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .arguments import mapping, number, sensors, two_masses

#: Signals that an observer can measure.
SENSORS = ("speed_motor", "speed_load", "twist", "torque_shaft", "angle_motor")


@dataclass(frozen=True, eq=False)
class ObserverModel:
    """ẋ = A x + B·torque_motor + E_gap·β + E_motor·friction_motor + E_load·friction_load; β = twist inside
    the gap.

    Fietzek & Rinderknecht, eq. 3, with viscous friction in A, and with the actuator's lag, the motor angle and
    an unknown load torque as further states where they are needed.
    """

    drivetrain: Drivetrain
    states: tuple[str, ...]
    A: NDArray[np.float64]
    B: NDArray[np.float64]
    E_gap: NDArray[np.float64]
    E_motor: NDArray[np.float64]
    E_load: NDArray[np.float64]

    def row(self, **entries: float) -> NDArray[np.float64]:
        """A row over the states with the given entries."""
        row = np.zeros(len(self.states))
        for name, value in entries.items():
            row[self.states.index(name)] = value
        return row

    def contact_argument(self, ahead: float = 0.0) -> NDArray[np.float64]:
        """Row of the argument of the gap curve, ``ahead`` seconds later if the rate stays."""
        shaft = self.drivetrain.shaft
        lead = ahead if shaft.contact == "dead_zone" else ahead + shaft.damping / shaft.stiffness
        return self.row(twist=1.0, speed_motor=lead, speed_load=-lead)

    def measurement_row(self, signal: str) -> NDArray[np.float64]:
        """Row of a measured signal with the gap closed."""
        if signal != "torque_shaft":
            return self.row(**{signal: 1.0})
        k, d = self.drivetrain.stiffness, self.drivetrain.damping
        return self.row(twist=k, speed_motor=d, speed_load=-d)


def observer_model(
    drivetrain: Drivetrain, measured: Sequence[str], load_torque: bool = False
) -> ObserverModel:
    """The model for a two-mass drivetrain; states twist, speed_motor, speed_load (torque_actuator,
    angle_motor, torque_load).

    ``torque_actuator`` is there if the drivetrain has a torque lag, ``angle_motor`` if it is measured,
    ``torque_load`` (positive in the direction of positive speed, constant but for process noise) if an unknown
    ``load_torque`` is to be estimated.
    """
    drivetrain, measured = two_masses(drivetrain), sensors(measured, SENSORS)
    a, b = drivetrain.linear()
    states = ["twist", "speed_motor", "speed_load"]
    if drivetrain.lag > 0.0:
        a = np.block([[a, b], [np.zeros((1, 3)), np.array([[-1.0 / drivetrain.lag]])]])
        b = np.array([[0.0], [0.0], [0.0], [1.0 / drivetrain.lag]])
        states.append("torque_actuator")
    if "angle_motor" in measured:
        n = len(states)
        a = np.block([[a, np.zeros((n, 1))], [np.eye(1, n, 1), np.zeros((1, 1))]])
        b = np.vstack([b, [[0.0]]])
        states.append("angle_motor")
    if load_torque:
        n = len(states)
        a = np.pad(a, ((0, 1), (0, 1)))
        a[2, n] = 1.0 / drivetrain.inertia_load
        b = np.vstack([b, [[0.0]]])
        states.append("torque_load")
    k, jm, jl = drivetrain.stiffness, drivetrain.inertia_motor, drivetrain.inertia_load
    one = np.eye(len(states))
    gap = k / jm * one[:, [1]] - k / jl * one[:, [2]]
    return ObserverModel(drivetrain, tuple(states), a, b, gap, -one[:, [1]] / jm, -one[:, [2]] / jl)


def in_the_gap(model: ObserverModel) -> NDArray[np.float64]:
    """A without the shaft: what is left of the dynamics inside the gap."""
    shaft, (jm, jl) = model.drivetrain.shaft, model.drivetrain.inertias
    pull = model.row(twist=shaft.stiffness, speed_motor=shaft.damping, speed_load=-shaft.damping)
    a = model.A.copy()
    a[1] += pull / jm
    a[2] -= pull / jl
    return a


def covariance(
    where: str,
    names: Sequence[str],
    default: Mapping[str, float],
    given: Mapping[str, float] | None,
    positive: bool,
) -> NDArray[np.float64]:
    """Diagonal covariance over ``names``: the defaults, changed by what the user gave."""
    given = mapping(where, given)
    unknown = sorted(set(given) - set(names))
    if unknown:
        raise InvalidInput(where, f"{unknown}", f"names out of {tuple(names)}", "Check the names.")
    values = np.array([number(f"{where}[{name!r}]", given.get(name, default[name])) for name in names])
    if not np.all(np.isfinite(values)) or np.any(values < 0.0) or (positive and np.any(values == 0.0)):
        raise InvalidInput(
            where,
            f"{given}",
            "positive numbers" if positive else "zero or positive numbers",
            "Give variances.",
        )
    return np.diag(values)
