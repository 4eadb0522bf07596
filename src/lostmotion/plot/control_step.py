"""Step or pulse of the set-point under several speed controllers, as in Fig. 15 of Fietzek & Rinderknecht."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from ..argument_checks import checks_arguments
from ..recording import Recording
from .style import (
    SERIES,
    SET_POINT,
    Floats,
    axis_label,
    display_unit,
    is_held,
    panels,
    thin_min_max,
    title_and_legend,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIGNALS = ("speed_load", "speed_motor", "torque_motor", "twist")
#: A line is drawn by its extremes in so many parts of the window (option: a panel is 360 points wide).
BINS = 500


@checks_arguments
def control_step(
    responses: Mapping[str, Recording],
    *,
    start: float = -np.inf,
    stop: float = np.inf,
    torque_limit: float | None = None,
    signals: Sequence[str] = SIGNALS,
    title: str = "Step of the speed set-point (simulated)",
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Load speed with set-point, motor speed, motor torque with its limit, and twist; a line per controller.

    Parameters
    ----------
    responses : mapping of controller name → Recording
        Such as ``{"PI": ..., "Observer 1 + pole placement": ...}``; the first gives ``speed_reference``.
    start, stop : float, s
        The drawn window.
    torque_limit : float, optional, Nm
        Each sign is drawn if the torque exceeds a third of it.
    signals : sequence of str
        One panel each, for the signals in any response.
    title : str
    axes : sequence of Axes, optional
        One for each panel.

    Returns
    -------
    Figure
    """
    cut = {name: response.window(start, stop) for name, response in responses.items()}
    shown = [s for s in signals if any(s in response for response in cut.values())]
    figure, grid = panels(axes, len(shown), columns=2, size=(10.0, 6.2), sharex=True)
    first = next(iter(cut.values()))
    for axis, signal in zip(grid, shown, strict=True):
        factor, _ = display_unit(signal)
        style = "steps-post" if is_held(signal) else "default"
        if signal.startswith("speed") and "speed_reference" in first:
            axis.plot(
                first.time, first["speed_reference"], label="set-point", drawstyle="steps-post", **SET_POINT
            )
        for (name, response), line in zip(cut.items(), SERIES, strict=False):
            if signal in response:
                thinned = thin_min_max(response.time, factor * response[signal], BINS)
                axis.plot(*thinned, label=name, drawstyle=style, **line)
        if signal == "torque_motor" and torque_limit is not None:
            _draw_limits(axis, torque_limit, [r[signal] for r in cut.values() if signal in r])
        axis.set(ylabel=axis_label(signal), xlim=(first.time[0], first.time[-1]))
    for axis in grid[-2:]:
        axis.set_xlabel("time (s)")
        axis.tick_params(labelbottom=True)
    title_and_legend(figure, grid, title)
    return figure


def _draw_limits(axis: Axes, limit: float, torques: Sequence[Floats]) -> None:
    """Each of the two limits that the torque comes near, so that a far one does not flatten the picture."""
    line: dict[str, Any] = {"color": "#8c1a1a", "linewidth": 1.0, "linestyle": (0, (6, 2, 1, 2))}
    for sign in (1.0, -1.0):
        if np.isfinite(limit) and max(float(np.max(sign * torque)) for torque in torques) > limit / 3.0:
            axis.axhline(sign * limit, label="torque limit", **line)
