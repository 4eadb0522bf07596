"""Friction torque over speed: plateaus of constant speed with their intervals, and the fitted Stribeck curve."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import ESTIMATED, panels, symlog

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def friction_curve(
    speed: ArrayLike,
    torque: ArrayLike,
    margin: ArrayLike,
    steady: ArrayLike,
    curve: Callable[[Any], Any],
    *,
    axes: Axes | None = None,
) -> Figure:
    """Plateaus and curve; the speed's axis is linear near zero and logarithmic beyond.

    Parameters
    ----------
    speed, torque, margin : (m,) arrays, rad/s and Nm
        Mean of each plateau, and half its torque's interval.
    steady : (m,) bool array
        The plateaus that were used; the others are drawn open.
    curve : callable
        Speeds (rad/s) → torques (Nm); of a ``FrictionLadder``, its method of that name.
    """
    rows_of_one_length("friction_curve", speed=speed, torque=torque, margin=margin, steady=steady)
    figure, (axis,) = panels(axes, 1, size=(8.0, 5.0))
    w, m, e = (np.asarray(a, dtype=float) for a in (speed, torque, margin))
    used = np.asarray(steady, dtype=bool)
    for rows, face, label in (
        (used, "#E69F00", "plateaus, 95 %"),
        (~used, "none", "slips and sticks: not used"),
    ):
        if rows.any():
            style: dict[str, Any] = {"fmt": "o", "color": "#E69F00", "markerfacecolor": face, "capsize": 3}
            axis.errorbar(w[rows], m[rows], e[rows], label=label, **style)
    near = float(np.abs(w[used]).min()) if used.any() else 1.0
    far = float(np.abs(w).max())
    for sign in (1.0, -1.0):
        if (sign * w > 0.0).any():
            line = sign * np.geomspace(0.02 * near, far, 400)
            axis.plot(line, curve(line), label="fitted" if sign > 0.0 else None, **ESTIMATED)
    symlog(axis, max(near, 1e-12), "speed", "rad/s")
    axis.set_ylabel("friction torque (Nm)")
    axis.legend(frameon=False)
    axis.set_title("Friction over speed", fontweight="bold")
    return figure
