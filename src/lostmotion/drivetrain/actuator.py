"""Actuator: lag and limits of the torque."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ..argument_checks import checks_arguments, not_negative
from ..errors import InvalidInput
from .short_repr import call_of


@checks_arguments
@dataclass(frozen=True, repr=False)
class Actuator:
    """The drive's torque actuator.

    Parameters
    ----------
    lag : float, s
        First-order lag of the torque.
    torque_limit : float, Nm
        Largest set-point.
    rate_limit : float, Nm/s
        Largest change of the set-point, which acts from sample to sample as in a digital drive.
    """

    lag: float = 0.0
    torque_limit: float = math.inf
    rate_limit: float = math.inf

    def __post_init__(self) -> None:
        object.__setattr__(self, "lag", not_negative("Actuator.lag", self.lag))
        if not self.torque_limit > 0.0:
            raise InvalidInput(
                "Actuator.torque_limit",
                repr(self.torque_limit),
                "a positive number in Nm",
                "Use inf for no limit.",
            )
        if not self.rate_limit > 0.0:
            raise InvalidInput(
                "Actuator.rate_limit",
                repr(self.rate_limit),
                "a positive number in Nm/s",
                "Use inf for no limit.",
            )

    def __repr__(self) -> str:
        return call_of(self)
