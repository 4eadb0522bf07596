"""Shaft stiffness from the cross-spectrum of shaft torque and twist."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import ESTIMATED, MEASURED, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def stiffness_fit(
    frequency: ArrayLike,
    response: ArrayLike,
    coherence: ArrayLike,
    *,
    fitted: ArrayLike | None = None,
    used: ArrayLike | None = None,
    interval: tuple[float, float] | None = None,
    source: str = "measured",
    title: str = "Shaft stiffness",
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Magnitude and phase of torque / twist, with the fit, and the coherence below.

    Parameters
    ----------
    frequency : (m,) array, Hz
    response : (m,) complex array, Nm/rad
        Torque over twist.
    coherence : (m,) array, 1
    fitted : (m,) complex array, optional, Nm/rad
        The fit at the same frequencies.
    used : (m,) bool array, optional
        The frequencies that the fit used; default: all.
    interval : (low, high), optional, Nm/rad
        95 % interval.
    source : str
        What the response is called in the legend: "simulated" if it is that, see ``source_of``.
    title : str
    axes : sequence of three Axes, optional

    Returns
    -------
    Figure
    """
    rows_of_one_length(
        "stiffness_fit", frequency=frequency, response=response, coherence=coherence, fitted=fitted, used=used
    )
    hertz, measured = np.asarray(frequency, dtype=float), np.asarray(response, dtype=complex)
    use = np.ones(hertz.size, dtype=bool) if used is None else np.asarray(used, dtype=bool)
    figure, (size, phase, trust) = panels(axes, 3, size=(9.0, 7.2), sharex=True)
    dots = {"linestyle": "none", "color": MEASURED["color"], "markersize": 4}
    for axis, values in ((size, np.abs(measured)), (phase, np.degrees(np.angle(measured)))):
        axis.plot(hertz[use], values[use], marker="o", label=f"{source}, used by the fit", **dots)
        axis.plot(
            hertz[~use], values[~use], marker="x", label=f"{source}, not used", **{**dots, "color": "#999999"}
        )
    if fitted is not None:
        model = np.asarray(fitted, dtype=complex)
        size.plot(hertz, np.abs(model), label="fit", **ESTIMATED)
        phase.plot(hertz, np.degrees(np.angle(model)), label="fit", **ESTIMATED)
    if interval is not None:
        size.axhspan(*interval, color=ESTIMATED["color"], alpha=0.18, label="stiffness, 95 % interval")
    trust.plot(hertz, np.asarray(coherence, dtype=float), color=ESTIMATED["color"], linewidth=1.2)
    _focus(size, np.abs(measured[use]))
    _focus(phase, np.degrees(np.angle(measured[use])))
    size.set(ylabel="torque / twist (Nm/rad)", title=title)
    phase.set(ylabel="phase (°)")
    trust.set(ylabel="coherence (–)", xlabel="frequency (Hz)", ylim=(0.0, 1.05))
    figure.legend(*size.get_legend_handles_labels(), frameon=False, ncols=2, loc="outside lower center")
    return figure


def _focus(axis: Axes, values: np.ndarray) -> None:
    """Limits around the values that the fit used: others may lie far away and would flatten the picture."""
    if values.size:
        low, high = float(values.min()), float(values.max())
        margin = 0.6 * max(high - low, 0.02 * abs(high), 1e-12)
        axis.set_ylim(low - margin, high + margin)
