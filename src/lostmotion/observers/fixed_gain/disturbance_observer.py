"""Momentum disturbance observer, as drives use it: the shaft torque from the balance of the motor's momentum."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem, zero_order_hold
from ..arguments import flag, number, sample_time, two_masses
from ..estimates import estimated
from ..scale import scale_of
from .input_checks import with_checks

Array = NDArray[np.float64]

#: Rate at which the estimate follows the shaft torque, 1/s (calibrated on virtual rig 1: slower is late at its first
#: eigenmode, faster shows the encoder).
BANDWIDTH = 3000.0

OUTPUTS = estimated("twist_elastic", "speed_motor", "speed_load", "torque_shaft")


def disturbance_observer(
    drivetrain: Drivetrain,
    *,
    dt: float,
    bandwidth: float | None = None,
    speed_from_counts: bool = False,
    largest_innovation: Mapping[str, float] | None = None,
) -> DiscreteSystem:
    """Shaft torque and load speed from the motor's momentum alone: needs inertia, stiffness and lag, has no gap.

    States: momentum of the motor p = J·speed_motor, shaft torque T, and its rate v::

        ṗ = torque_motor − viscous_motor·speed_motor − T,    Ṫ = v,    v̇ = 0
        p̂, T̂, v̂ corrected by l·(speed_motor − p̂/J)
        twist_elastic = T̂/k,    speed_load = speed_motor − v̂/k

    All error poles lie at exp(−bandwidth·dt) (Ackermann's formula for the exact discrete model). The load's speed is
    valid while the shaft is in contact; in the gap it equals the motor's.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses. Used are inertia_motor, viscous_motor, stiffness and the actuator's lag.
    dt : float, s
        Sample time.
    bandwidth : float, 1/s
        Default ``BANDWIDTH`` on the paper's rig; on others in proportion to the eigenfrequency.
    speed_from_counts : bool
        The measured motor speed is a mean over the last sample.
    largest_innovation : mapping of measured signal → float, optional
        As in ``kalman``.

    Returns
    -------
    DiscreteSystem
        Inputs torque_motor and speed_motor; outputs ``OUTPUTS``.

    Raises
    ------
    InvalidInput
        For numbers out of range, and limits of unknown signals.

    Notes
    -----
    Ohnishi, Shibata & Murakami 1996, IEEE/ASME Trans. Mechatronics 1, 56–67; in momentum form De Luca & Mattone 2003,
    Proc. IEEE ICRA, 599–604.
    """
    drivetrain, dt = two_masses(drivetrain), sample_time(dt)
    own = BANDWIDTH * scale_of(drivetrain).rate
    bandwidth = own if bandwidth is None else bandwidth
    bandwidth = number("disturbance_observer.bandwidth", bandwidth)
    if not (math.isfinite(bandwidth) and 0.0 < bandwidth <= max(1.0 / dt, own)):
        raise InvalidInput(
            "disturbance_observer.bandwidth",
            repr(bandwidth),
            f"a positive rate up to {max(1.0 / dt, own):.3g} 1/s",
            "Check the unit.",
        )
    inertia, lag = drivetrain.inertia_motor, drivetrain.lag
    decay = drivetrain.viscous_motor / inertia
    a = np.array([[-decay, -1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]])
    states = ["momentum_motor", "torque_shaft", "torque_shaft_rate"]
    phi, gamma = zero_order_hold(a, [[1.0], [0.0], [0.0]], dt)
    c = np.array([[1.0 / inertia, 0.0, 0.0]])
    if flag("speed_from_counts", speed_from_counts):
        phi = np.pad(np.vstack([phi, c]), ((0, 0), (0, 1)))
        gamma = np.vstack([gamma, [[0.0]]])
        c = np.array([[0.5 / inertia, 0.0, 0.0, 0.5]])
        states.append("speed_motor_previous")
    gain = _observer_gain(phi, c, math.exp(-bandwidth * dt))
    full, b = phi - gain @ c, np.hstack([gamma, gain])
    if lag > 0.0:
        full, b = _with_lag(
            full, b, zero_order_hold([[-decay, 1.0], [0.0, -1.0 / lag]], [[0.0], [1.0 / lag]], dt)
        )
        states.append("torque_actuator")
    rows = np.zeros((4, len(states)))
    rows[0, 1], rows[1, 0], rows[3, 1] = 1.0 / drivetrain.stiffness, 1.0 / inertia, 1.0
    rows[2, 0], rows[2, 2] = 1.0 / inertia, -1.0 / drivetrain.stiffness
    law = DiscreteSystem(
        inputs=("torque_motor", "speed_motor"), outputs=OUTPUTS, states=tuple(states), dt=dt, A=full, B=b, C=rows,
        name="disturbance_observer",
    )  # fmt: skip
    # The straight line through the shaft torque predicts a sample or two; after 20 ms it is far off. It also follows a
    # frozen motor speed within a millisecond, so a frozen signal is detected by repetition.
    return with_checks(
        law, ("speed_motor",), (c, np.zeros((1, 0))), drivetrain, largest_innovation, keep=True, alone=True
    )


def _observer_gain(phi: Array, c: Array, pole: float) -> Array:
    """Gain that puts all eigenvalues of Φ − K c at the pole (Ackermann 1972)."""
    n = phi.shape[0]
    seen = np.vstack([c @ np.linalg.matrix_power(phi, i) for i in range(n)])
    wanted = np.linalg.matrix_power(phi - pole * np.eye(n), n)
    return np.asarray(wanted @ np.linalg.solve(seen, np.eye(n)[:, -1:]))


def _with_lag(full: Array, b: Array, step: tuple[Array, Array]) -> tuple[Array, Array]:
    """The torque reaches the momentum through the actuator: one more state, exact for a held set-point."""
    (phi, gamma), n = step, full.shape[0]
    full = np.pad(full, ((0, 1), (0, 1)))
    full[0, n], full[n, n] = phi[0, 1], phi[1, 1]
    b = np.pad(b, ((0, 1), (0, 0)))
    b[0, 0], b[n, 0] = gamma[0, 0], gamma[1, 0]
    return full, b
