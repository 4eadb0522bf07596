"""Arguments of public functions: held against their annotations before anything is computed.

What an annotation cannot say (that a number is positive, that two arrays are of one length) the function checks itself.
"""

from __future__ import annotations

import functools
import inspect
import math
import os
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from numbers import Complex, Integral, Real
from typing import Any, NamedTuple, TypeVar

import numpy as np

from .errors import InvalidInput
from .plain_data import shown

#: Largest finite number that a public function takes, in SI units (numerics: the square of a larger one is near the end
#: of the floats). Infinity is taken only by a ``Limit``, and by an argument that is infinite by default.
LARGEST = 1e100

#: A number that may be infinite, as a limit is that there is none of.
Limit = float

_Public = TypeVar("_Public", bound=Callable[..., Any])


class _Kind(NamedTuple):
    """What an annotation asks for; ``items`` gives the place, the value and the kind of each part of a value."""

    fits: Callable[[Any], bool]
    expected: str
    remedy: str
    items: Callable[[Any], Iterable[tuple[str, Any, _Kind]]] = lambda value: ()


def checks_arguments(public: _Public) -> _Public:
    """Decorator of a public function or class: a wrong argument raises ``InvalidInput`` with its name."""
    if inspect.isclass(public):
        public.__init__ = _checking(public.__init__, public.__qualname__)  # type: ignore[method-assign]
        return public
    return _checking(public, public.__qualname__)


def not_negative(where: str, value: float, positive: bool = False) -> float:
    """The value as a float; raises ``InvalidInput`` where it is negative, infinite, or zero and must be positive."""
    value = float(value)
    if not math.isfinite(value) or value < 0.0 or (positive and value == 0.0):
        expected = "a positive number" if positive else "zero or a positive number"
        raise InvalidInput(where, repr(value), f"{expected} in SI units", "Check the sign and the unit.")
    return value


def _checking(function: Any, name: str) -> Any:
    parameters = inspect.signature(function).parameters.values()
    kinds = {p.name: _kind(_asked(p)) for p in parameters if p.kind is not p.VAR_KEYWORD}
    others = next((_kind(_asked(p)) for p in parameters if p.kind is p.VAR_KEYWORD), None)
    in_turn = [p.name for p in parameters if p.kind is p.POSITIONAL_OR_KEYWORD]

    @functools.wraps(function)
    def checked(*arguments: Any, **named: Any) -> Any:
        # Too many, missing and unknown arguments are refused by Python itself.
        for argument, value in (*zip(in_turn, arguments, strict=False), *named.items()):
            kind = kinds.get(argument, others)
            if kind is not None and not kind.fits(value):
                raise _complaint(f"{name}.{argument}", value, kind)
        return function(*arguments, **named)

    return checked


def _complaint(where: str, value: Any, kind: _Kind) -> InvalidInput:
    """The error of the first part that does not fit, else of the whole."""
    for place, part, asked in kind.items(value):
        if not asked.fits(part):
            return _complaint(f"{where}{place}", part, asked)
    return InvalidInput(where, shown(value), kind.expected, kind.remedy)


def _asked(parameter: inspect.Parameter) -> str:
    """The annotation; a limit, which may be infinite, differs from a number by its default."""
    infinite = isinstance(parameter.default, float) and math.isinf(parameter.default)
    return "Limit" if infinite else str(parameter.annotation)


@functools.cache
def _kind(annotation: str) -> _Kind | None:
    """What an annotation asks for; None where that is not known, or anything will do."""
    annotation = annotation.strip("'\" ")
    parts = _split(annotation, "|")
    if len(parts) > 1:
        kinds = [_kind(part) for part in parts if part != "None"]
        if None in kinds:
            return None
        return _one_of([kind for kind in kinds if kind], optional="None" in parts)
    match = re.fullmatch(r"([\w.]+)\[(.*)\]", annotation, re.DOTALL)
    if match is None:
        return _SIMPLE.get(annotation) or (_instance(annotation) if annotation in _CLASSES else None)
    return _container(match[1], _split(match[2], ","))


def _split(text: str, mark: str) -> list[str]:
    """Parts of an annotation between marks that no bracket encloses."""
    parts, depth = [""], 0
    for character in text:
        depth += (character == "[") - (character == "]")
        if character == mark and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts]


def _one_of(kinds: list[_Kind], optional: bool) -> _Kind:
    return _Kind(
        lambda value: (optional and value is None) or any(kind.fits(value) for kind in kinds),
        " or ".join(dict.fromkeys(kind.expected for kind in kinds)) + (", or None" if optional else ""),
        kinds[0].remedy,
        lambda value: [part for kind in kinds for part in kind.items(value)],
    )


def _container(name: str, inside: list[str]) -> _Kind | None:
    """Lists, tuples and mappings; the items are checked where their kind is known."""
    if name in _SIMPLE:
        return _SIMPLE[name]
    if name in ("Mapping", "dict"):
        return _mapping(_kind(inside[1]))
    if name not in ("Sequence", "Collection", "tuple", "list"):
        return None
    if name == "tuple" and inside[-1] != "...":
        return _row([_kind(one) for one in inside])
    item = _kind(inside[0])
    of = f" ({item.expected} each)" if item else ""
    return _Kind(
        lambda value: _is_list(value, name) and (item is None or all(map(item.fits, value))),
        f"a list or tuple{of}",
        "Give a list, also of a single one.",
        lambda value: (
            [(f"[{i}]", one, item) for i, one in enumerate(value)] if item and _is_list(value, name) else []
        ),
    )


def _is_list(value: Any, name: str = "Sequence") -> bool:
    if isinstance(value, np.ndarray):
        return value.ndim > 0
    return isinstance(value, Collection if name == "Collection" else Sequence) and not isinstance(
        value, str | bytes
    )


def _row(items: list[_Kind | None]) -> _Kind:
    """As many values as there are kinds."""
    said = ", ".join(item.expected if item else "a value" for item in items)
    return _Kind(
        lambda value: (
            _is_list(value)
            and len(value) == len(items)
            and all(item is None or item.fits(one) for item, one in zip(items, value, strict=True))
        ),
        f"({said})",
        f"Give {len(items)} values.",
        lambda value: (
            [(f"[{i}]", one, item) for i, (one, item) in enumerate(zip(value, items, strict=True)) if item]
            if _is_list(value) and len(value) == len(items)
            else []
        ),
    )


def _mapping(item: _Kind | None) -> _Kind:
    return _Kind(
        lambda value: (
            isinstance(value, Mapping)
            and all(isinstance(key, str) for key in value)
            and (item is None or all(map(item.fits, value.values())))
        ),
        f"a mapping of name → {item.expected if item else 'value'}",
        "Give {name: value}.",
        lambda value: (
            [(f"[{key!r}]", one, item) for key, one in value.items()]
            if item and isinstance(value, Mapping)
            else []
        ),
    )


def _scalar(value: Any) -> Any:
    """An array without axes is its number."""
    return value.item() if isinstance(value, np.ndarray) and value.ndim == 0 else value


def _is_number(value: Any) -> bool:
    value = _scalar(value)
    if not isinstance(value, Real) or isinstance(value, bool):
        return False
    try:
        size = abs(float(value))
    except OverflowError:  # a whole number beyond 1e308
        return False
    return size <= LARGEST


def _is_limit(value: Any) -> bool:
    return _is_number(value) or (isinstance(_scalar(value), float) and math.isinf(value))


def _is_complex(value: Any) -> bool:
    value = _scalar(value)
    if not isinstance(value, Complex) or isinstance(value, bool):
        return False
    return _is_number(value) if isinstance(value, Real) else abs(complex(value)) <= LARGEST


def _is_whole(value: Any) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and abs(int(value)) < 2**63


def _is_array(value: Any, kinds: str = "fiub") -> bool:
    if np.ma.is_masked(value):  # what is masked would count as if it were not
        return False
    try:
        return np.asarray(value).dtype.kind in kinds
    except (ValueError, TypeError, OverflowError):  # rows of different lengths
        return False


def _instance(name: str) -> _Kind:
    return _Kind(
        lambda value: any(kind.__name__ == name for kind in type(value).__mro__),
        f"a {name}",
        f"Give a {name}{_CLASSES[name]}.",
    )


#: Classes of this package, by name so that none needs to be imported, and where one comes from.
_CLASSES = {
    "Configuration": ", as read_configuration returns it",
    "InputCheck": "; it is made of an input's name, limit, hold and forget",
    "PiecewiseLinear": "; saturation(limit) is one",
    "DesignModel": ", as design_model returns it",
    "DiscreteSystem": ": a filter is none; kalman, disturbance_observer and the controllers make one",
    "Drivetrain": "; Drivetrain.two_mass(...) makes one",
    "FrequencyResponse": ", as frequency_response returns it",
    "FrictionFit": ", as torque_step and rigid_drive return it",
    "RunningProof": ", as prove_running returns it",
    "BoxProof": ", as prove_box returns it",
    "ObserverError": ", as observer_error returns it",
    "ContinuousLaw": "; continuous_pi() is one",
    "Recording": "; read_recording and simulate return one",
    "Sensor": '; Sensor("speed_motor") is a perfect one',
    "Shaft": "; Shaft(stiffness) is the simplest",
    "Friction": "; Friction() is none at all",
    "Actuator": "; Actuator() is a perfect one",
    "Stepper": ", as the nonlinear observers are",
    "TorsionalModel": "; assemble(parts) makes one",
}
_NUMBERS = "Give numbers in SI units, without their unit, and none of them masked."
_SIMPLE: Mapping[str, _Kind] = {
    "float": _Kind(
        _is_number, f"a finite number up to {LARGEST:g}", "Give a number in SI units, without its unit."
    ),
    "Limit": _Kind(
        _is_limit, "a number, or infinity for none", "Give a number in SI units, without its unit."
    ),
    "complex": _Kind(_is_complex, f"a finite number up to {LARGEST:g}", "Give a number, real or complex."),
    "int": _Kind(_is_whole, "a whole number", "Give it without a decimal point, with 18 digits at most."),
    "bool": _Kind(
        lambda value: isinstance(value, bool | np.bool_), "True or False", "Give one of them, without quotes."
    ),
    # Which texts a Literal, or its alias, allows is said by the function itself.
    **dict.fromkeys(
        ("str", "Literal", "Method", "FrictionCompensation"),
        _Kind(lambda value: isinstance(value, str), "a text", "Give it in quotes."),
    ),
    **dict.fromkeys(
        ("Path", "os.PathLike"),
        _Kind(lambda value: isinstance(value, os.PathLike), "a path", "Give the name of the file."),
    ),
    **dict.fromkeys(
        ("ArrayLike", "Array", "Floats", "Matrix", "NDArray"), _Kind(_is_array, "numbers", _NUMBERS)
    ),
    "Complexes": _Kind(lambda value: _is_array(value, "fiubc"), "numbers, real or complex", _NUMBERS),
}
