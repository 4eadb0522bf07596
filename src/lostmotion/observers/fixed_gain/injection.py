"""Injection: the gap curve of an observer sees, beside the estimated twist, what the sensors say of it.

::

    gap = clip(z + Σ κ·(measured − expected), ±backlash/2)

The expected shaft torque hangs on the gap itself, expected = k·(z − gap) (and d·rate with the contact law
``dead_zone``). Solved for the gap, with κ_T that of the shaft torque::

    gap = clip(z + (κ_T·(torque_shaft − d·rate) + Σ κ·(measured − expected of the others))/(1 − κ_T·k), ±backlash/2)

Without noise and with the right parameters nothing changes once the error is zero. Arcak & Kokotović 2001,
Automatica 37, 1923-1930 (circle criterion).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from ..arguments import mapping, positive
from ..model import ObserverModel

Array = NDArray[np.float64]


class Injection(NamedTuple):
    """What is added to the gap curve's argument: rows over states (n,) and measured signals (n_measured,)."""

    states: Array
    measured: Array


def injection_of(
    model: ObserverModel, measured: tuple[str, ...], c: Array, given: Mapping[str, float] | None
) -> Injection | None:
    """The injection for κ of measured signals (rad per unit of the signal); None without any, and without a gap.

    ``c`` (n_measured, n) are the measurement rows with the gap closed. Raises ``InvalidInput`` for a signal that is not
    measured, and for κ of the shaft torque of 1/stiffness or more: the gap would have no single value.
    """
    factors = {
        name: positive(f"injection[{name!r}]", value, zero=True)
        for name, value in mapping("injection", given).items()
    }
    if not set(factors) <= set(measured):
        raise InvalidInput("injection", f"{given}", f"κ of signals out of {measured}", "Check the names.")
    shaft = model.drivetrain.shaft
    left = 1.0 - factors.get("torque_shaft", 0.0) * shaft.stiffness
    if not left > 0.0:
        raise InvalidInput(
            "injection['torque_shaft']", f"{factors['torque_shaft']} rad/Nm",
            f"less than 1/stiffness = {1.0 / shaft.stiffness:.3g} rad/Nm", "Lower it.",
        )  # fmt: skip
    if not shaft.has_backlash or not any(factors.values()):
        return None
    expected = c.copy()
    if "torque_shaft" in measured:
        damping = shaft.damping if shaft.contact == "dead_zone" else 0.0
        row = expected[measured.index("torque_shaft")]
        row[:] = 0.0
        row[: len(model.states)] = model.row(speed_motor=damping, speed_load=-damping)
    weights = np.array([factors.get(name, 0.0) for name in measured]) / left
    return Injection(-weights @ expected, weights)
