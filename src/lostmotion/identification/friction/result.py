"""Friction: what every way of measuring it gives back, and which torque it is measured from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Friction
from ...errors import InvalidInput, Problem
from ...recording import Recording
from ..prediction_error.result import Source

Floats = NDArray[np.float64]
Interval = tuple[float, float]

FRICTION_UNITS = {
    "inertia": "kg m2",
    "coulomb": "Nm",
    "coulomb_plus": "Nm",
    "coulomb_minus": "Nm",
    "viscous": "Nm s/rad",
    "viscous_plus": "Nm s/rad",
    "viscous_minus": "Nm s/rad",
    "offset": "Nm",
}


@dataclass(frozen=True, eq=False)
class FrictionFit:
    """Friction of a drive that turns as one inertia::

        inertia·acceleration = torque − offset − coulomb·sgn(speed) − viscous·speed

    Attributes
    ----------
    values : mapping of name → float or None
        Names and units: ``FRICTION_UNITS``; with ``_plus`` and ``_minus`` where the directions differ (the
        offset is then part of the Coulomb levels). None where the recording does not tell the value.
    intervals : mapping of name → (low, high), 95 %
    sources : mapping of name → {"identified", "nameplate", "not excited"}
    problems : tuple of Problem
    signal : str
        What was fitted: a speed or a torque.
    time, torque, measured, fitted : (m,) arrays
        s, Nm, and the signal's unit; NaN in ``fitted`` where the drive did not turn.
    relative_error : float
        ‖measured − fitted‖ / ‖measured‖ where there is a fit.
    """

    values: Mapping[str, float | None]
    intervals: Mapping[str, Interval]
    sources: Mapping[str, Source]
    problems: tuple[Problem, ...]
    signal: str
    time: Floats
    torque: Floats
    measured: Floats
    fitted: Floats
    relative_error: float = field(default=float("nan"))

    def __post_init__(self) -> None:
        for name in ("values", "intervals", "sources"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    def levels(self) -> tuple[tuple[float, float], tuple[float, float], float]:
        """(Coulomb plus, minus), (viscous plus, minus), offset: Nm, Nm s/rad, Nm; 0 where unknown."""
        v = self.values
        coulomb = (
            float(v.get("coulomb_plus", v.get("coulomb")) or 0.0),
            float(v.get("coulomb_minus", v.get("coulomb")) or 0.0),
        )
        viscous = (
            float(v.get("viscous_plus", v.get("viscous")) or 0.0),
            float(v.get("viscous_minus", v.get("viscous")) or 0.0),
        )
        return coulomb, viscous, float(v.get("offset") or 0.0)

    def friction(self) -> Friction:
        """For a ``Drivetrain``: the offset goes into the Coulomb levels, the viscous coefficients into one mean.

        Raises
        ------
        InvalidInput
            If a Coulomb level comes out negative.
        """
        (plus, minus), viscous, offset = self.levels()
        return Friction((plus + offset, minus - offset), 0.5 * sum(viscous))


def torque_to_use(recording: Recording, torque: str | None) -> tuple[str, tuple[Problem, ...]]:
    """The torque signal asked for, or the best there is: measured before commanded.

    Commanded is a signal whose name ends in ``_reference`` or whose origin is ``reference``; and
    ``torque_motor`` where there is a ``torque_motor_measured`` beside it.

    Returns
    -------
    (name, problems)
        A warning where a commanded torque is used although a measured one is there.
    """
    measured = [name for name in ("torque_motor_measured", "torque_motor") if not _commanded(recording, name)]
    if torque is None:
        torque = measured[0] if measured else "torque_motor"
        torque = torque if torque in recording else "torque_motor_reference"
    if not _commanded(recording, torque) or not measured:
        return torque, ()
    return torque, (
        Problem(
            "warning",
            f"friction: {torque}",
            "a commanded torque",
            f"the measured one, {measured[0]}, which the recording holds",
            f'Leave the argument out, or give torque="{measured[0]}": losses and errors of the current '
            "controller would count as friction and inertia.",
        ),
    )


def _commanded(recording: Recording, name: str) -> bool:
    if name not in recording:
        return True
    if name.endswith("_reference") or recording.origin.get(name) == "reference":
        return True
    return name == "torque_motor" and "torque_motor_measured" in recording


def checked_inertia(inertia: float | None, where: str) -> float | None:
    if inertia is None or (np.isfinite(inertia) and inertia > 0.0):
        return inertia
    raise InvalidInput(f"{where}: inertia", repr(inertia), "a positive number in kg m2", "Check the unit.")


def told(
    names: tuple[str, ...], values: Floats, margins: Floats, inertia: float | None, where: str
) -> tuple[dict[str, float | None], dict[str, Interval], dict[str, Source], tuple[Problem, ...]]:
    """Values, intervals and sources of a fit; an inertia whose interval reaches zero is not told."""
    told_values: dict[str, float | None] = {} if inertia is None else {"inertia": inertia}
    intervals: dict[str, Interval] = {}
    sources: dict[str, Source] = {} if inertia is None else {"inertia": "nameplate"}
    problems = []
    for name, value, margin in zip(names, values.tolist(), margins.tolist(), strict=True):
        if name == "inertia" and not value - margin > 0.0:
            told_values[name], sources[name] = None, "not excited"
            problems.append(_inertia_not_told(where, value, margin))
            continue
        told_values[name], sources[name] = value, "identified"
        intervals[name] = (value - margin, value + margin)
    return told_values, intervals, sources, tuple(problems)


def _inertia_not_told(where: str, value: float, margin: float) -> Problem:
    return Problem(
        "warning",
        f"{where}: inertia",
        f"{value:.3g} ± {margin:.2g} kg m2 (95 %)",
        "an interval of positive inertia",
        "Record a motion that accelerates, or give the inertia; friction is then known all the same.",
    )
