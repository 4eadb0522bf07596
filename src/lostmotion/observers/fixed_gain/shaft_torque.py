"""Load speed from motor speed and shaft torque: no inertia, no friction and no motor torque needed."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from ...systems import DiscreteSystem, InputCheck, zero_order_hold
from ..arguments import number, positive, sample_time
from ..estimates import estimated
from .input_checks import limits_of

#: Standard deviation of one sample of the torque sensor by default, Nm (option).
TORQUE_NOISE = 0.02
#: Random walk of the load's acceleration: root of the density of its rate, rad/s³·√s (option: 950 rad/s² within 1 ms,
#: so that the load is followed within two samples and the noise of the torque sensor is still averaged).
JERK = 3e4

#: Largest accepted difference between measured and predicted torque, in standard deviations of that difference by the
#: model (calibrated on a closed shaft, seeds 1 to 4, by the error after jumps and zeros of the torque: half and double
#: are up to 1.7 times worse; benchmarks/calibrations.py). A quarter of it is the largest sudden change.
TORQUE_DEVIATIONS = 60.0
#: How long a fault is bridged by prediction, s, its fewest samples, and how long an error is remembered, s (calibrated
#: on the same: half of HOLD or MEMORY does as well, double MEMORY is 1.6 times worse, double HOLD 24 times: without a
#: model of either end a longer prediction is worse than the fault, whose effect decays as fast).
HOLD, FEWEST, MEMORY = 3e-3, 3, 0.1

INPUTS = ("speed_motor", "torque_shaft")
OUTPUTS = estimated("twist_elastic", "speed_load")


def shaft_torque(
    stiffness: float,
    *,
    dt: float,
    torque_delay: float = 0.0,
    torque_noise: float = TORQUE_NOISE,
    jerk: float = JERK,
    largest_innovation: Mapping[str, float] | None = None,
) -> DiscreteSystem:
    """Observer of the load speed for a closed shaft whose torque is measured.

    States: elastic twist, load speed, load acceleration, the last one a random walk::

        d twist/dt = speed_motor − speed_load,     d speed_load/dt = acceleration
        torque_shaft(t) = stiffness·twist(t − torque_delay) ≈ stiffness·(twist − torque_delay·(d twist/dt))

    The motor speed is integrated by the trapezoidal rule, whose phase is exact, and the estimates of a sample use the
    measurements of that sample. ``identification.shaft_stiffness`` gives stiffness and delay; its apparent delay
    includes −damping/stiffness, as needed here.

    Parameters
    ----------
    stiffness : float, Nm/rad
    dt : float, s
        Sample time.
    torque_delay : float, s
        Delay of the torque against the speed; up to a few samples.
    torque_noise : float, Nm
        Standard deviation of one sample.
    jerk : float, rad/s³·√s
        Random walk of the load's acceleration.
    largest_innovation : mapping of measured signal → float, optional
        As in ``kalman``. Default for the torque: ``TORQUE_DEVIATIONS``; for the speed, the change that moves the
        predicted torque by as much within one sample. A smaller error does no lasting harm, and a good counter of a
        real rig jumps by 2.5 % of its speed several times a second.

    Returns
    -------
    DiscreteSystem
        Inputs speed_motor, torque_shaft; outputs ``OUTPUTS``. Bad samples are replaced by predictions for
        ``HOLD``: the torque from the states, the speed on a straight line through the last two; they are flagged for as
        long as they are missing or frozen. In a gap the torque contains no information about the load: then use
        ``kalman`` with torque_shaft among the measured signals.

    Raises
    ------
    InvalidInput
        For numbers that are not positive and finite.

    Notes
    -----
    Kalman filter of a target whose acceleration is a random walk (Bar-Shalom, Li & Kirubarajan 2001, Estimation with
    Applications to Tracking and Navigation, chapter 6), measured through a spring. Defaults chosen.
    """
    from scipy.linalg import block_diag, solve_discrete_are

    numbers = {"stiffness": stiffness, "torque_noise": torque_noise, "jerk": jerk}
    for name, value in numbers.items():
        positive(f"shaft_torque.{name}", value)
    dt, torque_delay = sample_time(dt), number("shaft_torque.torque_delay", torque_delay)
    if not abs(torque_delay) <= 5.0 * dt:
        raise InvalidInput(
            "shaft_torque.torque_delay", f"{torque_delay} s", "within five samples", "Shift the torque first."
        )
    a = np.array([[0.0, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    phi, gamma = zero_order_hold(a, [[1.0], [0.0], [0.0]], dt)
    # Torque = c x + d·speed_motor; the twist state does not yet contain half of this sample's motor speed.
    c = stiffness * np.array([[1.0, torque_delay, 0.0]])
    missing = np.array([[0.5 * dt], [0.0], [0.0]])
    d = float((c @ missing)[0, 0]) - stiffness * torque_delay
    noise = _jerk_covariance(jerk, dt)
    p = solve_discrete_are(phi.T, c.T, noise, np.array([[torque_noise**2]]))
    gain = p @ c.T / (c @ p @ c.T + torque_noise**2)
    rows = np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    correct, direct = np.eye(3) - gain @ c, np.hstack([missing - gain * d, gain])
    carried = np.hstack([gamma - phi @ gain * d, phi @ gain])
    # Two more states: the last two motor speeds, for the straight line.
    shift = np.array([[0.0, 0.0], [1.0, 0.0]])
    speed = np.array([[0.0, 0.0, 0.0, 2.0, -1.0]])
    deviation = math.sqrt(float((c @ p @ c.T)[0, 0]) + torque_noise**2)
    torque = TORQUE_DEVIATIONS * deviation
    default = {"speed_motor": torque / (stiffness * dt), "torque_shaft": torque}
    checks = _checks(dt, limits_of(INPUTS, default, largest_innovation))
    return DiscreteSystem(
        inputs=INPUTS, outputs=OUTPUTS, dt=dt, name="shaft_torque",
        states=("twist_elastic", "speed_load", "acceleration_load", "speed_motor_1", "speed_motor_2"),
        A=block_diag(phi @ correct, shift), B=np.vstack([carried, [[1.0, 0.0], [0.0, 0.0]]]),
        C=np.pad(rows @ correct, ((0, 0), (0, 2))), D=rows @ direct,
        checks=checks, P=np.vstack([speed, np.pad(c, ((0, 0), (0, 2))) + d * speed]),
    )  # fmt: skip


def _checks(dt: float, limits: Mapping[str, float]) -> tuple[InputCheck, ...]:
    hold = max(HOLD, FEWEST * dt)
    return tuple(
        InputCheck.over_time(name, limits[name], dt, alone=True, hold=hold, memory=MEMORY) for name in INPUTS
    )


def _jerk_covariance(jerk: float, dt: float) -> NDArray[np.float64]:
    """Covariance after one sample of twist, speed and acceleration, driven by a white rate of the acceleration."""
    # v(s) = (−s²/2, s, 1) is what a unit of jerk makes after s; this is ∫ v vᵀ ds.
    t2, t3, t4, t5 = dt**2 / 2.0, dt**3, dt**4 / 8.0, dt**5 / 20.0
    return jerk**2 * np.array([[t5, -t4, -t3 / 6.0], [-t4, t3 / 3.0, t2], [-t3 / 6.0, t2, dt]])
