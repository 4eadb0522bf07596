"""The checks of an observer's measured inputs: each is compared with what the observer expects of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..systems import DiscreteSystem, InputCheck

Array = NDArray[np.float64]

#: Largest difference between measured and expected value that is believed, in SI units. Chosen on the virtual rig,
#: where it stays below 3.8 rad/s with any parameter off by 20 % or 3 Nm on the load; the others accordingly, by 6300
#: Nm/rad and the closed gap's 640 1/s. Where healthy samples are further off, the check learns it.
LARGEST_INNOVATION: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 4.0, "speed_load": 4.0, "twist": 0.006, "torque_shaft": 40.0, "angle_motor": 0.006}
)


def limits_of(
    measured: tuple[str, ...], default: Mapping[str, float], given: Mapping[str, float] | None
) -> dict[str, float]:
    """The limit of each measured signal: the default, or what the user gave."""
    given = given or {}
    if not set(given) <= set(measured):
        raise InvalidInput(
            "largest_innovation", f"{dict(given)}", f"limits of signals out of {measured}", "Check the names."
        )
    return {name: given.get(name, default[name]) for name in measured}


def with_checks(
    law: DiscreteSystem,
    measured: tuple[str, ...],
    rows: tuple[Array, Array],
    limits: Mapping[str, float] | None = None,
    keep: bool = False,
    alone: bool = False,
) -> DiscreteSystem:
    """The law with a check on each measured input, expected as rows[0] x + rows[1] w over its first states and curves.

    ``limits`` replaces entries of ``LARGEST_INNOVATION``; ``keep`` and ``alone`` as in ``InputCheck``.
    """
    limits = limits_of(measured, LARGEST_INNOVATION, limits)
    p, r = np.zeros((len(measured), len(law.states))), np.zeros((len(measured), len(law.curves)))
    p[:, : rows[0].shape[1]], r[:, : rows[1].shape[1]] = rows
    checks = tuple(InputCheck.over_time(name, limits[name], law.dt, keep, alone) for name in measured)
    return replace(law, checks=checks, P=p, R=r)


def with_torque_check(
    law: DiscreteSystem, states: Array, signal: tuple[str, float], curves: Array
) -> DiscreteSystem:
    """The law that while torque_motor is missing takes states·x + share·signal + curves·w for it.

    Both rows go over the law's first states and curves; ``signal`` is a checked input and its share.
    """
    p, q, r = (np.pad(matrix, ((0, 1), (0, 0))) for matrix in (law.P, law.Q, law.R))
    p[-1, : states.size], r[-1, : curves.size] = states, curves
    q[-1, law.inputs.index(signal[0])] = signal[1]
    return replace(law, checks=(*law.checks, InputCheck.when_missing("torque_motor")), P=p, Q=q, R=r)
