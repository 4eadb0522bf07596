"""A drivetrain as a table for a notebook: each inertia with its friction, each shaft between them, the actuator."""

from __future__ import annotations

import math
from collections.abc import Sequence

from ..display.numbers import given
from ..display.tables import html
from .actuator import Actuator
from .friction import Friction
from .shaft import Shaft


def html_table(
    title: str,
    inertias: Sequence[float],
    shafts: Sequence[Shaft],
    frictions: Sequence[Friction],
    actuator: Actuator,
    locked: int | None,
) -> str:
    """``locked``: index of the inertia that is held."""
    rows = []
    ends = {0: " (motor)", len(inertias) - 1: " (load)"} if len(inertias) > 1 else {}
    for i, (inertia, friction) in enumerate(zip(inertias, frictions, strict=True)):
        more = [*(["held"] if i == locked else []), *_friction(friction)]
        rows.append((f"inertia {i + 1}{ends.get(i, '')}", given(inertia, "kg m2"), ", ".join(more)))
        if i < len(shafts):
            rows.append(
                (f"shaft {i + 1}", given(shafts[i].stiffness, "Nm/rad"), ", ".join(_shaft(shafts[i])))
            )
    if more := _actuator(actuator):
        rows.append(("actuator", "", ", ".join(more)))
    return html(title, (), rows)


def _friction(friction: Friction) -> list[str]:
    plus, minus = (given(level, "Nm") for level in (friction.coulomb_plus, friction.coulomb_minus))
    shown = []
    if friction.coulomb_plus or friction.coulomb_minus:
        shown.append(f"coulomb {plus}" if plus == minus else f"coulomb {plus} forwards, {minus} backwards")
    if friction.viscous:
        shown.append(f"viscous {given(friction.viscous, 'Nm s/rad')}")
    if friction.breakaway is not None:
        shown.append(f"breakaway {given(friction.breakaway, 'Nm')}")
    if friction.stribeck:
        shown.append(f"Stribeck {given(friction.stribeck[0][1], 'Nm')}")
    return shown


def _shaft(shaft: Shaft) -> list[str]:
    gap = [f"backlash {given(shaft.backlash, 'rad')}", shaft.contact] if shaft.has_backlash else []
    return [f"damping {given(shaft.damping, 'Nm s/rad')}", *gap]


def _actuator(actuator: Actuator) -> list[str]:
    shown = [f"lag {given(actuator.lag, 's')}"] if actuator.lag else []
    if math.isfinite(actuator.torque_limit):
        shown.append(f"torque limit {given(actuator.torque_limit, 'Nm')}")
    if math.isfinite(actuator.rate_limit):
        shown.append(f"rate limit {given(actuator.rate_limit, 'Nm/s')}")
    return shown
