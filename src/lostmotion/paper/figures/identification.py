"""Figures 5 and 7: the torque step, and the characteristic curves of backlash and friction."""

from __future__ import annotations

import numpy as np

from ...display.numbers import digits
from ...plot.style import thin_min_max
from ..experiments import Experiments
from .style import LABELS, MEASUREMENT, MODEL, PaperFigure, beside, column, legend

#: Points drawn across Fig. 5 (option).
BINS = 600
#: Ends of Fig. 7's axes: multiples of the backlash, rad/s (option).
TWISTS, SPEEDS = 1.25, 40.0


def torque_step(e: Experiments) -> PaperFigure:
    """Fig. 5: torque and speed of the test, and the speed with the friction found."""
    found = e.friction
    figure, (above, below) = column(2, 2.9, sharex=True)
    above.plot(*thin_min_max(found.time, found.torque, BINS), **MODEL)
    below.plot(
        *thin_min_max(found.time, found.measured, BINS), label="measurement (virtual rig)", **MEASUREMENT
    )
    step = max(found.time.size // BINS, 1)
    below.plot(found.time[::step], found.fitted[::step], label="two-mass oscillator", **MODEL)
    above.set(ylabel=LABELS["torque_motor"], ylim=(-0.5, 15.5), yticks=(0, 5, 10, 15))
    below.set(
        ylabel=LABELS["speed_motor"],
        ylim=(-3.0, 103.0),
        yticks=(0, 25, 50, 75, 100),
        xlabel="time (s)",
        xlim=(0, 10),
    )
    legend(figure, [below])
    return PaperFigure(
        number=5,
        title="Identification of Coulomb and viscous friction",
        caption=f"Torque step, then coasting. Found: M_c = {digits(found.values['coulomb'])} Nm, d_v = "
        f"{digits(found.values['viscous'])} Nm s/rad.",
        image=figure,
    )


def characteristic_curves(e: Experiments) -> PaperFigure:
    """Fig. 7: β(φ_e − φ_w) and M_f(φ̇_w) of the nonlinear model."""
    model = e.model
    figure, (left, right) = beside(1.75)
    half = 0.5e3 * model.backlash
    end = 2.0 * TWISTS * half
    left.plot([-end, -half, half, end], [-half, -half, half, half], **MODEL)
    left.set(xlabel=LABELS["twist"], ylabel=r"$\beta$ (mrad)", ylim=(-1.4 * half, 1.4 * half))
    left.set_yticks([-half, 0.0, half], [r"$-\frac{\beta_{max}}{2}$", "0", r"$\frac{\beta_{max}}{2}$"])
    left.annotate("45°", (0.3 * half, 0.3 * half), (7, -3), textcoords="offset points")
    for sign in (-1.0, 1.0):
        speed = sign * np.array([0.0, SPEEDS])
        right.plot(speed, sign * model.coulomb + model.viscous * speed, **MODEL)
    right.plot([0.0, 0.0], [-model.coulomb, model.coulomb], **MODEL)
    right.set(xlabel=LABELS["speed_load"], ylabel=r"$M_f$ (Nm)", xticks=(-SPEEDS, 0, SPEEDS))
    right.set_yticks([-model.coulomb, 0.0, model.coulomb], ["$-M_c$", "0", "$M_c$"])
    right.annotate("slope $d_v$", (0.5 * SPEEDS, model.coulomb + 0.5 * SPEEDS * model.viscous), (-4, 4),
                   textcoords="offset points", ha="center", va="bottom")  # fmt: skip
    right.set_ylim(-1.6 * model.coulomb, 1.6 * model.coulomb)
    return PaperFigure(
        number=7,
        title="Nonlinear correlations",
        caption="Backlash angle β over the twist and friction torque over the load speed, with β_max = "
        f"{1e3 * model.backlash:.2f} mrad and M_c = {model.coulomb:.2f} Nm as found on the rig.",
        image=figure,
    )
