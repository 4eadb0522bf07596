"""Stage 4, validate: observers on a recording with the load withheld, controllers on a plant not used in the design."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from .. import rig
from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..metrics import compare, step_metrics
from ..recording import Recording
from ..systems import DiscreteSystem
from .design import GIVEN, OBSERVERS, Design, is_averaged, observer
from .fitness import STEADY
from .material import Material
from .parameters import Found
from .speed_step import PAPER_STEP, SpeedStep


@dataclass(frozen=True, eq=False)
class Validation:
    """Results in the form of ``results.json``, and the recordings behind them.

    Parameters
    ----------
    observers, controllers : mapping
        Tables of metrics, or {"skipped": reason}.
    estimates : mapping of observer → Recording
    responses : mapping of controller → Recording
    step : SpeedStep
        Of these responses.
    problems : tuple of Problem
    """

    observers: Mapping[str, Any]
    controllers: Mapping[str, Any]
    estimates: Mapping[str, Recording] = field(default_factory=dict)
    responses: Mapping[str, Recording] = field(default_factory=dict)
    step: SpeedStep = PAPER_STEP
    problems: tuple[Problem, ...] = ()


#: Signals that are withheld from the observers and compared with them afterwards.
WITHHELD = ("speed_load", "torque_shaft", "twist")
#: Settling time of the observers from an unknown start, s (option: six time constants of Observer 1's slow pole
#: on the paper's rig).
SETTLING = 0.3
#: A step that has not settled is shown with twice the time, at most so often (option: 16 times).
SHOWN_DOUBLINGS = 4
#: A load speed beyond this many times the set-point counts as unstable (option).
RUNAWAY = 20.0


def validate_observers(material: Material, found: Found) -> tuple[dict[str, Any], dict[str, Recording]]:
    """Run every observer over the validation recording and compare it with the withheld signals."""
    recording = material.validate
    if found.drivetrain is None:
        return {"skipped": found.missing}, {}
    if recording is None:
        return {"skipped": "no recording with use = 'validate'"}, {}
    missing = [name for name in ("torque_motor", "speed_motor") if name not in recording]
    if missing:
        return {"skipped": f"no {' and no '.join(missing)} in the recording"}, {}
    averaged = is_averaged(recording, found)
    table: dict[str, Any] = {}
    estimates: dict[str, Recording] = {}
    for name, measured in OBSERVERS.items():
        absent = [signal for signal in measured if signal not in recording]
        if absent:
            table[name] = {"skipped": f"no {' and no '.join(absent)} in the recording"}
            continue
        try:
            law = observer(found.drivetrain, name, recording.dt, averaged)
        except InvalidInput as error:
            table[name] = {"skipped": str(error)}
            continue
        estimates[name] = law.run(recording.only("torque_motor", *measured))
        table[name] = _compared(estimates[name], recording)
    table["baselines"] = _baselines(recording, found.drivetrain, averaged)
    return table, estimates


def _compared(estimate: Recording, recording: Recording) -> dict[str, Any]:
    """Metrics of every withheld signal in the recording."""
    rows: dict[str, Any] = {}
    for signal in WITHHELD:
        if f"{signal}_estimated" in estimate:
            values = _as_recorded(estimate[f"{signal}_estimated"], signal, recording)
            rows[signal] = _row(values, signal, recording)
    return rows


def _row(values: np.ndarray, signal: str, recording: Recording) -> dict[str, Any]:
    """Metrics of one signal, from SETTLING after the recording's start on."""
    if signal not in recording:
        return {"skipped": f"no {signal} in the recording"}
    duration = recording.time[-1] - recording.time[0]
    judged = recording.time >= recording.time[0] + min(SETTLING, 0.3 * duration)
    row = compare(values[judged], recording[signal][judged], recording.dt)
    return {name: row[name] for name in ("rmse", "range", "max", "lag")}


def _as_recorded(values: np.ndarray, signal: str, recording: Recording) -> np.ndarray:
    """An estimate as the sensor shows it: a speed from counts is the mean over the sample that just ended."""
    derived = str(recording.meta.get(signal, "")).startswith("mean over the sample")
    if not derived and signal not in recording.meta.get("averaged", ()):
        return values
    return np.concatenate([values[:1], 0.5 * (values[1:] + values[:-1])])


def _baselines(recording: Recording, drivetrain: Drivetrain, averaged: bool) -> dict[str, Any]:
    """Naive estimates for comparison: the motor speed itself, and an observer without backlash in its model."""
    without = observer(drivetrain.with_parameters(backlash=0.0), "observer_1", recording.dt, averaged)
    return {
        "motor_speed": {"speed_load": _row(recording["speed_motor"], "speed_load", recording)},
        "no_backlash": _compared(without.run(recording.only("torque_motor", "speed_motor")), recording),
    }


def validate_controllers(
    material: Material, found: Found, laws: Design
) -> tuple[dict[str, Any], dict[str, Recording], SpeedStep, tuple[Problem, ...]]:
    """PI, the target's law and that with soft landing on a step of the set-point and back, on the rig or a finer plant.

    A loop that is unstable or does not settle is a result, with a warning.
    """
    if found.drivetrain is None:
        return {"skipped": found.missing}, {}, laws.step, ()
    if material.virtual:
        plant, label = rig.varied_rig(material.seed), "virtual rig (simulated), not used in the design"
    else:
        plant = rig.finer_rig(found.drivetrain, found.intervals, material.seed)
        label = "simulated: four inertias, parameters varied within the 95 % intervals"
    table: dict[str, Any] = {"plant": label}
    step, responses, unstable = _settled_responses(plant, laws)
    problems: list[Problem] = []
    skipped = {
        "pi": laws.pi_skipped, "pole_placement": laws.skipped, "soft_landing": laws.landing_skipped,
    }  # fmt: skip
    for name, reason in skipped.items():
        if name in unstable:
            table[name] = {"skipped": f"unstable loop: {unstable[name]}"}
            problems.append(_loop_problem(name, unstable[name], laws))
        elif name not in responses:
            table[name] = {"skipped": reason}
        else:
            table[name] = judged_step(responses[name], step)
            if not table[name]["steady_error"] < STEADY:
                got = f"a steady error of {table[name]['steady_error']:.2g} of the step"
                problems.append(_loop_problem(name, got, laws, _holds(found.drivetrain)))
    return table, responses, step, tuple(problems)


def _settled_responses(
    plant: rig.Rig, laws: Design
) -> tuple[SpeedStep, dict[str, Recording], dict[str, str]]:
    """The step with as much time as the laws need, their responses, and why some are unstable."""
    step = laws.step
    for doubling in range(SHOWN_DOUBLINGS + 1):
        responses: dict[str, Recording] = {}
        unstable: dict[str, str] = {}
        named = {"pi": laws.pi, "pole_placement": laws.watched, "soft_landing": laws.landing}
        for name, law in named.items():
            if law is None:
                continue
            response, trouble = _stable_response(plant, law, laws.dt, step)
            if response is None:
                unstable[name] = trouble
            else:
                responses[name] = response
        longer = step.longer(laws.dt)
        settled = all(_settles(response, step) for response in responses.values())
        if settled or doubling == SHOWN_DOUBLINGS or longer == step:
            break
        step = longer
    return step, responses, unstable


def _settles(response: Recording, step: SpeedStep) -> bool:
    judged = judged_step(response, step)
    steady = judged["steady_error"]
    return judged["settling_time"] is not None and steady is not None and steady < STEADY


def _stable_response(
    plant: rig.Rig, law: DiscreteSystem, dt: float, step: SpeedStep
) -> tuple[Recording | None, str]:
    """The response, or the reason why the loop is not stable."""
    try:
        response = control_step(plant, law, dt, step)
    except InvalidInput as error:
        return None, error.problem.got
    largest = float(np.max(np.abs(response["speed_load"])))
    if not largest < RUNAWAY * max(abs(step.low), abs(step.high)):
        return None, f"the load speed reaches {largest:.2g} rad/s"
    return response, ""


def _holds(drivetrain: Drivetrain) -> float:
    """Torque that friction holds, Nm."""
    return drivetrain.coulomb + drivetrain.coulomb_motor


def _loop_problem(name: str, got: str, laws: Design, friction: float = 0.0) -> Problem:
    """A loop that does not settle, with what helps: what the user has set comes first."""
    given = laws.taken["pi_kp" if name == "pi" else "poles"]["source"] == GIVEN
    key = "kp and ki" if name == "pi" else "poles"
    if laws.torque_limit <= friction:
        remedy = f"Raise torque_limit under [law]: friction alone holds {friction:.3g} Nm."
    elif given:
        remedy = f"Leave {key} out of [law]: the default is made for this drivetrain."
    else:
        remedy = (
            "Give a shorter sample_time under [law]; check whether backlash and stiffness are identified."
        )
    where = f"controller {name} in the simulated loop"
    return Problem.warning(where, got, "a load speed that settles at the set-point", remedy)


def control_step(
    plant: rig.Rig, law: DiscreteSystem, dt: float, step: SpeedStep, delay: int = 1
) -> Recording:
    """A pulse of the set-point with the law in the loop of a rig: the recording of its sensors and the estimates.

    ``delay``: samples of computing delay.
    """
    reference, channels = step.reference(dt), tuple(plant.sensors)
    recording, truth = rig.record(
        plant, law=law, speed_reference=reference, dt=dt, delay=delay, noise_seed=2, channels=channels
    )
    estimates = {n: truth.signals[n] for n in law.outputs if n.endswith("_estimated")}
    return replace(recording.with_signals("estimated", **estimates), events=truth.signals.events)


def judged_step(response: Recording, step: SpeedStep) -> dict[str, float | None]:
    """Metrics of the load speed, and the largest impact, from the step to the end of the pulse."""
    metrics = step_metrics(
        response.time,
        response["speed_load"],
        step.start,
        step.low,
        step.high,
        torque=response["torque_motor"],
        stop_time=step.stop,
    )
    judged = metrics.as_dict()
    if judged["rise_time"] is None:
        judged["overshoot"] = None  # not defined for a response that never reaches the set-point
    impacts = [
        abs(e.speed) for e in response.events if e.kind == "impact" and step.start <= e.time < step.stop
    ]
    return {**judged, "impact_speed": max(impacts, default=0.0)}


def validate(material: Material, found: Found, laws: Design) -> Validation:
    """Both validations."""
    observers, estimates = validate_observers(material, found)
    controllers, responses, step, problems = validate_controllers(material, found, laws)
    return Validation(observers, controllers, estimates, responses, step, problems)
