"""Estimates: the one form of all results of an identification."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Literal

from ...display import parameters, tables
from ...drivetrain import PARAMETER_UNITS
from ...errors import Problem

Source = Literal["identified", "nameplate", "not excited"]
Interval = tuple[float, float]

#: Unit of every value that an identification can find; a name has the same unit in all of them.
UNITS: Mapping[str, str] = MappingProxyType(
    {
        **PARAMETER_UNITS,
        "inertia": "kg m2",
        "inertia_total": "kg m2",
        "inertia_between": "kg m2",
        "coulomb_plus": "Nm",
        "coulomb_minus": "Nm",
        "viscous_plus": "Nm s/rad",
        "viscous_minus": "Nm s/rad",
        "offset": "Nm",
        "stribeck": "Nm",
        "stribeck_speed": "rad/s",
        "breakaway_plus": "Nm",
        "breakaway_minus": "Nm",
        "compliance": "rad/Nm",
        "hysteresis": "rad",
        "delay": "s",
        "torque_delay": "s",
        "zero": "Hz",
        "pole": "Hz",
        "frequency": "Hz",
        "damping_ratio": "1",
    }
)


def sources_of(values: Mapping[str, float | None]) -> dict[str, Source]:
    """Sources where nothing was given: a value means identified."""
    return {name: "not excited" if value is None else "identified" for name, value in values.items()}


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class Estimates:
    """Values by name, how well each is known, and where it comes from. Base of every result of an identification.

    Parameters
    ----------
    values : mapping of name → float or None
        SI; None if not identified.
    intervals : mapping of name → (low, high)
        95 % intervals of what was identified.
    sources : mapping of name → {"identified", "nameplate", "not excited"}
        For each of the values: found, given by the user, or not identifiable from the recording. By default a number
        is identified and None is not excited; only what differs need be given.
    problems : tuple of Problem
        Warnings, each with a remedy.
    """

    values: Mapping[str, float | None]
    intervals: Mapping[str, Interval]
    sources: Mapping[str, Source] = field(default_factory=dict)
    problems: tuple[Problem, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "sources", sources_of(self.values) | dict(self.sources))
        for name in ("values", "intervals", "sources"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))
        object.__setattr__(self, "problems", tuple(self.problems))

    @property
    def units(self) -> Mapping[str, str]:
        """Unit of each of the values."""
        return MappingProxyType({name: UNITS[name] for name in self.values})

    def table(self) -> dict[str, dict[str, Any]]:
        """Name → {"value", "low", "high", "unit", "source"}, as in ``results.json``; None where there is none."""
        made = {}
        for name, value in self.values.items():
            low, high = self.intervals.get(name, (None, None))
            made[name] = {
                "value": value,
                "low": low,
                "high": high,
                "unit": UNITS[name],
                "source": self.sources[name],
            }
        return made

    def as_dict(self) -> dict[str, Any]:
        """Numbers, texts and lists, for JSON."""
        return {
            "values": dict(self.values),
            "intervals": {name: list(interval) for name, interval in self.intervals.items()},
            "sources": dict(self.sources),
            "units": dict(self.units),
            "problems": [problem.as_dict() for problem in self.problems],
        }

    def summary(self) -> str:
        """A line for each value with unit, 95 % interval and source, and all problems: for a person to read."""
        problems = (f"  {problem.severity}: {problem}" for problem in self.problems)
        remarks = (f"  {title}: {text}" for title, text in self.remarks().items())
        return "\n".join([self._title(), parameters.text(self.table()), *remarks, *problems])

    def remarks(self) -> dict[str, str]:
        """What else a person should know about the result, by title."""
        return {}

    def __repr__(self) -> str:
        return f"{self._title()}\n{tables.listing(parameters.short(self.table()))}"

    def _repr_html_(self) -> str:
        remarks = [f"{title}: {text}" for title, text in self.remarks().items()]
        remarks += [f"{problem.severity}: {problem}" for problem in self.problems]
        return tables.html(self._title(), parameters.HEADER, parameters.rows(self.table()), remarks)

    def _title(self) -> str:
        identified = sum(source == "identified" for source in self.sources.values())
        count = len(self.problems)
        problems = "no problems" if not count else "1 problem" if count == 1 else f"{count} problems"
        return f"{type(self).__name__}: {identified} of {len(self.values)} identified, {problems}"
