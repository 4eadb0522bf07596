"""Friction: the result of all its tests, and the torque signal that they use."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Friction
from ...errors import InvalidInput, Problem
from ...recording import Recording
from ..statistics.estimates import Estimates, Interval, Source
from . import problems as problem

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class FrictionFit(Estimates):
    """Friction of a drive that turns as one inertia::

        inertia·acceleration = torque − offset − coulomb·sgn(speed) − viscous·speed

    Values: ``inertia``, ``coulomb``, ``viscous`` and ``offset``; with ``_plus`` and ``_minus`` where the directions
    differ (the offset is then part of the Coulomb levels).

    Attributes
    ----------
    signal : str
        What was fitted: a speed or a torque.
    time, torque, measured, fitted : (m,) arrays
        s, Nm, and the signal's unit; NaN in ``fitted`` where the drive did not turn.
    relative_error : float
        ‖measured − fitted‖ / ‖measured‖ where there is a fit.
    """

    signal: str
    time: Floats
    torque: Floats
    measured: Floats
    fitted: Floats
    relative_error: float = field(default=float("nan"))

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
    """The torque signal asked for, or the best one in the recording: measured before commanded.

    Commanded is a signal whose name ends in ``_reference`` or whose origin is ``reference``; and
    ``torque_motor`` where there is a ``torque_motor_measured`` beside it.

    Returns
    -------
    (name, problems)
        A warning if a commanded torque is used although there is a measured one.
    """
    measured = [name for name in ("torque_motor_measured", "torque_motor") if not _commanded(recording, name)]
    if torque is None:
        torque = measured[0] if measured else "torque_motor"
        torque = torque if torque in recording else "torque_motor_reference"
    if not _commanded(recording, torque) or not measured:
        return torque, ()
    return torque, (problem.commanded_torque(torque, measured[0]),)


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


def reported(
    names: tuple[str, ...], values: Floats, margins: Floats, inertia: float | None, where: str
) -> tuple[dict[str, float | None], dict[str, Interval], dict[str, Source], tuple[Problem, ...]]:
    """Values, intervals and given sources of a fit; an inertia whose interval contains zero is not identified."""
    known: dict[str, float | None] = {} if inertia is None else {"inertia": inertia}
    intervals: dict[str, Interval] = {}
    sources: dict[str, Source] = {} if inertia is None else {"inertia": "nameplate"}
    problems = []
    for name, value, margin in zip(names, values.tolist(), margins.tolist(), strict=True):
        if name == "inertia" and not value - margin > 0.0:
            known[name] = None
            problems.append(problem.inertia_not_identified(where, value, margin))
            continue
        known[name] = value
        intervals[name] = (value - margin, value + margin)
    return known, intervals, sources, tuple(problems)
