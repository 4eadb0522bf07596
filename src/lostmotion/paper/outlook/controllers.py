"""Which other control approaches reduce overshoot, actuator load and impact?"""

from __future__ import annotations

from dataclasses import dataclass, replace

from ... import signals
from ...compare.controllers import CONTESTANTS
from ...compare.controllers.contestants import Contestant, Law, Setting
from ...display.numbers import digits
from ...drivetrain import Drivetrain
from ...rig import Rig, record
from ...simulation import Sensor
from .. import published
from ..claims.control import Response, response
from ..experiments import LENGTH, Experiments, Identified, Run
from ..figures import PaperFigure
from ..figures.style import LABELS, MEASUREMENT, MODEL, REFERENCE, THIRD, column, legend
from .answer import Answer, Table

#: Laws of the leaderboard that are run here.
SHOWN = (
    "PI, Table II", "pole placement", "LQI", "H∞", "predictive", "flat, 300 rad/s²", "sliding mode", "super-twisting",
    "soft landing, tolerant",
)  # fmt: skip
#: Those that are drawn, and their lines.
DRAWN = {"PI, Table II": THIRD, "pole placement": MEASUREMENT, "soft landing, tolerant": MODEL}
#: Seconds around the step that are drawn (option: the crossing of the gap).
SPAN = (0.995, 1.06)


@dataclass(frozen=True)
class Tried:
    """A law and what its step did."""

    name: str
    run: Run
    response: Response


def controllers(e: Experiments, identified: Identified) -> Answer:
    """The laws of the leaderboard on the rig, designed on what was identified."""
    tried = [_try(entry, e.rig, identified.found.drivetrain) for entry in CONTESTANTS if entry.name in SHOWN]
    by_name = {one.name: one.response for one in tried}
    placed, soft = by_name["pole placement"], by_name["soft landing, tolerant"]
    return Answer(
        question="The control strategy has to be compared to other control approaches.",
        text=f"Soft landing behind LQI closes the gap at {soft.crossing.impact_speed:.2f} instead of "
        f"{placed.crossing.impact_speed:.1f} rad/s, overshoots by {soft.step.overshoot:.2f} instead of "
        f"{placed.step.overshoot:.2f} %, and reaches 90 % of the step after {_milliseconds(soft)} instead of "
        f"{_milliseconds(placed)} ms. Less actuator load has who is slower: a flat course, the sliding modes.",
        page="choosing-a-controller.md",
        numbers={
            f"{what} of {one.name}, {unit}": value
            for one in tried
            for what, (unit, value) in _measured(one.response).items()
        },
        table=Table(
            ("law", *(f"{what}, {unit}" for what, (unit, _) in _measured(placed).items())),
            tuple((one.name, *(digits(v) for _, v in _measured(one.response).values())) for one in tried),
        ),
        figure=_figure(tried),
    )


def _measured(found: Response) -> dict[str, tuple[str, float | None]]:
    """What a law is compared by: unit and value."""
    return {
        "overshoot": ("%", found.step.overshoot),
        "time to 90 %": ("s", found.crossing.arrival_time),
        "peak torque": ("Nm", found.peak_torque),
        "impact": ("rad/s", found.crossing.impact_speed),
        "swing of the motor": ("rad/s", found.crossing.swing),
    }


def _try(entry: Contestant, rig: Rig, model: Drivetrain) -> Tried:
    """One contestant on the rig; the observer reads the torque that acts, one sample of computing delay."""
    setting = Setting(model, published.DT, published.TORQUE_LIMIT)
    laws: list[Law] = list(entry.control(setting))
    if entry.observer is not None:
        laws.insert(0, entry.observer(setting))
    plant = replace(rig, sensors={**rig.sensors, "torque_motor_acting": Sensor("torque_motor")})
    reference = signals.steps((published.STEP_TIME,), (published.LOW, published.HIGH), LENGTH, published.DT)
    run = Run(*record(plant, law=laws, speed_reference=reference, dt=published.DT))
    return Tried(entry.name, run, response(run))


def _milliseconds(found: Response) -> str:
    return "–" if found.crossing.arrival_time is None else f"{1e3 * found.crossing.arrival_time:.0f}"


def _figure(tried: list[Tried]) -> PaperFigure:
    figure, panels = column(3, 3.8, sharex=True)
    runs = {one.name: one.run.truth.signals.window(*SPAN) for one in tried}
    for panel, signal in zip(panels, ("torque_motor", "speed_motor", "speed_load"), strict=True):
        for name, line in DRAWN.items():
            panel.plot(runs[name].time, runs[name][signal], label=name, **line)
        panel.set(ylabel=LABELS[signal], xlim=SPAN)
    for panel in panels[1:]:
        panel.axhline(published.HIGH, **REFERENCE)
    panels[-1].set_xlabel("time (s)")
    legend(figure, panels)
    return PaperFigure(
        number="controllers",
        title="PI, pole placement and soft landing",
        caption="Step −2 → 2 rad/s on the virtual rig. Soft landing brakes the motor before the gap closes.",
        image=figure,
    )
