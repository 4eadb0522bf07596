"""A drivetrain as the numbers that the kernels of its modes read, see ``kernels.plant.equations.Chain``."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain, Shaft
from .contact_states import Element, Layout, relaxes

if TYPE_CHECKING:
    from ..kernels.plant.equations import Chain


@lru_cache(maxsize=1)
def chain_of(layout: Layout, parts: tuple[Element, ...]) -> Chain:
    """What all variants of a drivetrain share that differ in their numbers only.

    The last one is kept, since simulations come in series.
    """
    from ..kernels.plant.equations import Chain
    from ..kernels.plant.layout import BRANCH, FRICTION, SHAFT

    drivetrain, n = layout.drivetrain, layout.n
    number = {(e.kind, e.index): j for j, e in enumerate(parts)}
    kinds = {"shaft": SHAFT, "friction": FRICTION}
    shafts = [
        [
            _law(shaft),
            layout.shaft_angle(i) if relaxes(shaft) else -1,
            *(number.get((kind, i), -1) for kind in ("shaft", "sum", "difference")),
        ]
        for i, shaft in enumerate(drivetrain.shafts)
    ]
    points = [0, *np.cumsum([len(friction.stribeck) for friction in drivetrain.frictions])]
    return Chain(
        shafts=np.array(shafts, dtype=np.int64).reshape(-1, 5),
        inertias=np.array(
            [[number.get(("friction", i), -1), point] for i, point in enumerate(points)], dtype=np.int64
        ),
        elements=np.array(
            [[kinds.get(e.kind, BRANCH), e.index, e.rest] for e in parts], dtype=np.int64
        ).reshape(-1, 3),
        targets=np.array(
            [_target(name, n, drivetrain.locked_inertia) for name in layout.inputs], dtype=np.int64
        ),
        states=layout.states,
        actuator=-1 if layout.actuator is None else layout.actuator,
        locked=-1 if drivetrain.locked_inertia is None else drivetrain.locked_inertia,
    )


def numbers_of(drivetrain: Drivetrain, dt: float) -> NDArray[np.float64]:
    """(P,) the drivetrain's numbers, in the order that ``Chain`` tells."""
    numbers = [dt, drivetrain.actuator.lag, *drivetrain.inertias]
    for shaft in drivetrain.shafts:
        numbers += (shaft.stiffness, shaft.damping, 0.5 * shaft.backlash)
    for friction in drivetrain.frictions:
        plus, minus = friction.level_at_rest
        if friction.breakaway is not None:
            plus = minus = friction.breakaway
        numbers += (friction.viscous, friction.coulomb_plus, friction.coulomb_minus, plus, minus)
    for friction in drivetrain.frictions:
        for point in friction.stribeck:
            numbers += point
    return np.array(numbers)


def _law(shaft: Shaft) -> int:
    from ..kernels.plant import equations

    if not shaft.has_backlash:
        return equations.LINEAR
    if shaft.contact == "physical" and not relaxes(shaft):
        return equations.VISCOELASTIC
    return int(getattr(equations, shaft.contact.upper()))


def _target(name: str, n: int, locked: int | None) -> int:
    """Inertia on which an input's torque acts; −1 − i where it is the acceleration of inertia i."""
    if name.startswith("acceleration_"):
        return -1 - (locked or 0)
    named = {"torque_motor": 0, "torque_load": n - 1}
    return named[name] if name in named else int(name.removeprefix("torque_")) - 1
