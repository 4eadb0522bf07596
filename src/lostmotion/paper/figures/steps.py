"""Figures 12, 13 and 15: the observers under PI control, and the pulse under pole placement."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ... import signals
from ...display.numbers import digits
from ...recording import Recording
from .. import published
from ..claims.observers import error
from ..experiments import (
    Experiments,
    Run,
    observer,
    observer_2,
    pi_law,
    placed_law,
    speed_step,
    with_torque_noise,
)
from .style import LABELS, MEASUREMENT, MODEL, REFERENCE, THIRD, PaperFigure, column, legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes

#: Noise of the torque sensor in Fig. 13, standard deviation of one sample, Nm (option: the paper gives none; with this
#: one Observer 2 is slightly worse, as it says).
TORQUE_NOISE = 5.0
#: Fig. 15: when the pulse ends, what is drawn, and the length of the run, s (option: the paper's times are not known).
PULSE_END, PULSE_SPAN, PULSE_LENGTH = 1.12, (0.95, 1.25), 1.3


def observer_1(e: Experiments) -> PaperFigure:
    """Fig. 12: Observer 1 with the PI controller."""
    law = observer(e.model)
    return _observer(12, "Observer 1", e.pi_step, law.run(e.pi_step.recording), error(law, e.pi_step), "")


def observer_2_noisy(e: Experiments) -> PaperFigure:
    """Fig. 13: Observer 2 with the PI controller and a noisy torque sensor."""
    run, law = speed_step(with_torque_noise(e.rig, TORQUE_NOISE), pi_law()), observer_2(e.model)
    note = f" Torque sensor with {TORQUE_NOISE:g} Nm of noise."
    return _observer(13, "Observer 2", run, law.run(run.recording), error(law, run), note)


def _observer(number: int, name: str, run: Run, estimate: Recording, off: float, note: str) -> PaperFigure:
    figure, panels = column(4, 4.6, sharex=True)
    _draw(panels, run.recording, estimate, published.SPAN)
    panels[0].set(ylim=(-42.0, 42.0), yticks=(-40, -20, 0, 20, 40))
    legend(figure, panels)
    return PaperFigure(
        number=number,
        title=f"{name} with PI controller",
        caption=f"Step of the motor speed's set-point at 1 s. Load speed {digits(100.0 * off, 2)} % of its "
        f"range off.{note}",
        image=figure,
    )


def pulse(e: Experiments) -> PaperFigure:
    """Fig. 15: a pulse with Observer 1 and pole placement; PI for comparison."""
    times, levels = (published.STEP_TIME, PULSE_END), (published.LOW, published.HIGH, published.LOW)
    reference = signals.steps(times, levels, PULSE_LENGTH, published.DT)
    placed, pi = (speed_step(e.rig, law, reference) for law in (placed_law(e.model), pi_law()))
    figure, panels = column(4, 4.6, sharex=True)
    compared = pi.recording.window(*PULSE_SPAN)
    for panel, name in zip(panels, LABELS, strict=True):
        panel.plot(
            compared.time, _shown(compared, name), label="PI, for comparison", **{**THIRD, "linewidth": 0.9}
        )
    _draw(panels, placed.recording, observer(e.model).run(placed.recording), PULSE_SPAN)
    limit = published.TORQUE_LIMIT
    panels[0].set(ylim=(-1.1 * limit, 1.1 * limit))
    panels[0].set_yticks([-limit, 0.0, limit], [f"−{limit:g}", "0", f"{limit:g}"])
    legend(figure, panels)
    return PaperFigure(
        number=15,
        title="Pulse with Observer 1 and pole placement controller",
        caption="Set-point of the load speed −2 → 2 → −2 rad/s. Less overshoot than PI, more torque, a "
        "swinging motor, a smooth load.",
        image=figure,
    )


def _draw(panels: list[Axes], measured: Recording, estimated: Recording, span: tuple[float, float]) -> None:
    """Torque, twist, motor speed, load speed: measurement, observer, set-point."""
    real, guess = measured.window(*span), estimated.window(*span)
    for panel, name in zip(panels, LABELS, strict=True):
        style = "steps-post" if name == "torque_motor" else "default"
        panel.plot(
            real.time, _shown(real, name), label="measurement (virtual rig)", drawstyle=style, **MEASUREMENT
        )
        if f"{name}_estimated" in guess:
            panel.plot(guess.time, _shown(guess, name, "_estimated"), label="observer", **MODEL)
        if name.startswith("speed"):
            panel.plot(
                real.time, real["speed_reference"], label="set point", drawstyle="steps-post", **REFERENCE
            )
        panel.set(ylabel=LABELS[name], xlim=span)
    panels[-1].set_xlabel("time (s)")


def _shown(recording: Recording, name: str, ending: str = "") -> NDArray[np.float64]:
    """In the unit of its label."""
    return (1e3 if name == "twist" else 1.0) * recording[name + ending]
