"""The representation of a drivetrain's parts: the call that makes it, without what has its default value."""

from __future__ import annotations

from dataclasses import MISSING, Field, fields
from typing import Any


def call_of(part: Any, separator: str = ", ") -> str:
    """``Shaft(stiffness=6285.896, damping=0.397)``: exact, and Python that makes the same part again."""
    return f"{type(part).__name__}({separator.join(given(part))})"


def given(part: Any, *without: str) -> list[str]:
    """``name=value`` of every field of a dataclass that has another value than its default, but for those named."""
    values = [(field, getattr(part, field.name)) for field in fields(part) if field.name not in without]
    return [f"{field.name}={value!r}" for field, value in values if value != _default(field)]


def _default(field: Field[Any]) -> Any:
    return field.default if field.default_factory is MISSING else field.default_factory()
