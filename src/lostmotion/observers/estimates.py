"""Names of what observers estimate: outputs end in ``_estimated``, their standard deviations in ``_deviation``."""

from __future__ import annotations


def estimated(*signals: str) -> tuple[str, ...]:
    return tuple(f"{signal}_estimated" for signal in signals)


def deviations(*signals: str) -> tuple[str, ...]:
    return tuple(f"{signal}_deviation" for signal in signals)


#: What every observer of two masses estimates, in this order: elastic twist zero inside the gap, friction of the load
#: with its viscous part.
SIGNALS = ("twist", "twist_elastic", "speed_motor", "speed_load", "torque_shaft", "friction_load")
ESTIMATES = estimated(*SIGNALS)
