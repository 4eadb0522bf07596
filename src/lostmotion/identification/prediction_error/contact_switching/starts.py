"""Parameter vectors of the contact-switching filter: from a drivetrain, and back to what is identified of one."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ..initial_values import DAMPING_RATIO
from ..innovations import NAMES as TOLD
from .filter import INDEX, ContactFilter
from .likelihood import Candidate
from .structures.rising_friction import friction_lines

Array = NDArray[np.float64]

#: Shares of the friction that start at the motor; rates of the unknown torques over the pole's and over the torque's
#: standard deviation, and share of an impact (numerics: so little that the rest of the model is looked at first).
AT_MOTOR, RATE, TORQUE_RATE, IMPACT = 0.3, 0.5, 1e-3, 0.01
#: Share of the friction that starts at the load at least, where the nameplate gives the motor's (numerics).
AT_LOAD = 0.1
#: What a start without nameplate value has: wind-up in a gap over that at the torque's deviation, a lag in samples
#: (numerics).
GAP, LAG = 0.5, 0.5

#: Step of differences in θ (numerics: far above rounding, far below any interval).
STEP = 1e-6
#: Part of a rigid drive's inertia that the model has as a load (numerics: far below what the motor's is known to).
LEFT = 1e-3


def starts(
    flt: ContactFilter, start: Drivetrain, fitted: Drivetrain, fixed: Collection[str]
) -> dict[str, Array]:
    """Parameter vectors from which descents start."""
    nameplate = flt.theta(start_values(flt, start, start, fixed))
    starts = {"fitted": flt.theta(start_values(flt, fitted, start, fixed)), "nameplate": nameplate}
    if "lag" not in fixed:
        starts["no lag"] = flt.changed(nameplate, lag=0.1 * flt.dt)
    return starts


def rigid_start(flt: ContactFilter, start: Drivetrain) -> tuple[Array, list[int]]:
    """One inertia, that of motor and load together, with friction and lag; and what of it is free."""
    given = start_values(flt, start, start, ())
    given |= {f"{name}_motor": given[name] for name in ("coulomb", "viscous")}
    # What is left of the load hangs on a critically damped spring beyond the recording's band: all is observable.
    own, load = 2.0 * np.pi / flt.dt, LEFT * start.inertia_total
    given |= dict.fromkeys(("backlash", "coulomb", "viscous", "torque_rate", "impact"), 0.0)
    given |= {"stiffness": own**2 * load, "damping": 2.0 * own * load}
    given |= {"inertia_motor": start.inertia_total, "inertia_load": load}
    names = (
        "inertia_motor",
        "coulomb_motor",
        "viscous_motor",
        "torque_offset",
        "lag",
        "delay",
    )
    return flt.theta(given), sorted(INDEX[name] for name in names)


def free_places(start: Drivetrain, fixed: Collection[str]) -> list[int]:
    """Places of what is fitted; friction of the motor stays where the nameplate gives it, or the load's is fixed."""
    kinds = {"lag": ["delay"]}
    if start.coulomb_motor == 0.0 and start.viscous_motor == 0.0:
        kinds |= {"coulomb": ["coulomb_motor"], "viscous": ["viscous_motor"]}
    names = [one for name in TOLD if name not in fixed for one in (name, *kinds.get(name, []))]
    return sorted(INDEX[name] for name in (*names, "torque_offset"))


def start_values(
    flt: ContactFilter, values: Drivetrain, start: Drivetrain, fixed: Collection[str]
) -> dict[str, float]:
    """Values of a start, with something for everything that is free."""
    pole = 2.0 * np.pi * values.pole_frequency
    given = {name: getattr(values, name) for name in TOLD}
    guesses = {
        "damping": 2.0 * DAMPING_RATIO * values.stiffness / pole,
        "backlash": GAP * flt.torque_deviation / values.stiffness,
        "lag": LAG * flt.dt,
    }
    given |= {
        n: max(guess, 0.0) for n, guess in guesses.items() if n not in fixed and not given[n] > 1e-3 * guess
    }
    return given | frictions(flt, start, fixed) | unknown(flt, pole)


def frictions(flt: ContactFilter, start: Drivetrain, fixed: Collection[str]) -> dict[str, float]:
    """Friction of either end: together what the slow motion tells, one unit of θ; where it is, is a guess."""
    held = start.coulomb_motor > 0.0 or start.viscous_motor > 0.0
    given: dict[str, float] = {}
    for name, whole in zip(("coulomb", "viscous"), flt.units[1:], strict=True):
        load, motor = float(getattr(start, name)), float(getattr(start, f"{name}_motor"))
        if name not in fixed:
            motor = motor if held else AT_MOTOR * whole
            load = max(whole - motor, AT_LOAD * whole)
        given |= {name: load, f"{name}_motor": motor}
    return given


def unknown(flt: ContactFilter, pole: float) -> dict[str, float]:
    """What a start takes for the rates of unknown torques and the share of an impact; ``pole`` in rad/s."""
    rate = RATE * pole
    torque_rate = TORQUE_RATE * flt.torque_deviation
    return {"motor_rate": rate, "load_rate": rate, "torque_rate": torque_rate, "impact": IMPACT}


def lag(candidate: Candidate) -> float:
    """Lag and delay together, s."""
    return max(_lag(candidate), 0.0)


def _lag(candidate: Candidate) -> float:
    """The same below zero as well: a measured torque may be ahead of that which acts."""
    values = candidate.values
    return values["lag"] + values["delay"]


def told_vector(candidate: Candidate) -> Array:
    """Parameter vector in the order of ``innovations.NAMES``."""
    theta = candidate.theta[[INDEX[name] for name in TOLD]]
    lines = friction_lines(candidate)
    with np.errstate(divide="ignore"):
        for name in ("coulomb", "viscous"):
            theta[TOLD.index(name)] = np.log(lines[name])
    theta[-1] = np.log(lag(candidate) + candidate.flt.dt)
    return theta


def told_slopes(candidate: Candidate) -> Array:
    """(8, m) derivatives of that vector by the free parameters; zero where it is not finite."""
    base, columns = told_vector(candidate), []
    for place in candidate.free:
        theta = candidate.theta.copy()
        theta[place] += STEP
        other = replace(candidate, theta=theta)
        with np.errstate(invalid="ignore"):
            columns.append((told_vector(other) - base) / STEP)
        # Its chance is that of the sum, also where that is below zero.
        columns[-1][-1] = (_lag(other) - _lag(candidate)) / STEP / (lag(candidate) + candidate.flt.dt)
    return np.nan_to_num(np.array(columns).T, nan=0.0, posinf=0.0, neginf=0.0)
