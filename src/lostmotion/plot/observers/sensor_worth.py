"""Worth of a torque sensor: error of Observer 2 over that of Observer 1 against the sensor's noise."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..rows import rows_of_one_length
from ..style import SERIES, panels, title_and_legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def sensor_worth(
    noise: Sequence[float],
    ratios: Mapping[str, Sequence[tuple[float, float, float]]],
    break_even: Mapping[str, float | None],
    *,
    axes: Axes | None = None,
) -> Figure:
    """Ratio of the errors for each signal, with its interval, and the noise at which both observers are equal.

    Parameters
    ----------
    noise : sequence of float, Nm
        Standard deviation of one sample of the torque sensor.
    ratios : mapping of signal in words → sequence of (median, low, high), one for each noise
        Error with the sensor / error without; below 1 the sensor helps.
    break_even : mapping of the same words → noise in Nm, None where there is none
    axes : Axes, optional

    Returns
    -------
    Figure
    """
    figure, (axis,) = panels(axes, 1, size=(7.2, 4.4))
    for style, (name, rows) in zip(SERIES, ratios.items(), strict=False):
        rows_of_one_length("sensor_worth", noise=noise, ratios=[row[0] for row in rows])
        axis.plot(noise, [row[0] for row in rows], label=name, **style)
        axis.fill_between(
            noise, [r[1] for r in rows], [r[2] for r in rows], color=style["color"], alpha=0.2, linewidth=0.0
        )
        level = break_even.get(name)
        if level is not None:
            axis.plot([level], [1.0], "o", color=style["color"], markersize=8)
            label = f"{level:.2g} Nm"
            if all(label != text.get_text() for text in axis.texts):
                # One below the other: two levels are often close.
                below = -14 - 12 * len(axis.texts)
                axis.annotate(label, (level, 1.0), xytext=(8, below), textcoords="offset points")
    axis.axhline(1.0, color="#222222", linewidth=0.8)
    axis.set(xscale="log", yscale="log", xlabel="noise of the torque sensor (Nm, one sample)")
    axis.set_ylabel("error of Observer 2 / error of Observer 1")
    for direction in (axis.xaxis, axis.yaxis):
        direction.set_major_formatter(lambda value, _: f"{value:g}")
        direction.set_minor_formatter(lambda value, _: "")
    axis.set_yticks([0.5, 1.0, 2.0, 5.0])
    axis.text(0.02, 0.93, "above 1: better without", transform=axis.transAxes, fontsize=9)
    axis.text(0.02, 0.30, "below 1: the torque sensor helps", transform=axis.transAxes, fontsize=9)
    title_and_legend(figure, [axis], "Is the torque sensor worth its money?")
    return figure
