"""Checks of the kinds of arguments that the observers share: what is wrong is named, with a remedy."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import Any

import numpy as np

from ..drivetrain import Drivetrain
from ..errors import InvalidInput


def number(where: str, value: Any) -> float:
    """A real number as a float; infinity and NaN are left to whoever knows the range."""
    if isinstance(value, Real) and not isinstance(value, bool):
        with contextlib.suppress(OverflowError):
            return float(value)
    raise InvalidInput(where, repr(value), "a number", "Give a number in SI units, without its unit.")


def positive(where: str, value: Any, zero: bool = False) -> float:
    """A finite number above zero (or zero, where that is allowed)."""
    value = number(where, value)
    if not math.isfinite(value) or value < 0.0 or (value == 0.0 and not zero):
        raise InvalidInput(
            where, repr(value), "zero or more" if zero else "a positive number", "Check the unit."
        )
    return value


def known_options(where: str, given: Mapping[str, Any], known: type) -> None:
    """Raise for a name that ``known``, a TypedDict, does not have, which ``**options`` lets through."""
    names = tuple(known.__annotations__)
    unknown = sorted(set(given) - set(names))
    if unknown:
        raise InvalidInput(where, f"{unknown}", f"names out of {names}", "Check the names.")


def sample_time(value: Any) -> float:
    """The argument ``dt``."""
    value = number("dt", value)
    if not (math.isfinite(value) and value > 0.0):
        raise InvalidInput("dt", repr(value), "a positive sample time in s", "Check the unit.")
    return value


def flag(where: str, value: Any) -> bool:
    """True or False; words are refused, since "no" would count as true."""
    if not isinstance(value, bool | np.bool_):
        raise InvalidInput(where, repr(value), "True or False", "Give one of them, without quotes.")
    return bool(value)


def mapping(where: str, given: Any) -> dict[str, Any]:
    """A mapping of names as a dict, empty for None."""
    if given is None:
        return {}
    if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
        raise InvalidInput(where, repr(given), "a mapping of name → number", "Give {name: value}.")
    return dict(given)


def two_masses(value: Any) -> Drivetrain:
    """The argument ``drivetrain``; that it has two masses is checked where its numbers are read."""
    if not isinstance(value, Drivetrain):
        raise InvalidInput("drivetrain", repr(value), "a Drivetrain", "Make it with Drivetrain.two_mass.")
    return value


def sensors(given: Any, known: Sequence[str]) -> tuple[str, ...]:
    """The argument ``measured``: names out of ``known``, each once."""
    names = tuple(given) if isinstance(given, Sequence) and not isinstance(given, str) else ()
    if not names or any(name not in known for name in names) or len(set(names)) < len(names):
        raise InvalidInput(
            "measured",
            repr(given),
            f"names out of {tuple(known)}, each once",
            'Give ("speed_motor",) or more.',
        )
    return names
