"""Torque and speed of a torque step with the fitted friction (Fig. 5 of Fietzek & Rinderknecht)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ..rows import rows_of_one_length
from ..style import ESTIMATED, MEASURED, axis_label, display_unit, panels, thin_min_max

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Points drawn across the figure (option).
BINS = 1500


def friction_fit(
    time: ArrayLike,
    torque: ArrayLike,
    measured: ArrayLike,
    fitted: ArrayLike,
    *,
    signal: str = "speed_motor",
    torque_signal: str = "torque_motor",
    source: str = "measured",
    title: str = "Friction from a torque step",
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Torque above, measured and fitted signal below.

    Parameters
    ----------
    time, torque, measured, fitted : (n,) arrays
        s, Nm, and the signal's SI unit; NaN in ``fitted`` leaves a gap. Of a ``FrictionFit``, these are its arrays.
    signal, torque_signal : str
        Names; they give labels and units.
    source : str
        What the signal is called in the legend: "simulated" if it is that, see ``source_of``.
    axes : sequence of two Axes, optional
    """
    rows_of_one_length("friction_fit", time=time, torque=torque, measured=measured, fitted=fitted)
    figure, (above, below) = panels(axes, 2, size=(9.0, 5.6), sharex=True)
    torque, measured, fitted = (np.asarray(a, dtype=float) for a in (torque, measured, fitted))
    factor, _ = display_unit(signal)
    above.plot(
        *thin_min_max(time, torque, BINS), label=axis_label(torque_signal), **{**MEASURED, "linewidth": 1.2}
    )
    above.set_ylabel(axis_label(torque_signal))
    below.plot(*thin_min_max(time, factor * measured, BINS), label=source, **MEASURED)
    t, line = np.asarray(time, dtype=float), factor * fitted
    step = max(t.size // (2 * BINS), 1)
    below.plot(t[::step], line[::step], label="fitted", **ESTIMATED)
    below.set(xlabel="time (s)", ylabel=axis_label(signal))
    below.margins(x=0.0)
    below.legend(frameon=False)
    figure.suptitle(title, fontweight="bold")
    return figure
