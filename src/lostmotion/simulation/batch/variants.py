"""Variants of a drivetrain: what scatter of its numbers does, for a batch."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain, Friction, Shaft
from ...errors import InvalidInput


@checks_arguments
def variants(drivetrain: Drivetrain, count: int, *, spread: float = 0.2, seed: int = 1) -> list[Drivetrain]:
    """`count` copies of a drivetrain, each number times a factor of its own between 1 − spread and 1 + spread.

    Inertias, stiffness, damping and backlash of each shaft, viscous friction, and the actuator's lag are drawn evenly;
    the torques of one friction (Coulomb, breakaway, Stribeck) share a factor. Limits and speeds stay. Variant i is the
    same for any count.

    Raises
    ------
    InvalidInput
        If the spread is not in [0, 1), or no variant is asked for.
    """
    if not (math.isfinite(spread) and 0.0 <= spread < 1.0):
        raise InvalidInput(
            "variants.spread", repr(spread), "a number from 0 to below 1", "Give 0.2 for 20 %."
        )
    if count < 1:
        raise InvalidInput("variants.count", repr(count), "one or more", "Give a number of variants.")
    rng = np.random.default_rng(seed)

    def factor() -> float:
        return float(rng.uniform(1.0 - spread, 1.0 + spread))

    def shaft(s: Shaft) -> Shaft:
        return replace(
            s, stiffness=s.stiffness * factor(), damping=s.damping * factor(), backlash=s.backlash * factor()
        )

    def friction(f: Friction) -> Friction:
        level = factor()
        return Friction(
            coulomb=(f.coulomb_plus * level, f.coulomb_minus * level),
            viscous=f.viscous * factor(),
            breakaway=None if f.breakaway is None else f.breakaway * level,
            stribeck=tuple((speed, torque * level) for speed, torque in f.stribeck),
        )

    return [
        replace(
            drivetrain,
            inertias=tuple(inertia * factor() for inertia in drivetrain.inertias),
            shafts=tuple(shaft(s) for s in drivetrain.shafts),
            frictions=tuple(friction(f) for f in drivetrain.frictions),
            actuator=replace(drivetrain.actuator, lag=drivetrain.actuator.lag * factor()),
        )
        for _ in range(count)
    ]
