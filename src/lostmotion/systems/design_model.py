"""The drivetrain as the design of a controller sees it: sampled, with current loop and computing delay."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .discrete_system import Matrix
from .discretisation import zero_order_hold


@dataclass(frozen=True, eq=False)
class DesignModel:
    """x⁺ = A x + B·torque_motor + E·torque_load with the gap closed, exact for torques held over a sample.

    Parameters
    ----------
    states : tuple of n names
        twist (its elastic part), speed_motor, speed_load; torque_actuator with a current loop's lag;
        torque_last with a delay of one sample, else torque_last_1 (acting now), torque_last_2, …
    A : (n, n) array
    B, E : (n,) arrays
        Torque that the law gives in this sample; torque on the load, positive in the direction of positive speed,
        friction counted as such. Nm.
    dt : float, s
    """

    states: tuple[str, ...]
    A: Matrix
    B: Matrix
    E: Matrix
    dt: float

    def row(self, **entries: float) -> Matrix:
        """A row (n,) over the states with the given entries."""
        row = np.zeros(len(self.states))
        for name, value in entries.items():
            row[self.states.index(name)] = value
        return row


@dataclass(frozen=True, eq=False)
class SteadyState:
    """The states (n,) of a design model that stay, and the motor torque (Nm) that holds them."""

    state: Matrix
    torque: float


@checks_arguments
def design_model(drivetrain: Drivetrain, dt: float, delay: int = 1) -> DesignModel:
    """The two-mass drivetrain with the gap closed, its current loop's lag, and ``delay`` samples of computing delay.

    Viscous friction is in, Coulomb friction is a load torque.

    Raises
    ------
    InvalidInput
        If there are not two masses, dt is not positive, or delay is not zero or more.
    """
    if not (isinstance(delay, int) and delay >= 0):
        raise InvalidInput("design_model.delay", repr(delay), "zero or more samples", "Give a whole number.")
    a, b = drivetrain.linear()
    load = np.array([[0.0], [0.0], [1.0 / drivetrain.inertia_load]])
    states = ["twist", "speed_motor", "speed_load"]
    if drivetrain.lag > 0.0:
        a = np.block([[a, b], [np.zeros((1, 3)), np.full((1, 1), -1.0 / drivetrain.lag)]])
        b, load = np.eye(4)[:, 3:] / drivetrain.lag, np.vstack([load, [[0.0]]])
        states.append("torque_actuator")
    phi, gamma = zero_order_hold(a, np.hstack([b, load]), dt)
    acting, load_step = gamma[:, 0], gamma[:, 1]
    n = len(states)
    if delay == 0:
        return DesignModel(tuple(states), phi, acting, load_step, dt)
    # The torque given now enters the queue at its end; the first of the queue acts in this sample.
    shift = np.eye(delay, k=1)
    A = np.block([[phi, acting[:, None], np.zeros((n, delay - 1))], [np.zeros((delay, n)), shift]])
    states += ["torque_last"] if delay == 1 else [f"torque_last_{i + 1}" for i in range(delay)]
    return DesignModel(tuple(states), A, np.eye(n + delay)[-1], np.pad(load_step, (0, delay)), dt)


@checks_arguments
def steady_state(
    drivetrain: Drivetrain, model: DesignModel, speed: float, torque_load: float = 0.0
) -> SteadyState:
    """What holds both masses at one speed against friction and a load torque.

    ::

        torque_shaft = coulomb·sign(speed) + viscous·speed − torque_load
        torque_motor = torque_shaft + coulomb_motor·sign(speed) + viscous_motor·speed

    Parameters
    ----------
    drivetrain : Drivetrain
        Friction as it is, with Stribeck; at rest none.
    model : DesignModel
        Of this drivetrain.
    speed : float, rad/s
    torque_load : float, Nm
        Positive in the direction of positive speed.
    """
    motor, load = drivetrain.frictions
    shaft = load.torque(speed) - torque_load
    torque = shaft + motor.torque(speed)
    held = {"twist": shaft / drivetrain.stiffness, "speed_motor": speed, "speed_load": speed}
    state = np.array([held.get(name, torque) for name in model.states])
    return SteadyState(state, torque)
