"""Motor angle over motor torque with the load locked: the gap, the wind-up on both flanks, and their fit."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import ESTIMATED, MEASURED, SET_POINT, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def backlash_locked(
    torque: ArrayLike,
    angle: ArrayLike,
    side: ArrayLike,
    fitted: Callable[[Any, float, float], Any] | None = None,
    *,
    backlash: float | None = None,
    interval: tuple[float, float] | None = None,
    source: str = "measured",
    axes: Axes | None = None,
) -> Figure:
    """Angle over torque; rows that the fit used stand out.

    Parameters
    ----------
    torque, angle, side : (n,) arrays
        Nm; rad from the middle of the gap; flank in contact (±1), 0 where the row was not used.
    fitted : callable, optional
        (torques, direction, side) → angles; of a ``LockedBacklash``, its method of that name.
    backlash, interval : rad, optional
        For the title and the lines at ±backlash/2.
    source : str
        What the angle is called in the legend: "simulated" if it is that, see ``source_of``.
    """
    rows_of_one_length("backlash_locked", torque=torque, angle=angle, side=side)
    figure, (axis,) = panels(axes, 1, size=(8.0, 5.4))
    m, theta, flank = (np.asarray(a, dtype=float) for a in (torque, angle, side))
    axis.plot(m, 1e3 * theta, color="#bbbbbb", linewidth=0.8, label=source)
    used = flank != 0.0
    axis.plot(m[used], 1e3 * theta[used], ".", color=MEASURED["color"], markersize=4, label="used")
    if fitted is not None and used.any():
        for sign in (1.0, -1.0):
            for way in (1.0, -1.0):
                line = np.array([0.0, sign * float(np.abs(m).max())])
                label = "fitted, rising and falling" if sign == way == 1.0 else None
                axis.plot(line, 1e3 * np.asarray(fitted(line, way, sign)), label=label, **ESTIMATED)
    title = "Locked load"
    if backlash is not None:
        for sign in (1.0, -1.0):
            axis.axhline(sign * 500.0 * backlash, **SET_POINT)
        title += f": backlash {1e3 * backlash:.4g} mrad"
        if interval is not None:
            title += f" ({1e3 * interval[0]:.4g} to {1e3 * interval[1]:.4g})"
    axis.set(xlabel="motor torque (Nm)", ylabel="motor angle from the middle of the gap (mrad)")
    axis.legend(frameon=False, loc="upper left")
    axis.set_title(title, fontweight="bold")
    return figure
