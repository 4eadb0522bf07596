"""Tests that a recording may be for, beside identifying and validating: ``use = "torque_step"``, and their options."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ...errors import InvalidInput
from ...plain_data import shown
from ..spelling import suggestion
from ..tables.units import parse_quantity

#: Options of each test: the arguments of the function of ``lostmotion.identification`` that has its name.
METHODS: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "torque_step": ("inertia", "speed", "torque", "asymmetric", "min_speed", "averaging"),
        "rigid_drive": ("angle", "torque", "inertia", "asymmetric", "decimation"),
        "friction_ladder": ("speed", "torque", "reference", "plateaus", "inertia", "asymmetric", "stribeck"),
        "breakaway": ("angle", "torque", "travel"),
        "locked_backlash": ("angle", "torque", "resolution", "settling"),
        "lost_motion": ("angle_motor", "angle_load", "torque", "inertia_motor"),
        "shaft_stiffness": ("speed_a", "speed_b", "torque", "band", "min_coherence", "torque_delay"),
        "ring_down": ("signal", "band", "seed"),
    }
)
#: Units of those options that are quantities; a text with a unit is converted.
UNITS: Mapping[str, str] = MappingProxyType(
    {
        "inertia": "kg m2", "inertia_motor": "kg m2", "min_speed": "rad/s", "averaging": "s", "travel": "rad",
        "resolution": "rad", "settling": "s", "torque_delay": "s",
    }
)  # fmt: skip
#: What a recording may be for.
USES = ("identify", "validate", *METHODS)
#: Further signals that ``identify`` can be given.
MEASURED = ("speed_load", "twist", "torque_shaft", "angle_motor")


def use(value: object) -> str:
    """A purpose; raises InvalidInput with the nearest known one."""
    if value not in USES:
        raise InvalidInput("", shown(value), ", ".join(USES), suggestion(str(value), USES))
    return str(value)


def measured(value: object) -> tuple[str, ...]:
    """Names of further signals."""
    if not isinstance(value, list | tuple):
        raise InvalidInput(
            "", shown(value), 'a list of signals, such as ["speed_load"]', 'Write measured = ["speed_load"].'
        )
    for name in value:
        if name not in MEASURED:
            remedy = suggestion(str(name), MEASURED)
            if name == "speed_motor":
                remedy = "Leave it out: motor torque and motor speed are always used."
            raise InvalidInput("", shown(name), ", ".join(MEASURED), remedy)
    if len(set(value)) < len(value):
        raise InvalidInput("", shown(value), "each signal once", "Take one out.")
    return tuple(value)


def options(method: str, given: Mapping[str, object]) -> dict[str, object]:
    """The options of a test in SI; raises InvalidInput for one that it does not have."""
    known = METHODS.get(method, ())
    for name in given:
        if name not in known:
            expected = f"one of {', '.join(known)}" if known else "none: options are those of a test"
            raise InvalidInput("", f"unknown option {shown(name)}", expected, suggestion(name, known))
    return {
        name: parse_quantity(value, UNITS[name])
        if name in UNITS and isinstance(value, str)
        else _plain(value)
        for name, value in given.items()
    }


def _plain(value: object) -> object:
    """Lists as tuples, as the functions take them."""
    return tuple(map(_plain, value)) if isinstance(value, list) else value
