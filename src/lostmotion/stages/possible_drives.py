"""Drives that a user's may be as well: where a recording did not tell a value, the nameplate's is only near it."""

from __future__ import annotations

import math
from itertools import product

from ..drivetrain import Drivetrain
from .parameters import OFF, Found

#: Lag and delay of a drive of which neither is known, s (option: a current loop of 1 ms behind a fieldbus of 1 ms).
USUAL_LAG = 2e-3
#: Damping ratio of the torsional mode where no damping is known (option: less than drives with joints have; without
#: any, a mode that the delay turns the wrong way could not be kept stable by any gain).
LEAST_DAMPING = 0.005
#: A gap of which nothing is known, rad (numerics: that there is one counts, not how large it is).
SOME_BACKLASH = 1e-3
_SHAPE = ("inertia_motor", "inertia_load", "stiffness")
_FRICTION = ("coulomb", "coulomb_motor", "viscous", "viscous_motor")
#: What decides whether a speed loop is stable.
DECISIVE = (*_SHAPE, "lag", "backlash")


def not_told(found: Found) -> frozenset[str]:
    """Names of the values that the recording did not tell, so that they are the nameplate's, or none."""
    return frozenset(name for name, entry in found.table.items() if entry["source"] == "not excited")


def possible_drives(drivetrain: Drivetrain, unknown: frozenset[str]) -> tuple[Drivetrain, ...]:
    """The drivetrain, and the corners of what is not identified of it.

    Inertias and stiffness are a factor ``OFF`` off, either way, and the lag is longer. Where the backlash is not
    identified there is one: how large it is does not change what a small oscillation sees of it.
    """
    nearest = _nearest(drivetrain, unknown)
    if not unknown & set(DECISIVE):
        return (nearest,)
    names = [name for name in _SHAPE if name in unknown]
    longer = _longer_lag(drivetrain, unknown)
    corners = product((1.0 / OFF, OFF), repeat=len(names))
    off = (
        {name: factor * getattr(drivetrain, name) for name, factor in zip(names, corner, strict=True)}
        for corner in corners
    )
    return (nearest, *(nearest.with_parameters(**longer, **values) for values in off))


def simulated_drives(
    drivetrain: Drivetrain, unknown: frozenset[str], usual_torque: float
) -> dict[str, Drivetrain]:
    """Those of the possible drives that a default law is simulated on, by what they are.

    A load overshoots by too much inertia and stands still by too much friction; a law that compensates more friction
    than there is pushes the load on. A nameplate's friction is ``OFF`` times off as well, but not above the torque
    under which the drive turned half of the time: ``usual_torque``, Nm. As much it may have where none is given.
    """
    nearest = _nearest(drivetrain, unknown)
    drives = {"its own model": nearest}
    inertias = [name for name in _SHAPE[:2] if name in unknown]
    for factor, what in ((OFF, "larger"), (1.0 / OFF, "smaller")) if inertias else ():
        values = {name: factor * getattr(drivetrain, name) for name in inertias}
        drives[f"inertias {OFF:g} times {what}"] = nearest.with_parameters(
            **_longer_lag(drivetrain, unknown), **values
        )
    coulomb = drivetrain.coulomb + drivetrain.coulomb_motor
    if "coulomb" in unknown and not coulomb > 0.0:
        drives["a friction as large as the recorded torque"] = nearest.with_parameters(coulomb=usual_torque)
    elif "coulomb" in unknown:
        factors = {"a smaller friction": 1.0 / OFF}
        if usual_torque > coulomb:
            factors["a larger friction"] = min(OFF, usual_torque / coulomb)
        for what, factor in factors.items():
            friction = {name: factor * getattr(drivetrain, name) for name in _FRICTION}
            drives[what] = nearest.with_parameters(**friction)
    return drives


def _nearest(drivetrain: Drivetrain, unknown: frozenset[str]) -> Drivetrain:
    """The drivetrain with the least damping, and with a gap, where it has none because none is given."""
    least = {}
    if "damping" in unknown and not drivetrain.damping > 0.0:
        least["damping"] = LEAST_DAMPING * drivetrain.stiffness / (math.pi * drivetrain.pole_frequency)
    if "backlash" in unknown and not drivetrain.backlash > 0.0:
        least["backlash"] = SOME_BACKLASH
    return drivetrain.with_parameters(**least)


def _longer_lag(drivetrain: Drivetrain, unknown: frozenset[str]) -> dict[str, float]:
    return {"lag": max(OFF * drivetrain.lag, USUAL_LAG)} if "lag" in unknown else {}
