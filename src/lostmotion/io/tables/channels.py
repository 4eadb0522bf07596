"""Channel: which column a signal is taken from, and how its numbers become SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput, Problem
from ...recording import unit_of
from ..spelling import suggestion
from .columns import Column
from .units import is_unit, unit_factor

#: Dimensions that a stated scale turns into that of the signal: a current into a torque by Nm/A, a share into
#: a torque by the rated one, a path into an angle by rad/m.
SCALABLE = ("A", "V", "N", "m", "m/s", "1")


@dataclass(frozen=True)
class Channel:
    """One channel of a file: SI value = sign · (scale · number + offset) in ``unit``.

    Parameters
    ----------
    column : str or int
        Header name, number counted from 0, or path in a .mat file (``"data[:,5]"``).
    unit : str
        Default: the unit in brackets in the header; without either the numbers count as SI.
    scale, offset : float
        Where ``unit`` is not of the signal's dimension (a current for a torque), ``scale`` converts it
        from SI to SI (Nm/A) and ``offset`` is in the signal's SI unit.
    sign : {1, -1}
    counts_per_rev : float, optional
        For the units ``counts`` and ``counts/s``.
    """

    column: str | int
    unit: str = ""
    scale: float | None = None
    sign: int = 1
    offset: float = 0.0
    counts_per_rev: float | None = None

    @classmethod
    def of(cls, spec: object, where: str) -> Channel:
        """A channel from a column or from a mapping with the fields of this class.

        Raises
        ------
        InvalidInput
            If a key is unknown or a value has the wrong type.
        """
        if isinstance(spec, Channel):
            return spec
        if isinstance(spec, str | int) and not isinstance(spec, bool):
            return cls(spec)
        names = [f.name for f in fields(cls)]
        if not isinstance(spec, Mapping) or "column" not in spec:
            raise InvalidInput(
                where,
                repr(spec),
                "a column, or a table of " + ", ".join(names),
                "Give at least the column.",
            )
        for key in spec:
            if key not in names:
                raise InvalidInput(
                    where, f"unknown key {key!r}", "one of " + ", ".join(names), suggestion(key, names)
                )
        channel = cls(**{k: v for k, v in spec.items() if v is not None})
        channel._check(where)
        return channel

    def _check(self, where: str) -> None:
        numbers: dict[str, Any] = {
            "scale": self.scale,
            "offset": self.offset,
            "counts_per_rev": self.counts_per_rev,
        }
        for name, value in numbers.items():
            number = isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)
            if value is not None and not (number and (value != 0.0 or name == "offset")):
                raise InvalidInput(where, f"{name} {value!r}", "a finite number other than 0", "Check it.")
        if self.sign not in (1, -1) or isinstance(self.sign, bool):
            raise InvalidInput(where, f"sign {self.sign!r}", "1 or -1", "Put the size into scale.")
        if not isinstance(self.column, str | int) or isinstance(self.column, bool):
            raise InvalidInput(
                where, f"column {self.column!r}", "a header name, a number or a path", "Check it."
            )
        if not isinstance(self.unit, str):
            raise InvalidInput(where, f"unit {self.unit!r}", 'text such as "rpm"', "Check it.")

    def disagreement(self, column: Column, where: str) -> Problem | None:
        """The warning that the file's own unit is another one than the stated one, which counts."""
        said, own = self.unit, column.unit
        if self.scale is not None or not (is_unit(said) and is_unit(own)):
            return None
        counts = self.counts_per_rev or 1.0
        if unit_factor(said, where, "", counts) == unit_factor(own, where, "", counts):
            return None
        return Problem(
            "warning", where, f"unit {said!r} for a column whose header says {own!r}", "one and the same unit",
            f"It is read as {said!r}. Leave the unit out if the header is right.",
        )  # fmt: skip

    def to_si(self, column: Column, signal: str, where: str) -> NDArray[np.float64]:
        """The column in SI; ``signal`` is the signal's name, or ``"time"``.

        Raises
        ------
        InvalidInput
            If the unit is unknown, or of a dimension that no scale turns into that of the signal.
        """
        dimension = "s" if signal == "time" else unit_of(signal)
        unit = self.unit or column.unit
        scale = 1.0 if self.scale is None else float(self.scale)
        if not unit:
            return self.sign * (scale * column.values + self.offset)
        factor, found = unit_factor(unit, where, dimension, self.counts_per_rev)
        if dimension in ("", found):
            return self.sign * factor * (scale * column.values + self.offset)
        if found in SCALABLE and self.scale is not None:
            return self.sign * (scale * factor * column.values + self.offset)
        raise InvalidInput(
            where,
            f"unit {unit!r}",
            f"a unit of {dimension}",
            f"Add scale in {dimension} per {found}, e.g. the torque constant."
            if found in SCALABLE
            else "Check the unit, the column and the signal's name.",
        )
