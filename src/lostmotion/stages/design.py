"""Stage 3, design: Observer 1 and 2, the PI speed controller, and the law for the target."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..controllers import pi, symmetrical_optimum
from ..controllers.soft_landing import approach_rate
from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..observers import kalman
from ..observers.estimates import ESTIMATES
from ..recording import Recording
from ..systems import DiscreteSystem
from .material import Material, Settings
from .parameters import Found
from .speed_step import PAPER_STEP, SpeedStep, speed_step
from .target_law import Poles, default_poles, target_law

#: Signals that each observer measures (Fietzek & Rinderknecht, section III).
OBSERVERS = {"observer_1": ("speed_motor",), "observer_2": ("torque_shaft", "speed_motor")}
#: Standard deviation of the torque that the sensor's noise may cause, over the torque limit (option).
RIPPLE = 0.02
#: The same of the approach-speed control in the gap, which acts for milliseconds (option; of the development drives of
#: the zoo those with 0.03 and less land, those with 2.3 and more chatter in the gap).
LANDING_RIPPLE = 0.5
#: Source of what the user has set.
GIVEN = "[law] in the TOML"


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
    averaged = is_averaged(recording, found)
    limit, limit_source = _torque_limit(material)
    noise = _speed_noise(found)
    noise_gain = RIPPLE * limit / noise if noise > 0.0 else math.inf
    poles = _poles(settings, drivetrain, dt, averaged, noise_gain)
    gains, gains_source = _pi_gains(material, drivetrain, dt, averaged, noise_gain)

    def target(outputs: tuple[str, ...], landing: bool = False) -> DiscreteSystem:
        return target_law(drivetrain, poles.values, limit, dt, averaged, outputs, landing=landing)

    own_poles = settings.poles is not None
    law, law_problem = _tried(
        lambda: target(("torque_motor",)),
        "Give a shorter sample_time under [law]" + (", or leave poles out." if own_poles else "."),
    )
    watched, _ = _tried(lambda: target(("torque_motor", *ESTIMATES)), "")
    landing, landing_skipped = _soft_landing(drivetrain, limit, noise, dt, target)
    controller, pi_problem = _tried(
        lambda: pi(dt=dt, torque_limit=limit, **gains),
        "Leave kp and ki out of [law]: the default is made for this drivetrain.",
    )
    step = PAPER_STEP
    if not material.virtual:
        step = speed_step(recording, drivetrain, limit, poles.slowest, gains.get("filter_time", 0.0), dt)
    return Design(
        law=law,
        watched=watched,
        landing=landing,
        pi=controller,
        dt=dt,
        torque_limit=limit,
        step=step,
        taken=_taken(dt, settings, (limit, limit_source), poles, gains, gains_source, step),
        skipped=str(law_problem or ""),
        landing_skipped=landing_skipped,
        pi_skipped=str(pi_problem or ""),
        problems=tuple(p for p in (law_problem, pi_problem) if p is not None),
    )


def _soft_landing(
    drivetrain: Drivetrain,
    torque_limit: float,
    noise: float,
    dt: float,
    target: Callable[..., DiscreteSystem],
) -> tuple[DiscreteSystem | None, str]:
    """The law with soft landing behind it, or why there is none; that is no problem of the user's."""
    if not drivetrain.backlash > 0.0:
        return None, "no backlash to land in"
    if math.isinf(torque_limit):
        return None, "no torque limit: give torque_limit in [law]"
    ripple = approach_rate(drivetrain.lag, dt) * drivetrain.inertia_motor * noise / torque_limit
    if ripple > LANDING_RIPPLE:
        return (
            None,
            f"the noise of the measured speed alone would ask for {100.0 * ripple:.0f} % of the torque limit",
        )
    law, problem = _tried(lambda: target(("torque_motor", *ESTIMATES), landing=True), "")
    return law, str(problem or "")


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


def _speed_noise(found: Found) -> float:
    """Standard deviation of the measured speed's noise, rad/s; zero where nothing was recorded."""
    return 0.0 if found.identification is None else _sensor_noise(found.identification.prediction.residual)


def _sensor_noise(innovations: NDArray[np.float64]) -> float:
    """Standard deviation of what changes from sample to sample, by the second differences, in the innovations' unit.

    Slow innovations are the model's error, which no law passes on as noise: their rms may be twenty times the sensor's.
    """
    return float(np.std(np.diff(innovations, 2))) / math.sqrt(6.0)  # of white noise: 1 + 4 + 1 variances


def _poles(settings: Settings, drivetrain: Drivetrain, dt: float, averaged: bool, noise_gain: float) -> Poles:
    if settings.poles is not None:
        return Poles(settings.poles, GIVEN)
    return default_poles(drivetrain, dt, averaged, noise_gain)


def _pi_gains(
    material: Material, drivetrain: Drivetrain, dt: float, averaged: bool, noise_gain: float
) -> tuple[dict[str, Any], str]:
    """Arguments of ``pi``, and their source."""
    settings = material.settings
    if settings.kp is not None and settings.ki is not None:
        source = "the paper's Table II" if material.virtual else GIVEN
        return {"kp": settings.kp, "ki": settings.ki}, source
    tuning = symmetrical_optimum(
        drivetrain, dt=dt, spread=None, speed_from_counts=averaged, largest_noise_gain=noise_gain
    )
    return dict(tuning.gains()), f"symmetrical optimum, spread {tuning.spread:.3g}"


def _taken(
    dt: float,
    settings: Settings,
    limit: tuple[float, str],
    poles: Poles,
    gains: Mapping[str, float],
    gains_source: str,
    step: SpeedStep,
) -> dict[str, dict[str, Any]]:
    """What the laws were designed with, each with its unit and its source."""
    units = {"kp": "Nm s/rad", "ki": "Nm/rad", "filter_time": "s", "speed_filter_time": "s"}
    source = poles.source if poles.source == GIVEN else f"from the drive, limited by {poles.source}"
    given_time = GIVEN if settings.sample_time is not None else "the recording's"
    return {
        "sample_time": {"value": dt, "unit": "s", "source": given_time},
        "torque_limit": {
            "value": limit[0] if math.isfinite(limit[0]) else None, "unit": "Nm", "source": limit[1],
        },
        "poles": {"value": [_text(pole) for pole in poles.values], "unit": "1/s", "source": source},
        "integral_action": {
            "value": "load torque, estimated by the law's observer, which is as fast as the poles", "unit": "",
            "source": "always",
        },
        **{f"pi_{n}": {"value": v, "unit": units[n], "source": gains_source} for n, v in gains.items()},
        "step": {
            "value": [step.low, step.high], "unit": "rad/s",
            "source": "the paper's" if step is PAPER_STEP else "recorded speeds and torque limit",
        },
    }  # fmt: skip


def _text(pole: complex) -> str:
    pole = complex(pole)
    return f"{pole.real:.4g}" + (
        f" {'+' if pole.imag > 0.0 else '−'} {abs(pole.imag):.4g}j" if pole.imag else ""
    )


def _tried(make: Callable[[], DiscreteSystem], remedy: str) -> tuple[DiscreteSystem | None, Problem | None]:
    """A law, or a warning why it cannot be designed, with the remedy in the words of the TOML."""
    try:
        return make(), None
    except InvalidInput as error:
        return None, replace(error.problem, severity="warning", remedy=remedy)


def is_averaged(recording: Recording | None, found: Found) -> bool:
    """Whether a recording's motor speed is a mean over the sample: as stated in it, else as identification found."""
    seen = found.identification is not None and found.identification.speed_from_counts
    return seen if recording is None else bool(recording.meta.get("speed_from_counts", seen))


def observer(drivetrain: Drivetrain, name: str, dt: float, averaged: bool) -> DiscreteSystem:
    """Observer 1 or 2 for a recording at the sample time dt (s)."""
    return kalman(drivetrain, measured=OBSERVERS[name], dt=dt, speed_from_counts=averaged)
