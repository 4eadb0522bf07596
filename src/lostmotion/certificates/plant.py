"""The drivetrain between two samples: a linear flow with static curves, in exact fractions."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .rational import Matrix, rational, zeros
from .static_curves import StaticCurve


@dataclass(frozen=True, eq=False, kw_only=True)
class Plant:
    """A two-mass drivetrain as a flow with curves; states twist, speed_motor, speed_load (torque_actuator).

    Parameters
    ----------
    states : tuple of str
    A : (n, n) array, B : (n, 1) array of the torque set-point, L : (n, 1) array of the load torque
    E : (n, m) array
        Of the curves' values.
    Z : (m, n) array
        Of the curves' arguments.
    curves : tuple of StaticCurve
        Gap, then friction of motor and load, where they are.
    names : tuple of str
        Of the curves.
    measured : mapping of signal → row (n + m,) over states and curve values
    """

    states: tuple[str, ...]
    A: Matrix
    B: Matrix
    L: Matrix
    E: Matrix
    Z: Matrix
    curves: tuple[StaticCurve, ...]
    names: tuple[str, ...]
    measured: Mapping[str, Matrix]


def plant_of(drivetrain: Drivetrain, stribeck: bool = False) -> Plant:
    """The drivetrain between samples (docs/proofs.md, equation 1); raises ``InvalidInput`` where it has no such
    form.

    With ``stribeck``, Stribeck friction is part of the curves, which then fall, and a breakaway level is left out.
    """
    _check_drivetrain(drivetrain, stribeck)
    states = ("twist", "speed_motor", "speed_load", *(("torque_actuator",) if drivetrain.lag else ()))
    j = [Fraction(inertia) for inertia in drivetrain.inertias]
    curves = [*_gap(drivetrain), *_frictions(drivetrain)]
    n, p = len(states), len(curves)
    k, d = Fraction(drivetrain.stiffness), Fraction(drivetrain.damping)
    shaft_torque = rational([k, d, -d, *[0] * (n - 3)])
    a, b, load = zeros(n, n), zeros(n, 1), zeros(n, 1)
    a[0, 1], a[0, 2] = Fraction(1), Fraction(-1)
    a[1] -= shaft_torque / j[0]
    a[2] += shaft_torque / j[1]
    for i, friction in enumerate(drivetrain.frictions):
        a[1 + i, 1 + i] -= Fraction(friction.viscous) / j[i]
    load[2, 0] = 1 / j[1]
    if drivetrain.lag:
        lag = Fraction(drivetrain.lag)
        a[1, 3], a[3, 3], b[3, 0] = 1 / j[0], -1 / lag, 1 / lag
    else:
        b[1, 0] = 1 / j[0]
    e, z = zeros(n, p), zeros(p, n)
    for i, curve in enumerate(curves):
        e[1, i], e[2, i] = curve.torques[0] / j[0], curve.torques[1] / j[1]
        z[i, :3] = curve.argument
    measured = {
        name: rational([*(int(s == name) for s in states), *[0] * p])
        for name in ("speed_motor", "speed_load", "twist")
    }
    without_gap = [-c.torques[0] if c.name == "gap" else 0 for c in curves]
    measured["torque_shaft"] = rational([*shaft_torque, *without_gap])
    return Plant(
        states=states, A=a, B=b, L=load, E=e, Z=z, measured=measured,
        curves=tuple(c.curve for c in curves), names=tuple(c.name for c in curves),
    )  # fmt: skip


class _PlantCurve(NamedTuple):
    """A curve of height 1, the torques on motor and load at its value 1, and its argument over the first states."""

    name: str
    curve: StaticCurve
    torques: tuple[Fraction, Fraction]
    argument: Matrix


def _gap(drivetrain: Drivetrain) -> list[_PlantCurve]:
    """k·dz(z) = k·z − k·backlash·σ(z): what the gap takes off the torque of the closed shaft."""
    shaft = drivetrain.shaft
    if not shaft.has_backlash:
        return []
    k, half = Fraction(shaft.stiffness), Fraction(shaft.backlash) / 2
    lead = Fraction(shaft.damping) / k if shaft.contact == "viscoelastic" else Fraction(0)
    curve = StaticCurve(((-half, Fraction(-1, 2)), (half, Fraction(1, 2))))
    return [_PlantCurve("gap", curve, (2 * half * k, -2 * half * k), rational([1, lead, -lead]))]


def _frictions(drivetrain: Drivetrain) -> list[_PlantCurve]:
    """Coulomb friction of motor and load: a jump at rest, where it takes every value between."""
    found = []
    for i, friction in enumerate(drivetrain.frictions):
        plus, minus = Fraction(friction.coulomb_plus), Fraction(friction.coulomb_minus)
        extra = [(Fraction(speed), Fraction(torque)) for speed, torque in friction.stribeck]
        zero = Fraction(0)
        above = [(speed, plus + torque) for speed, torque in extra or [(zero, zero)]]
        below = [(-speed, -minus - torque) for speed, torque in reversed(extra or [(zero, zero)])]
        height = above[0][1] - below[-1][1]
        if height:
            curve = StaticCurve(tuple((speed, torque / height) for speed, torque in (*below, *above)))
            torques = (-height, zero) if i == 0 else (zero, -height)
            name = ("friction of the motor", "friction of the load")[i]
            found.append(_PlantCurve(name, curve, torques, rational([0, int(i == 0), int(i == 1)])))
    return found


def _check_drivetrain(drivetrain: Drivetrain, stribeck: bool) -> None:
    """Raise where the Lur'e form is not this drivetrain's."""
    friction = drivetrain.frictions
    actuator = drivetrain.actuator
    wrong = [
        (
            len(drivetrain.inertias) != 2,
            f"{len(drivetrain.inertias)} inertias",
            "Reduce it to two masses first.",
        ),
        (drivetrain.locked is not None, "a held end", "Free it."),
        (
            any(s.has_backlash and s.contact not in ("viscoelastic", "dead_zone") for s in drivetrain.shafts),
            f"contact law {', '.join(s.contact for s in drivetrain.shafts)}",
            "Take contact = 'viscoelastic', the law of the observers.",
        ),
        (
            not stribeck and any(f.stribeck for f in friction),
            "Stribeck friction",
            "The loop may stick and slip: simulate it.",
        ),
        (
            not stribeck
            and any(f.breakaway is not None and f.breakaway > max(f.level_at_rest) for f in friction),
            "a breakaway level above Coulomb friction",
            "The loop may stick and slip: simulate it.",
        ),
        (np.isfinite(actuator.rate_limit), "a rate limit of the torque", "Leave it out where it never acts."),
    ]
    for found, got, remedy in wrong:
        if found:
            raise InvalidInput(
                "certify: drivetrain", got,
                "two free masses, contact viscoelastic or dead_zone, viscous and Coulomb friction", remedy,
            )  # fmt: skip
