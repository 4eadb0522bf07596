"""The end of every state feedback: torque from gains on its inputs, friction by the set-point, torque limit."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from ...curves import saturation
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem
from .reference_direction import reference_direction


def limited_torque(
    name: str,
    gains: Mapping[str, float],
    *,
    dt: float,
    torque_limit: float,
    friction: tuple[float, float] = (0.0, 0.0),
    actuator_gain: float = 0.0,
    actuator: Mapping[str, Any] | None = None,
) -> DiscreteSystem:
    """torque_motor = clip(Σ gains·inputs + actuator_gain·torque_actuator + friction(first input), ±torque_limit).

    Parameters
    ----------
    name : str
        Of the law.
    gains : mapping of input → gain
        In the order of the law's inputs; the first is the set-point.
    dt : float, s
    torque_limit : float, Nm
        inf: no limit.
    friction : (plus, minus), Nm
        Added in the direction of the set-point, see ``reference_direction``.
    actuator_gain, actuator
        Gain on the current loop's torque, and its state as ``actuator_state`` gives it; default: none.

    Raises
    ------
    InvalidInput
        If the torque limit is not positive.
    """
    if not torque_limit > 0.0:
        raise InvalidInput(
            f"{name}.torque_limit", repr(torque_limit), "a positive number in Nm", "Use inf for none."
        )
    direct = np.array([list(gains.values())])
    by_state = np.full((1, 1 if actuator else 0), actuator_gain)
    curves = [reference_direction(*friction)] if max(friction) > 0.0 else []
    n = len(curves)
    by_reference = np.eye(1, len(gains))[:n]
    law: dict[str, Any] = {
        "name": name, "inputs": tuple(gains), "outputs": ("torque_motor",), "dt": dt, **(actuator or {})
    }  # fmt: skip
    if math.isinf(torque_limit):
        return DiscreteSystem(
            **law, curves=tuple(curves), G=by_reference, C=by_state, D=direct, J=np.ones((1, n))
        )
    return DiscreteSystem(
        **law, curves=(*curves, saturation(torque_limit)), F=np.vstack([np.zeros((n, by_state.size)), by_state]),
        G=np.vstack([by_reference, direct]), H=np.eye(n + 1, k=-1), J=np.eye(1, n + 1, n),
    )  # fmt: skip


def actuator_state(drivetrain: Drivetrain, dt: float, inputs: tuple[str, ...]) -> dict[str, Any]:
    """The current loop as a law's state: ``states``, ``A`` and ``B``, driven by the input torque_motor_acting; nothing
    where the drivetrain has no lag."""
    if drivetrain.lag == 0.0:
        return {}
    decay = math.exp(-dt / drivetrain.lag)
    acting = np.array([[float(name == "torque_motor_acting") for name in inputs]])
    return {"states": ("torque_actuator",), "A": np.array([[decay]]), "B": (1.0 - decay) * acting}
