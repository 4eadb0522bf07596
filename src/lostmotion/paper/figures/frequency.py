"""Figures 8 and 9: frequency response and coherence of rig, nonlinear and linear model."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...plot.frequency.bode import plain_ticks
from ..experiments import LINEAR, NOISE_RMS, NONLINEAR, RIG, Experiments
from .style import MEASUREMENT, MODEL, THIRD, PaperFigure, column, finish_phase, legend

#: Frequencies drawn, Hz (option: around the paper's mark of 10 Hz, to beyond the pole).
FROM, TO = 5.0, 200.0
LINES = {RIG: MEASUREMENT, NONLINEAR: MODEL, LINEAR: THIRD}


def response(e: Experiments) -> PaperFigure:
    """Fig. 8: G = φ_e/M_e of measurement and nonlinear model."""
    figure, (above, below) = column(2, 3.0, sharex=True)
    for name in (RIG, NONLINEAR):
        found = e.responses[name]["angle_motor"]
        part = found.band(FROM, TO)
        frequency, values = found.frequency[part], found.response[part]
        above.plot(frequency, 20.0 * np.log10(np.abs(values)), label=name, **LINES[name])
        below.plot(frequency, _phase(values), **LINES[name])
    for panel in (above, below):
        for mark in (e.model.zero_frequency, e.model.pole_frequency):
            panel.axvline(mark, color="#777777", linewidth=0.8, linestyle=(0, (1, 2)), zorder=0.5)
    for mark, name in ((e.model.zero_frequency, "zero"), (e.model.pole_frequency, "pole")):
        above.annotate(f"linear\n{name}", (mark, 1.0), (2, -1), xycoords=("data", "axes fraction"),
                       textcoords="offset points", va="top", fontsize=6.5, color="#444444")  # fmt: skip
    above.set(xscale="log", ylabel="amplitude (dB)")
    finish_phase(below, (FROM, TO), (-180, -90, 0), (-225.0, 60.0))
    legend(figure, [above])
    return PaperFigure(
        number=8,
        title="Frequency response of the nonlinear system",
        caption=f"G = φ_e/M_e by tfestimate, the same random torque of {NOISE_RMS:g} Nm rms for both. Zero "
        "and pole lie below those of the linear model.",
        image=figure,
    )


def _phase(values: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Degrees from −270 to 90, broken where the line would cross the panel."""
    degrees = np.mod(np.rad2deg(np.angle(values)) + 270.0, 360.0) - 270.0
    jumps = np.abs(np.diff(degrees, prepend=degrees[0])) > 180.0
    return np.where(jumps, np.nan, degrees)


def coherence(e: Experiments) -> PaperFigure:
    """Fig. 9: coherence of measurement, nonlinear and linear model."""
    figure, (panel,) = column(1, 2.2)
    for name, line in LINES.items():
        found = e.responses[name]["angle_motor"]
        part = found.band(FROM, TO)
        panel.plot(found.frequency[part], found.coherence[part], label=name, **line)
    panel.set(xscale="log", ylabel="coherence", ylim=(0.0, 1.03), xlabel="frequency (Hz)", xlim=(FROM, TO))
    plain_ticks(panel)
    legend(figure, [panel])
    return PaperFigure(
        number=9,
        title="Coherence of the frequency response",
        caption="Small in the area of the zero in all three; with backlash up to the pole.",
        image=figure,
    )
