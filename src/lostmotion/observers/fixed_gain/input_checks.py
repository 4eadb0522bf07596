"""The checks of an observer's measured inputs: each is compared with the observer's prediction of it."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem, InputCheck
from ..arguments import mapping, positive
from ..scale import scale_of, sized

Array = NDArray[np.float64]

#: Largest accepted difference between measured and predicted value, in SI units. Calibrated on the virtual rigs 1
#: to 4, where it stays below 3.8 rad/s with any parameter off by 20 % or 3 Nm on the load; the others accordingly, by
#: 6300 Nm/rad and the closed gap's 640 1/s. A drivetrain of another size gets them by ``scale.scale_of``. Where
#: good samples differ by more, the limit adapts.
LARGEST_INNOVATION: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 4.0, "speed_load": 4.0, "twist": 0.006, "torque_shaft": 40.0, "angle_motor": 0.006}
)

#: Rate at which the motor follows its measured speed while its torque is missing, 1/s on the paper's rig (in proportion
#: to the eigenfrequency of the closed shaft), and the most per sample (calibrated on rigs 1 to 4: slower loses the
#: angle, faster mistakes encoder steps for torque; more per sample oscillates).
FOLLOWING, FASTEST = 1500.0, 0.55


def limits_of(
    measured: tuple[str, ...], default: Mapping[str, float], given: Mapping[str, float] | None
) -> dict[str, float]:
    """The limit of each measured signal: the default, or what the user gave."""
    given = mapping("largest_innovation", given)
    if not set(given) <= set(measured):
        raise InvalidInput(
            "largest_innovation", f"{given}", f"limits of signals out of {measured}", "Check the names."
        )
    return {
        name: positive(f"largest_innovation[{name!r}]", given.get(name, default[name])) for name in measured
    }


def with_checks(
    law: DiscreteSystem,
    measured: tuple[str, ...],
    rows: tuple[Array, Array],
    drivetrain: Drivetrain,
    limits: Mapping[str, float] | None = None,
    keep: bool = False,
    alone: bool = False,
) -> DiscreteSystem:
    """The law with a check on each measured input, predicted as rows[0] x + rows[1] w over its first states and curves.

    ``limits`` replaces entries of ``LARGEST_INNOVATION``, which are sized for the drivetrain; ``keep`` and ``alone`` as
    in ``InputCheck``.
    """
    limits = limits_of(measured, sized(LARGEST_INNOVATION, scale_of(drivetrain)), limits)
    p, r = np.zeros((len(measured), len(law.states))), np.zeros((len(measured), len(law.curves)))
    p[:, : rows[0].shape[1]], r[:, : rows[1].shape[1]] = rows
    checks = tuple(InputCheck.over_time(name, limits[name], law.dt, keep, alone) for name in measured)
    return replace(law, checks=checks, P=p, R=r)


def with_torque_check(law: DiscreteSystem, drivetrain: Drivetrain) -> DiscreteSystem:
    """The law that replaces a missing torque_motor by the torque with which its motor follows the measured speed.

    That is the mean recent torque plus proportional and integral action on the speed error::

        T = T̄ + a·(speed_motor − expected),    T̄⁺ = T̄ + b·(T − T̄)

    A ramp of the speed is followed without delay, so the motor's angle stays right, and an encoder's steps are
    smoothed. With an actuator lag, T is the torque that the actuator reaches at the end of the sample. The gains a and
    b put the poles of the motor alone at the rate ``FOLLOWING``, damped by 0.7. T̄ is one more state,
    ``torque_motor_mean``.
    """
    inertia, lag = drivetrain.inertia_motor, drivetrain.lag
    rate = min(FOLLOWING * scale_of(drivetrain).rate * law.dt, FASTEST)
    pole = np.exp(rate * complex(-1.0, 1.0) / math.sqrt(2.0))
    change = 2.0 - 2.0 * float(pole.real)
    per_speed, share = change * inertia / law.dt, float(abs(1.0 - pole) ** 2) / change
    n, stays = len(law.states), math.exp(-law.dt / lag) if lag > 0.0 else 0.0
    mean, torque = np.zeros(n + 1), np.zeros(n + 1)
    mean[n], torque[n] = 1.0 - share, 1.0
    if lag > 0.0:
        actuator = law.states.index("torque_actuator")
        mean[actuator], torque[actuator] = share * stays, -stays
    expected = [check.input for check in law.checks].index("speed_motor")
    torque[:n] -= per_speed * law.P[expected]
    a, f, c, p = (np.pad(matrix, ((0, 0), (0, 1))) for matrix in (law.A, law.F, law.C, law.P))
    b, e, q = (np.pad(matrix, ((0, 1), (0, 0))) for matrix in (law.B, law.E, law.Q))
    b[n, law.inputs.index("torque_motor")] = share * (1.0 - stays)
    q[-1, law.inputs.index("speed_motor")] = per_speed / (1.0 - stays)
    return replace(
        law, states=(*law.states, "torque_motor_mean"), initial_state=np.append(law.initial_state, 0.0),
        checks=(*law.checks, InputCheck.when_missing("torque_motor")),
        A=np.vstack([a, mean]), B=b, E=e, F=f, C=c, P=np.vstack([p, torque / (1.0 - stays)]), Q=q,
        R=np.vstack([law.R, -per_speed / (1.0 - stays) * law.R[[expected]]]),
    )  # fmt: skip
