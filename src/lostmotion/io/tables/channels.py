"""Channel: which column a signal is taken from, and how its numbers become SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput, Problem
from ...plain_data import number, shown
from ...recording import unit_of
from ..spelling import suggestion
from .columns import Column
from .units import is_unit, unit_factor

#: Dimensions that a stated scale turns into that of the signal: a current into a torque by Nm/A, a share into
#: a torque by the rated one, a path into an angle by rad/m.
SCALABLE = ("A", "V", "N", "m", "m/s", "1")

#: Sizes that a scale, or counts per revolution, can have (option: counts of 64 bit and their inverse).
SMALLEST, LARGEST = 1e-20, 1e20


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
            spec._check(where)
            return spec
        if isinstance(spec, str | int) and not isinstance(spec, bool):
            return cls(spec)
        names = [f.name for f in fields(cls)]
        if not isinstance(spec, Mapping) or "column" not in spec:
            raise InvalidInput(
                where,
                shown(spec),
                "a column, or a table of " + ", ".join(names),
                "Give at least the column.",
            )
        for key in spec:
            if key not in names:
                raise InvalidInput(
                    where, f"unknown key {shown(key)}", "one of " + ", ".join(names), suggestion(key, names)
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
            if value is None:
                continue
            size = abs(number(f"{where}, {name}", value))
            if not SMALLEST <= size <= LARGEST and not (name == "offset" and size < LARGEST):
                raise InvalidInput(
                    f"{where}, {name}",
                    shown(value),
                    f"a size from {SMALLEST:g} to {LARGEST:g}",
                    "Check the power of ten.",
                )
        if self.sign not in (1, -1) or isinstance(self.sign, bool):
            raise InvalidInput(where, f"sign {shown(self.sign)}", "1 or -1", "Put the size into scale.")
        if not isinstance(self.column, str | int) or isinstance(self.column, bool):
            raise InvalidInput(
                where, f"column {shown(self.column)}", "a header name, a number or a path", "Check it."
            )
        if not isinstance(self.unit, str):
            raise InvalidInput(where, f"unit {shown(self.unit)}", 'text such as "rpm"', "Check it.")

    def disagreement(self, column: Column, where: str) -> Problem | None:
        """The error that the file's own unit is another one than the stated one; a scale says how both can be right."""
        said, own = self.unit, column.unit
        if self.scale is not None or not (is_unit(said) and is_unit(own)):
            return None
        counts = self.counts_per_rev or 1.0
        if unit_factor(said, where, "", counts) == unit_factor(own, where, "", counts):
            return None
        return Problem(
            "error", where, f"unit {said!r} for a column whose header says {own!r}", "one and the same unit",
            "Leave unit out if the header is right; if it is wrong, add scale = 1, which says that you know.",
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
        factor, found = unit_factor(unit, where, dimension, self.counts_per_rev) if unit else (1.0, dimension)
        with np.errstate(over="ignore", invalid="ignore"):  # sizes are checked with all else
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
