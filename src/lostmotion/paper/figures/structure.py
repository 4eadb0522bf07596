"""Figures 2 and 4: the finite elements' modes, and their reduction to two masses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...identification import two_mass_response
from ...structure import Coupling, Disc, Modes, ShaftSegment, modes
from ...structure.powertrain import PARTS
from ..claim import signed
from ..experiments import Experiments
from .style import MEASUREMENT, MODEL, PaperFigure, column, finish_phase, legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Drawn lengths of bodies and couplings, m, and drawn radius of a body of 1 kg m² and of a shaft (option: to be seen).
BODY, GAP, RADIUS, SHAFT = 0.07, 0.03, 0.22, 0.025
#: What the paper names: above (1) or below (−1) the body, and where its text is anchored.
NAMED = {
    "motor": ("el. motor", 1, "left"),
    "clutch output": ("clutch", -1, "left"),
    "joint": ("CV joint", 1, "right"),
    "brake disc": ("hub + brake disc", -1, "right"),
}
#: Fig. 4: frequencies, Hz, and the paper's ticks, dB and ° (option: its axes).
FROM, TO, DECIBELS, DEGREES = 10.0, 1000.0, (-100.0, -75.0, -50.0), (-180.0, -90.0, 0.0)


def mode_shapes(e: Experiments) -> PaperFigure:
    """Fig. 2: which bodies swing against which."""
    found = modes(e.structure)
    figure, panels = column(2, 2.4)
    for panel, mode in zip(panels, (1, 2), strict=True):
        shape = found.own_shapes()[:, mode]
        last = _draw(panel, shape / shape[0])
        panel.set_title(f"{found.frequency[mode]:.0f} Hz", loc="left", pad=2.0)
        panel.set(ylim=(-0.22, 0.22), xlim=(-BODY, last + BODY))
        panel.set_axis_off()
    return PaperFigure(
        number=2,
        title="Finite elements: eigenmodes",
        caption="Red turns with the motor, blue against it, the deeper the further; numbers: angle over that "
        "of the motor. At 100 Hz brake disc, hub and CV joint oscillate against the rest. Not to "
        "scale.",
        image=figure,
    )


def _draw(panel: Axes, angle: NDArray[np.float64]) -> float:
    """Discs, couplings and shafts in the colours of their nodes; returns where the last one is, m."""
    place, node = 0.0, 0
    for part in PARTS:
        match part:
            case Disc():
                radius = RADIUS * part.inertia**0.25
                _box(panel, place - 0.5 * BODY, BODY, radius, _colour(angle[node], angle), edge=0.6)
                if part.name in NAMED:
                    _name(panel, part.name, angle[node], place, radius)
            case Coupling():
                panel.plot([place, place + GAP], [0.0, 0.0], color="#555555", linewidth=1.0, zorder=0.5)
                place, node = place + GAP + 0.5 * BODY, node + 1
            case ShaftSegment():
                width = part.length / part.elements
                for _ in range(part.elements):
                    middle = 0.5 * (angle[node] + angle[node + 1])
                    _box(panel, place, width, SHAFT, _colour(middle, angle), edge=0.0)
                    place, node = place + width, node + 1
    return place


def _colour(value: float, angle: NDArray[np.float64]) -> tuple[float, float, float, float]:
    """Red with the motor, blue against it; full where the largest angle of that sign is."""
    from matplotlib import colormaps

    largest = float(np.max(np.sign(value) * angle))
    return colormaps["RdBu_r"](0.5 + 0.45 * value / largest if largest > 0.0 else 0.5)


def _box(panel: Axes, left: float, width: float, radius: float, colour: Any, edge: float) -> None:
    from matplotlib.patches import Rectangle

    panel.add_patch(
        Rectangle((left, -radius), width, 2.0 * radius, facecolor=colour, edgecolor="#333333" if edge else "none",
                  linewidth=edge, zorder=2.0 if edge else 1.0)
    )  # fmt: skip


def _name(panel: Axes, name: str, angle: float, place: float, radius: float) -> None:
    shown, side, anchor = NAMED[name]
    edge = place + (0.5 if anchor == "right" else -0.5) * BODY
    panel.text(
        edge, side * (radius + 0.015), f"{shown} {signed(angle, '+.2f')}", fontsize=6.5, ha=anchor,
        va="bottom" if side > 0 else "top",
    )  # fmt: skip


def reduction(e: Experiments) -> PaperFigure:
    """Fig. 4: Bode plot of the finite elements and of the linear two masses."""
    frequency = np.geomspace(FROM, TO, 2000)
    found: Modes = modes(e.structure)
    curves = {
        "FEM": (found.transfer(0, 0, frequency), MEASUREMENT),
        "linear two-mass oscillator": (
            two_mass_response(
                e.reduced.parameters(), "angle_motor", np.asarray(2j * np.pi * frequency, dtype=complex)
            ),
            MODEL,
        ),
    }
    figure, (above, below) = column(2, 3.0, sharex=True)
    for name, (response, line) in curves.items():
        above.plot(frequency, 20.0 * np.log10(np.abs(response)), label=name, **line)
        phase = np.rad2deg(np.unwrap(np.angle(response)))
        below.plot(frequency, phase - 360.0 * np.ceil(phase[0] / 360.0), **line)
    above.set(xscale="log", ylabel="amplitude (dB)", yticks=DECIBELS, ylim=(-125.0, -40.0))
    finish_phase(below, (FROM, TO), DEGREES, (-195.0, 15.0))
    legend(figure, [above])
    return PaperFigure(
        number=4,
        title="Bode plot of FEM model and linear two-mass oscillator",
        caption="G = φ_e/M_e, magnitude in dB of 1 rad/Nm. The two masses leave out the third eigenmode at "
        "750 Hz.",
        image=figure,
    )
