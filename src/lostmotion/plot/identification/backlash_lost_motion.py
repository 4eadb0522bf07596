"""Twist between two encoders over torque, its delay taken off, by direction of motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import ESTIMATED, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def backlash_lost_motion(
    torque: ArrayLike,
    twist: ArrayLike,
    fitted: ArrayLike,
    direction: ArrayLike,
    *,
    title: str = "Lost motion",
    axes: Axes | None = None,
) -> Figure:
    """Twist (mrad) over torque (Nm), one colour for each direction of motion, with the fit on top.

    Parameters
    ----------
    torque, twist, fitted, direction : (n,) arrays
        Nm; rad; rad with NaN where there is no fit; ±1 or 0. Of a ``LostMotion``, these are its arrays.
    """
    rows_of_one_length("backlash_lost_motion", torque=torque, twist=twist, fitted=fitted, direction=direction)
    figure, (axis,) = panels(axes, 1, size=(8.0, 5.4))
    m, d, f, way = (np.asarray(a, dtype=float) for a in (torque, twist, fitted, direction))
    for sign, colour, label in ((1.0, "#E69F00", "forwards"), (-1.0, "#009E73", "backwards")):
        rows = way == sign
        axis.plot(m[rows], 1e3 * d[rows], ".", color=colour, markersize=2, label=label)
    for sign in (1.0, -1.0):
        rows = np.flatnonzero((way == sign) & np.isfinite(f))
        rows = rows[np.argsort(m[rows])]
        axis.plot(m[rows], 1e3 * f[rows], label="fitted" if sign > 0.0 else None, **ESTIMATED)
    axis.set(xlabel="torque (Nm)", ylabel="twist, delay taken off (mrad)")
    axis.legend(frameon=False)
    axis.set_title(title, fontweight="bold")
    return figure
