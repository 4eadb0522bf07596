"""Parameter vectors of the contact-switching filter from a drivetrain, with something for all that it does not say."""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from .....drivetrain import Drivetrain
from ...initial_values import DAMPING_RATIO
from ...innovations import NAMES as TOLD
from ..filter import ContactFilter
from ..parameter_vector import INDEX
from .frequency_response import linear_drive

Array = NDArray[np.float64]

#: Shares of the friction that start at the motor; rates of the unknown torques over the pole's and over the torque's
#: standard deviation, and share of an impact (numerics: so little that the rest of the model is looked at first).
AT_MOTOR, RATE, TORQUE_RATE, IMPACT = 0.3, 0.5, 1e-3, 0.01
#: Share of the friction that starts at the load at least, where the nameplate gives the motor's (numerics).
AT_LOAD = 0.1
#: What a start without nameplate value has: wind-up in a gap over that at the torque's deviation, a lag in samples
#: (numerics).
GAP, LAG = 0.5, 0.5

#: Lag and delay together at most (s), and a lag at least in samples (numerics: the bounds of the search, and a lag that
#: descents can move).
LONGEST_LAG, LEAST_LAG = 0.02, 0.05
#: Name of the start whose lag and delay are those of the frequency response.
RESPONSE = "frequency response"
#: Part of a rigid drive's inertia that the model has as a load (numerics: far below what the motor's is known to).
LEFT = 1e-3


def starts(
    flt: ContactFilter, start: Drivetrain, fitted: Drivetrain, fixed: Collection[str]
) -> dict[str, Array]:
    """Parameter vectors from which descents start."""
    values = {"fitted": fitted, "nameplate": start}
    return {name: flt.theta(start_values(flt, one, start, fixed)) for name, one in values.items()}


def response_start(flt: ContactFilter, start: Drivetrain, fixed: Collection[str]) -> Array:
    """The nameplate with what the frequency response shows instead; takes some 0.1 s."""
    shown, values = linear_drive(flt, start), start_values(flt, start, start, fixed)
    values |= {name: shown[name] for name in shown if name not in fixed and name != "delay"}
    if "lag" not in fixed and "delay" in shown:
        values |= lag_and_delay(shown["delay"], flt.dt)
    return flt.theta(values)


def lag_and_delay(both: float, dt: float) -> dict[str, float]:
    """Lag and delay (s) from their sum: half of it each, and no lag where a measured torque is ahead."""
    both = float(np.clip(both, (LEAST_LAG - 1.0) * dt, LONGEST_LAG))
    lag = max(0.5 * both, LEAST_LAG * dt)
    return {"lag": lag, "delay": both - lag}


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
        "damping": usual_damping(values.stiffness, pole),
        "backlash": GAP * flt.torque_deviation / values.stiffness,
        "lag": LAG * flt.dt,
    }
    given |= {
        n: max(guess, 0.0) for n, guess in guesses.items() if n not in fixed and not given[n] > 1e-3 * guess
    }
    return given | frictions(flt, start, fixed) | unknown(flt, pole)


def usual_damping(stiffness: float, omega: float) -> float:
    """Damping (Nm s/rad) of a usual ratio at this torsional frequency (rad/s)."""
    return 2.0 * DAMPING_RATIO * stiffness / omega


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
