"""An observer over a step of the set-point, as Fig. 12 and 13 of Fietzek & Rinderknecht show it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...recording import Recording
from ..style import (
    ESTIMATED,
    MEASURED,
    SET_POINT,
    axis_label,
    display_unit,
    is_held,
    panels,
    source_of,
    title_and_legend,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SIGNALS = ("torque_motor", "twist", "speed_motor", "speed_load")


def observer_step(
    measured: Recording,
    estimated: Recording,
    *,
    step_time: float,
    name: str = "Observer 1",
    signals: Sequence[str] = SIGNALS,
    before: float = 0.05,
    after: float = 0.10,
    source: str | None = None,
    title: str | None = None,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Recording, observer and set-point from ``before`` s before the step to ``after`` s after it.

    Parameters
    ----------
    measured : Recording
        Signals by their names; for signals that are not in it, the observer alone is drawn.
    estimated : Recording
        The observer's outputs, ``<signal>_estimated``.
    step_time : float, s
    name : str
        The observer's name, for the title.
    signals : sequence of str
        One panel each, for the signals in either recording.
    before, after : float, s
        The paper draws 0.95 to 1.1 s around its step at 1 s.
    source : str, optional
        What ``measured`` is called in the legend; default: "measured", or "simulated" if its signals say so.
    title : str, optional
        Default: that of a step of the set-point.
    axes : sequence of Axes, optional
        One for each panel.

    Returns
    -------
    Figure
    """
    source = source or source_of(measured)
    shown = [s for s in signals if s in measured or f"{s}_estimated" in estimated]
    figure, grid = panels(axes, len(shown), columns=2, size=(10.0, 6.2), sharex=True)
    span = (step_time - before, step_time + after)
    real, guess = measured.window(*span), estimated.window(*span)
    for axis, signal in zip(grid, shown, strict=True):
        factor, _ = display_unit(signal)
        style = "steps-post" if is_held(signal) else "default"
        if signal in real:
            axis.plot(real.time, factor * real[signal], label=source, drawstyle=style, **MEASURED)
        if f"{signal}_estimated" in guess:
            axis.plot(guess.time, factor * guess[f"{signal}_estimated"], label=name, **ESTIMATED)
        if signal.startswith("speed") and "speed_reference" in real:
            axis.plot(
                real.time, real["speed_reference"], label="set-point", drawstyle="steps-post", **SET_POINT
            )
        axis.set(ylabel=axis_label(signal), xlim=span)
    for axis in grid[-2:]:
        axis.set_xlabel("time (s)")
        axis.tick_params(labelbottom=True)
    title_and_legend(figure, grid, title or f"{name} over a step of the speed set-point")
    return figure
