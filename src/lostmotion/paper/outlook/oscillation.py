"""Why does the motor oscillate under pole placement?"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..claims.control import response
from ..experiments import Experiments, placed_law, speed_step
from ..figures import PaperFigure
from ..figures.style import MEASUREMENT, MODEL, column, legend
from ..published import HIGH, LOW, POLE_PLACED, STEP_TIME
from .answer import Answer

#: Slower poles, for comparison, 1/s (option: half).
SLOWER = -200.0
#: Seconds around the step that are drawn (option).
SPAN = (0.995, 1.05)


def oscillation(e: Experiments) -> Answer:
    """The swing that the poles require, and the one on the rig."""
    run = e.placed_step.truth.signals
    required = designed(e, run.time)
    after = run.time >= STEP_TIME
    arrived = run.time >= STEP_TIME + (response(e.placed_step).crossing.arrival_time or 0.0)
    swing = float(np.max((run["speed_load"] - run["speed_motor"])[arrived]))
    asked = float(np.max(-required[after]))
    slower = response(speed_step(e.rig, placed_law(e.model, pole=SLOWER))).swing
    return Answer(
        question="The oscillations of the motor speed have to be analysed in further research.",
        text="The poles require them. The shaft torque alone accelerates the load, so motor − load speed is "
        "θ_w/k times the second derivative of the load speed: with three poles at −400 1/s the motor must "
        f"fall {asked:.2f} rad/s behind the load while it is braked into its set-point. On the rig it is "
        f"{swing:.2f} rad/s; with poles at −200 1/s {slower:.2f} rad/s. No observer, filter or sensor "
        "removes it; slower poles or a law that weighs the oscillation do.",
        page="motor-oscillation.md",
        numbers={
            "swing required by the poles, rad/s": asked,
            "swing on the rig, rad/s": swing,
            "swing with poles at −200 1/s, rad/s": slower,
        },
        figure=_figure(e, required),
    )


def designed(e: Experiments, time: NDArray[np.float64]) -> NDArray[np.float64]:
    """θ_w/k times the second derivative of the load speed's step response with the three poles, rad/s."""
    t = np.maximum(time - STEP_TIME, 0.0)
    p = POLE_PLACED
    second = (HIGH - LOW) * p**2 * -p * t * (1.0 + 0.5 * p * t) * np.exp(p * t)
    return np.asarray(e.model.inertia_load / e.model.stiffness * second)


def _figure(e: Experiments, required: NDArray[np.float64]) -> PaperFigure:
    run = e.placed_step.truth.signals
    part = (run.time >= SPAN[0]) & (run.time <= SPAN[1])
    figure, (panel,) = column(1, 2.2)
    difference = run["speed_motor"] - run["speed_load"]
    panel.plot(run.time[part], difference[part], label="virtual rig", **MEASUREMENT)
    panel.plot(run.time[part], required[part], label="what the poles require", **MODEL)
    panel.set(xlabel="time (s)", ylabel=r"$\dot\varphi_e - \dot\varphi_w$ (rad/s)", xlim=SPAN)
    legend(figure, [panel])
    return PaperFigure(
        number="oscillation",
        title="Motor minus load speed under pole placement",
        caption="Step at 1 s. Until 1.007 s the motor crosses the gap, which the formula does not know.",
        image=figure,
    )
