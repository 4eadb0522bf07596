"""Stage 4, validate: observers over a recording with the load withheld; controllers against a plant they never saw."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from .. import rig, signals
from ..drivetrain import Drivetrain
from ..metrics import compare, step_metrics
from ..recording import Recording
from ..systems import DiscreteSystem
from .design import OBSERVERS, Design, observer
from .material import STEP_SPEED, STEP_TIME, Material
from .parameters import Found

#: Signals that are withheld from the observers and compared with them afterwards.
WITHHELD = ("speed_load", "torque_shaft", "twist")
#: The observers have settled from an unknown start by then, s (chosen: six time constants of Observer 1's slow pole).
SETTLING = 0.3
#: The judged step lasts until this time, s; then the set-point goes back and makes a pulse (Fig. 15).
PULSE_END, PULSE_DURATION = 1.5, 2.0


@dataclass(frozen=True, eq=False)
class Validation:
    """Results in the form of ``results.json``, and the recordings behind them.

    Parameters
    ----------
    observers, controllers : mapping
        Tables of metrics, or {"skipped": reason}.
    estimates : mapping of observer → Recording
    responses : mapping of controller → Recording
    plant : str
        What the controllers ran against.
    """

    observers: Mapping[str, Any]
    controllers: Mapping[str, Any]
    estimates: Mapping[str, Recording] = field(default_factory=dict)
    responses: Mapping[str, Recording] = field(default_factory=dict)


def validate_observers(material: Material, found: Found) -> tuple[dict[str, Any], dict[str, Recording]]:
    """Every observer over the validation recording; withheld signals are compared afterwards."""
    recording = material.validate
    if found.drivetrain is None:
        return {"skipped": found.missing}, {}
    if recording is None:
        return {"skipped": "no recording with use = 'validate'"}, {}
    missing = [name for name in ("torque_motor", "speed_motor") if name not in recording]
    if missing:
        return {"skipped": f"no {' and no '.join(missing)} in the recording"}, {}
    averaged = bool(recording.meta.get("count_averaged", False))
    table: dict[str, Any] = {}
    estimates: dict[str, Recording] = {}
    for name, measured in OBSERVERS.items():
        absent = [signal for signal in measured if signal not in recording]
        if absent:
            table[name] = {"skipped": f"no {' and no '.join(absent)} in the recording"}
            continue
        law = observer(found.drivetrain, name, recording.dt, averaged)
        estimates[name] = law.run(recording.only("torque_motor", *measured))
        table[name] = _compared(estimates[name], recording, found)
    table["baselines"] = _baselines(recording, found.drivetrain, averaged, found)
    return table, estimates


def _compared(estimate: Recording, recording: Recording, found: Found) -> dict[str, Any]:
    """Metrics of every withheld signal that the recording holds, from SETTLING after its start on."""
    judged = recording.time >= recording.time[0] + min(
        SETTLING, 0.3 * (recording.time[-1] - recording.time[0])
    )
    rows: dict[str, Any] = {}
    for signal in WITHHELD:
        if signal not in recording:
            rows[signal] = {"skipped": f"no {signal} in the recording"}
        elif f"{signal}_estimated" in estimate:
            values = estimate[f"{signal}_estimated"][judged]
            row = compare(values, recording[signal][judged], recording.dt)
            rows[signal] = {name: row[name] for name in ("rmse", "range", "max", "lag")}
    return rows


def _baselines(recording: Recording, drivetrain: Drivetrain, averaged: bool, found: Found) -> dict[str, Any]:
    """Naive estimates that keep the numbers honest: the motor speed itself, and an observer that knows no gap."""
    motor = Recording(time=recording.time, signals={"speed_load_estimated": recording["speed_motor"]})
    without = observer(drivetrain.with_parameters(backlash=0.0), "observer_1", recording.dt, averaged)
    return {
        "motor_speed": {"speed_load": _compared(motor, recording, found).get("speed_load")},
        "no_backlash": _compared(
            without.run(recording.only("torque_motor", "speed_motor")), recording, found
        ),
    }


def validate_controllers(
    material: Material, found: Found, laws: Design
) -> tuple[dict[str, Any], dict[str, Recording]]:
    """PI and the target's law on the step −2 → 2 rad/s (and back) against the rig, or a finer plant."""
    if laws.law is None or laws.watched is None or laws.pi is None or found.drivetrain is None:
        return {"skipped": laws.skipped}, {}
    if material.virtual:
        plant, label = rig.varied_rig(material.seed), "virtual rig (simulated), which the design has not seen"
    else:
        plant = rig.finer_rig(found.drivetrain, found.intervals, material.seed)
        label = "simulated: a finer plant of four inertias, perturbed within the intervals"
    table: dict[str, Any] = {"plant": label}
    responses: dict[str, Recording] = {}
    for name, law in (("pi", laws.pi), ("pole_placement", laws.watched)):
        responses[name] = control_step(plant, law, laws.dt)
        table[name] = judged_step(responses[name])
    return table, responses


def control_step(plant: rig.Rig, law: DiscreteSystem, dt: float) -> Recording:
    """The law in the loop of a rig: what its sensors record, the set-point a pulse, and the law's outputs."""
    reference = signals.steps(
        (STEP_TIME, PULSE_END), (-STEP_SPEED, STEP_SPEED, -STEP_SPEED), PULSE_DURATION, dt
    )
    recording, truth = rig.record(plant, law=law, speed_reference=reference, dt=dt, noise_seed=2)
    estimates = {n: truth.signals[n] for n in law.outputs if n.endswith("_estimated")}
    return recording.with_signals("estimated", **estimates)


def judged_step(response: Recording) -> dict[str, float | None]:
    """Metrics of the load speed from the step to the end of the pulse."""
    metrics = step_metrics(
        response.time,
        response["speed_load"],
        STEP_TIME,
        -STEP_SPEED,
        STEP_SPEED,
        torque=response["torque_motor"],
        stop_time=PULSE_END,
    )
    return {
        name: None if value is None or not np.isfinite(value) else value
        for name, value in metrics.as_dict().items()
    }


def validate(material: Material, found: Found, laws: Design) -> Validation:
    """Both validations."""
    observers, estimates = validate_observers(material, found)
    controllers, responses = validate_controllers(material, found, laws)
    return Validation(observers, controllers, estimates, responses)
