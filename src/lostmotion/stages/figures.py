"""The report's figures."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .. import plot
from ..display.numbers import quantity, with_interval
from ..identification.shaft.ring_down import RingDown
from ..recording import Recording
from ..report import ReportFigure
from .design import OBSERVERS, Design
from .material import Material
from .parameters import Found
from .speed_step import PAPER_STEP
from .validation import WITHHELD, Validation, judged_step

NAMES = {"observer_1": "Observer 1", "observer_2": "Observer 2"}
#: What is drawn of a set-point step, in settling times of the slower law: before it and after it (option).
BEFORE, AFTER = 0.2, 1.3
#: The part of a user's recording that is drawn of an observer.
LIVELIEST = "where the motor torque changes most"
CONTROLLERS = {
    "pi": "PI", "pole_placement": "Observer 1 + pole placement", "soft_landing": "the same + soft landing",
}  # fmt: skip


def figures(
    material: Material,
    found: Found,
    laws: Design,
    validation: Validation,
    truth: dict[str, float | None] | None,
) -> list[ReportFigure]:
    """All figures that have data, in the order of the report."""
    source = "measured" if material.identify is None else plot.source_of(material.identify)
    return [
        *_recordings(material),
        *_parameters(found, truth, source),
        *_shaft(found, source),
        *_observers(material, validation),
        *_controllers(laws, validation),
    ]


def stability_figure(section: Mapping[str, Any]) -> list[ReportFigure]:
    """The range of load speeds that is proved; none where nothing is."""
    if not section.get("proved"):
        return []
    caption = "From standstill up to the bar nothing is proved: there the loop may rest anywhere in the gap, or stick."
    drawn = plot.stability_range({"these parameters": section})
    return [ReportFigure("Load speeds at which the loop is proved stable", caption, drawn, "stability")]


def _recordings(material: Material) -> list[ReportFigure]:
    origin = " (virtual rig, simulated)" if material.virtual else ""
    return [
        ReportFigure(
            f"Recording: {name.replace('_', ' ')}",
            "Each signal over the whole time. Of too many samples, the smallest and the largest are drawn.",
            plot.recording_overview(recording, title=f"{name.replace('_', ' ').capitalize()}{origin}"),
            "recording",
        )
        for name, recording in material.recordings.items()
    ]


def _parameters(found: Found, truth: dict[str, float | None] | None, source: str) -> list[ReportFigure]:
    made = []
    if any(entry["low"] is not None for entry in found.table.values()):
        made.append(
            ReportFigure(
                "Identified parameters",
                "Intervals of 95 %, relative to the identified value.",
                plot.identified_parameters(found.table, truth=truth),
                "parameters",
            )
        )
    if found.identification is not None:
        prediction = found.identification.prediction
        made.append(
            ReportFigure(
                "Prediction of the motor speed",
                "One sample ahead. Where the residual leaves the band, the two-mass model does not explain it.",
                plot.prediction_fit(
                    prediction.time,
                    prediction.speed_motor + prediction.residual,
                    prediction.speed_motor,
                    source=source,
                ),
                "fits",
            )
        )
    return made


def _shaft(found: Found, source: str) -> list[ReportFigure]:
    made = []
    shaft, ringing = found.shaft, found.ringing
    if shaft is not None and (stiffness := shaft.values["stiffness"]) is not None:
        interval = shaft.intervals["stiffness"]
        made.append(
            ReportFigure(
                "Shaft stiffness",
                f"Shaft torque ({source}) against the integral of the speed difference.",
                plot.stiffness_fit(
                    shaft.frequency, shaft.response, shaft.coherence, fitted=shaft.fitted(shaft.frequency),
                    used=shaft.used, interval=interval, source=source,
                    title=f"Shaft stiffness: {with_interval(stiffness, *interval, 'Nm/rad')[0]}",
                ),
                "fits",
            )
        )  # fmt: skip
    if ringing is not None and ringing.values["frequency"] is not None:
        made.append(
            ReportFigure(
                "Ring-down",
                f"Shaft torque ({source}) after each step and the fitted damped oscillation.",
                plot.ring_down_fit(
                    ringing.windows, signal=ringing.signal, source=source, title=ring_down_title(ringing),
                ),
                "fits",
            )
        )  # fmt: skip
    return made


def ring_down_title(ringing: RingDown) -> str:
    """Frequency and damping ratio with as many digits as their intervals justify."""
    values, intervals = ringing.values, ringing.intervals
    frequency = with_interval(values["frequency"], *intervals["frequency"], "Hz")[0]
    ratio = with_interval(values["damping_ratio"], *intervals["damping_ratio"], "")[0]
    return f"Ring-down: {frequency}, damping ratio {ratio}"


def _observers(material: Material, validation: Validation) -> list[ReportFigure]:
    recording = material.validate
    if recording is None or not validation.estimates:
        return []
    virtual = material.virtual
    made = []
    for number, (name, estimate) in enumerate(validation.estimates.items()):
        place = f"over the recorded step (as Fig. {12 + number} of the paper)" if virtual else LIVELIEST
        figure = plot.observer_step(
            recording,
            estimate,
            step_time=PAPER_STEP.start if virtual else _liveliest(recording),
            name=NAMES[name],
            source="virtual rig (simulated)" if virtual else None,
            title=None if virtual else f"{NAMES[name]} {LIVELIEST}",
        )
        made.append(ReportFigure(f"{NAMES[name]} {place}", _withheld(recording, name), figure, "observers"))
    return made


def _withheld(recording: Recording, observer: str) -> str:
    """Which of the drawn signals the observer does not see, and which were not recorded."""
    hidden = [signal for signal in WITHHELD if signal not in OBSERVERS[observer]]
    seen = [plot.words(signal) for signal in hidden if signal in recording]
    absent = [plot.words(signal) for signal in hidden if signal not in recording]
    parts = [f"Withheld from the observer: {', '.join(seen)}."] if seen else []
    parts += [f"Not recorded, only estimated: {', '.join(absent)}."] if absent else []
    return " ".join(parts)


def _liveliest(recording: Recording) -> float:
    """The time (s) at which the motor torque changes most: the hardest moment for an observer."""
    return float(recording.time[int(np.argmax(np.abs(np.diff(recording["torque_motor"]))))])


def _controllers(laws: Design, validation: Validation) -> list[ReportFigure]:
    if not validation.responses:
        return []
    limit, step = laws.torque_limit, validation.step
    settling = [judged_step(response, step)["settling_time"] for response in validation.responses.values()]
    # Until both have settled; one that does not is drawn as long as it was simulated.
    drawn = [step.stop - step.start if time is None else AFTER * time for time in settling]
    length = min(max(drawn), step.stop - step.start)
    return [
        ReportFigure(
            "Step of the set-point with PI, pole placement and soft landing (as Fig. 15 of the paper)",
            f"Plant: {validation.controllers['plant']}. {_torques(validation)}",
            plot.control_step(
                {CONTROLLERS[name]: response for name, response in validation.responses.items()},
                start=step.start - BEFORE * length,
                stop=step.start + length,
                torque_limit=None if limit == float("inf") else limit,
                title="Step of the speed set-point (simulated)",
            ),
            "controllers",
        )
    ]


def _torques(validation: Validation) -> str:
    """The peak torques of the laws: who accelerates harder arrives sooner."""
    peaks = {name: validation.controllers[name]["peak_torque"] for name in validation.responses}
    shown = [f"{CONTROLLERS[name]} {quantity(peak, 'Nm')}" for name, peak in peaks.items()]
    return f"Peak torque: {', '.join(shown)}."
