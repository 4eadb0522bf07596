"""A finer plant around a two-mass model, perturbed within its intervals: for trying a law without a rig."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..drivetrain import Drivetrain, Friction
from .equivalent import eigenfrequencies
from .nominal import COULOMB, INERTIAS, STIFFNESSES, STRIBECK, Rig, make_rig

#: Where a parameter has no interval, it is varied by this much (option).
UNKNOWN_SPREAD = 0.1


def finer_rig(model: Drivetrain, intervals: Mapping[str, tuple[float, float]], seed: int) -> Rig:
    """A rig of four inertias whose two-mass equivalent lies within the intervals of a model.

    The motor's inertia and the compliance are divided as in the virtual rig; contact law, Stribeck rise and sensors
    are the virtual rig's. Every parameter is drawn uniformly within its interval (low, high), or within ±10 % of its
    value where it has none.
    """
    rng = np.random.default_rng([seed, 30])
    drawn = {}
    for name, value in model.parameters().items():
        low, high = intervals.get(name, ((1.0 - UNKNOWN_SPREAD) * value, (1.0 + UNKNOWN_SPREAD) * value))
        drawn[name] = float(rng.uniform(low, high))
    motor_side = sum(INERTIAS[:3])
    inertias = (*(j / motor_side * drawn["inertia_motor"] for j in INERTIAS[:3]), drawn["inertia_load"])
    rig = make_rig(inertias, STIFFNESSES, drawn["backlash"], drawn["coulomb"], drawn["viscous"], seed=seed)
    # One factor on all stiffnesses sets the first eigenfrequency to that of the drawn two-mass drivetrain.
    wanted = model.with_parameters(**{n: drawn[n] for n in ("inertia_motor", "inertia_load", "stiffness")})
    factor = (wanted.pole_frequency / float(eigenfrequencies(rig.drivetrain)[1])) ** 2
    ratio = drawn["damping"] / model.damping if model.damping > 0.0 else 0.0
    shafts = tuple(
        replace(s, stiffness=factor * s.stiffness, damping=_damping(i, model, ratio, factor, s.damping))
        for i, s in enumerate(rig.drivetrain.shafts)
    )
    motor = Friction(drawn["coulomb_motor"], drawn["viscous_motor"])
    disc = Friction(
        drawn["coulomb"],
        drawn["viscous"],
        stribeck=tuple((s, t * drawn["coulomb"] / COULOMB) for s, t in STRIBECK),
    )
    actuator = replace(rig.drivetrain.actuator, lag=drawn["lag"], torque_limit=model.actuator.torque_limit)
    chain = Drivetrain(inertias, shafts, (motor, Friction(), Friction(), disc), actuator)
    return replace(rig, drivetrain=chain)


def _damping(shaft: int, model: Drivetrain, ratio: float, factor: float, usual: float) -> float:
    """The side shaft (1) has the model's damping; clutch and joint keep their own decay rates."""
    if shaft == 1:
        return model.damping * ratio * (STIFFNESSES[1] * factor / model.stiffness)
    return factor * usual
