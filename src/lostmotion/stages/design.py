"""Stage 3, design: Observer 1 and 2, the PI speed controller, and the law for the target."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import Problem
from ..observers import kalman
from ..observers.estimates import ESTIMATES
from ..recording import Recording
from ..systems import DiscreteSystem
from .law_task import GIVEN, LawTask, controller_of, gains_of, landing_of, law_of, poles_of, tried
from .material import Material
from .parameters import OFF, Found
from .possible_drives import DECISIVE, not_told
from .speed_step import PAPER_STEP, SpeedStep, speed_step
from .target_law import Poles

#: Signals that each observer measures (Fietzek & Rinderknecht, section III).
OBSERVERS = {"observer_1": ("speed_motor",), "observer_2": ("torque_shaft", "speed_motor")}


@dataclass(frozen=True, eq=False)
class Design:
    """The laws and what they were designed with, or the reason why there is none.

    Parameters
    ----------
    law : DiscreteSystem or None
        Observer 1 + pole placement, for the target: speed_reference, speed_motor → torque_motor.
    watched : DiscreteSystem or None
        The same law with its estimates as further outputs.
    landing : DiscreteSystem or None
        The law with soft landing behind it, with its estimates as further outputs.
    pi : DiscreteSystem or None
    dt : float, s
    torque_limit : float, Nm
        inf: no limit.
    step : SpeedStep
        On which they are compared.
    taken : mapping of quantity → {"value", "unit", "source"}
        For ``results.json``.
    skipped, landing_skipped, pi_skipped : str
    problems : tuple of Problem
    """

    law: DiscreteSystem | None = None
    watched: DiscreteSystem | None = None
    landing: DiscreteSystem | None = None
    pi: DiscreteSystem | None = None
    dt: float = 0.0
    torque_limit: float = math.inf
    step: SpeedStep = PAPER_STEP
    taken: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    skipped: str = ""
    landing_skipped: str = ""
    pi_skipped: str = ""
    problems: tuple[Problem, ...] = ()


def design(material: Material, found: Found) -> Design:
    """The laws for an identified drivetrain; a law that cannot be designed is a result, not an exception."""
    drivetrain, settings = found.drivetrain, material.settings
    if drivetrain is None:
        return Design(skipped=found.missing, landing_skipped=found.missing, pi_skipped=found.missing)
    recording = material.identify or material.validate
    dt = settings.sample_time or (recording.dt if recording is not None else None)
    if dt is None:
        reason = "no sample time: give sample_time in [law]"
        return Design(skipped=reason, landing_skipped=reason, pi_skipped=reason)
    limit, limit_source = _torque_limit(material)
    task = LawTask(
        settings, drivetrain, dt, is_averaged(recording, found), limit, _speed_noise(found), not_told(found),
        _usual_torque(recording),
    )  # fmt: skip
    tuned, pi_problem = tried(lambda: gains_of(task, material.virtual), task.remedy)
    gains, gains_source = tuned or ({}, "")
    filter_time = gains.get("filter_time", 0.0)
    poles, law_problem = tried(lambda: poles_of(task, filter_time), task.remedy)
    step = PAPER_STEP
    if not material.virtual and (poles or filter_time):
        slowest = poles.slowest if poles else 1.0 / filter_time
        step = speed_step(recording, drivetrain, limit, slowest, filter_time, dt)
    law = watched = landing = controller = None
    landing_skipped = "no law that it could stand behind"
    if tuned:
        made, pi_problem = tried(lambda: controller_of(task, gains, step), task.remedy_of("kp and ki"))
        controller, gains = made or (None, gains)
    if poles:
        law, law_problem = tried(lambda: law_of(task, poles, step), task.remedy_of("poles"))
    if poles and law:
        watched = task.target(poles, ("torque_motor", *ESTIMATES))
        landing, landing_skipped = landing_of(task, poles, step)
    return Design(
        law=law,
        watched=watched,
        landing=landing,
        pi=controller,
        dt=dt,
        torque_limit=limit,
        step=step,
        taken=_taken(task, limit_source, poles, gains, gains_source, step),
        skipped=str(law_problem or ""),
        landing_skipped=landing_skipped,
        pi_skipped=str(pi_problem or ""),
        problems=tuple(p for p in (law_problem, pi_problem) if p is not None),
    )


def _torque_limit(material: Material) -> tuple[float, str]:
    """Torque limit, Nm, and its source."""
    if material.settings.torque_limit is not None:
        return material.settings.torque_limit, GIVEN
    largest = [
        float(np.max(np.abs(recording["torque_motor"])))
        for recording in (material.identify, material.validate)
        if recording is not None and "torque_motor" in recording
    ]
    return (
        (max(largest), "largest recorded motor torque") if largest else (math.inf, "no motor torque recorded")
    )


def _usual_torque(recording: Recording | None) -> float:
    """Median size of the recorded motor torque, Nm; zero where there is none."""
    if recording is None or "torque_motor" not in recording:
        return 0.0
    return float(np.median(np.abs(recording["torque_motor"])))


def _speed_noise(found: Found) -> float:
    """Standard deviation of the measured speed's noise, rad/s; zero where nothing was recorded."""
    return 0.0 if found.identification is None else _sensor_noise(found.identification.prediction.residual)


def _sensor_noise(innovations: NDArray[np.float64]) -> float:
    """Standard deviation of what changes from sample to sample, by the second differences, in the innovations' unit.

    Slow innovations are the model's error, which no law passes on as noise: their rms may be twenty times the sensor's.
    """
    return float(np.std(np.diff(innovations, 2))) / math.sqrt(6.0)  # of white noise: 1 + 4 + 1 variances


def _taken(
    task: LawTask,
    limit_source: str,
    poles: Poles | None,
    gains: Mapping[str, float],
    gains_source: str,
    step: SpeedStep,
) -> dict[str, dict[str, Any]]:
    """What the laws were designed with, each with its unit and its source."""
    units = {"kp": "Nm s/rad", "ki": "Nm/rad", "filter_time": "s", "speed_filter_time": "s"}
    given_time = GIVEN if task.settings.sample_time is not None else "the recording's"
    limit = task.torque_limit if math.isfinite(task.torque_limit) else None
    return {
        "sample_time": {"value": task.dt, "unit": "s", "source": given_time},
        "torque_limit": {"value": limit, "unit": "Nm", "source": limit_source},
        **_not_told(task),
        **({} if poles is None else _of_state_feedback(poles)),
        **{f"pi_{n}": {"value": v, "unit": units[n], "source": gains_source} for n, v in gains.items()},
        "step": {
            "value": [step.low, step.high], "unit": "rad/s",
            "source": "the paper's" if step is PAPER_STEP else "recorded speeds and torque limit",
        },
    }  # fmt: skip


def _not_told(task: LawTask) -> dict[str, dict[str, Any]]:
    names = [name for name in DECISIVE if name in task.unknown]
    if not names:
        return {}
    # Poles and gains of the user's are taken as they are.
    source = f"default poles and gains suit inertias and stiffness {OFF:g} times off, a longer lag, and any backlash"
    return {"not_told": {"value": names, "unit": "", "source": source}}


def _of_state_feedback(poles: Poles) -> dict[str, dict[str, Any]]:
    source = poles.source if poles.source == GIVEN else f"from the drive, limited by {poles.source}"
    return {
        "poles": {"value": [_text(pole) for pole in poles.values], "unit": "1/s", "source": source},
        "integral_action": {
            "value": "load torque, estimated by the law's observer, which is as fast as the poles", "unit": "",
            "source": "always",
        },
    }  # fmt: skip


def _text(pole: complex) -> str:
    pole = complex(pole)
    return f"{pole.real:.4g}" + (
        f" {'+' if pole.imag > 0.0 else '−'} {abs(pole.imag):.4g}j" if pole.imag else ""
    )


def is_averaged(recording: Recording | None, found: Found) -> bool:
    """Whether a recording's motor speed is a mean over the sample: as stated in it, else as identification found."""
    seen = found.identification is not None and found.identification.speed_from_counts
    return seen if recording is None else bool(recording.meta.get("speed_from_counts", seen))


def observer(drivetrain: Drivetrain, name: str, dt: float, averaged: bool) -> DiscreteSystem:
    """Observer 1 or 2 for a recording at the sample time dt (s)."""
    return kalman(drivetrain, measured=OBSERVERS[name], dt=dt, speed_from_counts=averaged)
