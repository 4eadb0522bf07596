"""Stage 3, design: what the laws are made for, and one function for each law; a default one must be worth having."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any, TypeVar

from ..controllers import pi, symmetrical_optimum
from ..controllers.soft_landing import approach_rate
from ..drivetrain import Drivetrain
from ..errors import InvalidInput, Problem
from ..metrics import StepMetrics
from ..observers.estimates import ESTIMATES
from ..systems import DiscreteSystem
from .fitness import check_gains, check_responses, check_speed, overshoots, responses
from .material import Settings
from .possible_drives import DECISIVE, possible_drives, simulated_drives
from .speed_step import SpeedStep
from .target_law import Poles, default_poles, target_law

T = TypeVar("T")

#: Standard deviation of the torque that the sensor's noise may cause, over the torque limit (option).
RIPPLE = 0.02
#: The same of the approach-speed control in the gap, which acts for milliseconds (option; of the development drives of
#: the zoo those with 0.03 and less land, those with 2.3 and more chatter in the gap).
LANDING_RIPPLE = 0.5
#: The set-point filter of PI is made so many times slower, in turn, where the load overshoots (option).
FILTERS = (1.0, 1.5, 2.25, 3.4)
#: Source of what the user has set.
GIVEN = "[law] in the TOML"


@dataclass(frozen=True)
class LawTask:
    """What the laws are made for: the model, how its speed is measured, and what is not known of it.

    Sample time (s), torque limit (Nm), standard deviation of the measured speed's noise (rad/s), median size of the
    recorded torque (Nm).
    """

    settings: Settings
    drivetrain: Drivetrain
    dt: float
    averaged: bool
    torque_limit: float
    noise: float
    unknown: frozenset[str]
    usual_torque: float = 0.0

    @property
    def noise_gain(self) -> float:
        """Largest standard deviation of the torque over that of the measured speed's noise, Nm s/rad."""
        return RIPPLE * self.torque_limit / self.noise if self.noise > 0.0 else math.inf

    @property
    def possible(self) -> tuple[Drivetrain, ...]:
        return possible_drives(self.drivetrain, self.unknown)

    def target(self, poles: Poles, outputs: tuple[str, ...], landing: bool = False) -> DiscreteSystem:
        """The target's law with these poles."""
        return target_law(
            self.drivetrain, poles.values, self.torque_limit, self.dt, self.averaged, outputs, landing=landing
        )

    def responses(self, law: DiscreteSystem, step: SpeedStep) -> dict[str, StepMetrics]:
        """Simulated on what the drive may be."""
        drives = simulated_drives(self.drivetrain, self.unknown, self.usual_torque)
        return responses(law, drives, step, self.dt)

    def worth_having(self, law: DiscreteSystem, step: SpeedStep, given: bool) -> DiscreteSystem:
        """The law; raises ``InvalidInput`` where its response is poor, unless the user has set what makes it."""
        if not given:
            check_responses(law.name, self.responses(law, step))
        return law

    @property
    def remedy(self) -> str:
        """For a default law that is not good enough: what keeps it from being better."""
        friction = self.drivetrain.coulomb + self.drivetrain.coulomb_motor
        if self.torque_limit <= friction:
            return f"Raise torque_limit under [law]: friction alone holds {friction:.3g} Nm."
        unsure = [name for name in DECISIVE if name in self.unknown]
        if not unsure:
            return "Give a shorter sample_time under [law]."
        return (
            f"The recording does not tell {', '.join(unsure)}: record a test that does, or give what is known well "
            "under [nameplate] and name it in fixed = [...] under [identify]."
        )

    def remedy_of(self, keys: str) -> str:
        """For a law that these keys of the TOML make, if they do."""
        given = self.settings.poles if keys == "poles" else self.settings.kp
        return (
            self.remedy
            if given is None
            else f"Leave {keys} out of [law]: the default is made for this drivetrain."
        )


def law_of(task: LawTask, poles: Poles, step: SpeedStep) -> DiscreteSystem:
    """The target's law, set-point and motor speed to motor torque."""
    return task.worth_having(task.target(poles, ("torque_motor",)), step, given=poles.source == GIVEN)


def controller_of(
    task: LawTask, gains: Mapping[str, Any], step: SpeedStep
) -> tuple[DiscreteSystem, dict[str, Any]]:
    """The PI controller with these arguments, and the arguments: default ones with a slower set-point filter where the
    load would overshoot."""
    if task.settings.kp is not None:
        return pi(dt=task.dt, torque_limit=task.torque_limit, **gains), dict(gains)
    for factor in FILTERS:
        slower = {**gains, "filter_time": factor * gains["filter_time"]}
        law = pi(dt=task.dt, torque_limit=task.torque_limit, **slower)
        found = task.responses(law, step)
        if not overshoots(found):
            break
    check_responses(law.name, found)
    return law, slower


def landing_of(task: LawTask, poles: Poles, step: SpeedStep) -> tuple[DiscreteSystem | None, str]:
    """The law with soft landing behind it, or why there is none; that is no problem of the user's."""
    reason = _reason_against_landing(task)
    if reason:
        return None, reason
    outputs, given = ("torque_motor", *ESTIMATES), poles.source == GIVEN
    law, problem = tried(
        lambda: task.worth_having(task.target(poles, outputs, landing=True), step, given=given), ""
    )
    return law, str(problem or "")


def _reason_against_landing(task: LawTask) -> str:
    if not task.drivetrain.backlash > 0.0:
        return "no backlash to land in"
    if "backlash" in task.unknown:
        return "the recording does not tell where the gap ends"
    if math.isinf(task.torque_limit):
        return "no torque limit: give torque_limit in [law]"
    rate = approach_rate(task.drivetrain.lag, task.dt)
    ripple = rate * task.drivetrain.inertia_motor * task.noise / task.torque_limit
    if ripple > LANDING_RIPPLE:
        return (
            f"the noise of the measured speed alone would ask for {100.0 * ripple:.0f} % of the torque limit"
        )
    return ""


def poles_of(task: LawTask, filter_time: float) -> Poles:
    """Those of the TOML, or the default, which must not be much slower than PI with this set-point filter (s)."""
    if task.settings.poles is not None:
        return Poles(task.settings.poles, GIVEN)
    poles = default_poles(task.drivetrain, task.dt, task.averaged, task.noise_gain, task.possible)
    check_speed(poles.slowest, filter_time)
    return poles


def gains_of(task: LawTask, virtual: bool) -> tuple[dict[str, Any], str]:
    """Arguments of ``pi``, and their source."""
    if task.settings.kp is not None and task.settings.ki is not None:
        source = "the paper's Table II" if virtual else GIVEN
        return {"kp": task.settings.kp, "ki": task.settings.ki}, source
    tuning = symmetrical_optimum(
        task.drivetrain,
        dt=task.dt,
        spread=None,
        speed_from_counts=task.averaged,
        largest_noise_gain=task.noise_gain,
        possible=task.possible,
    )
    check_gains(tuning, task.noise_gain)
    return dict(tuning.gains()), f"symmetrical optimum, spread {tuning.spread:.3g}"


def tried(make: Callable[[], T], remedy: str) -> tuple[T | None, Problem | None]:
    """What is made, or a warning why it cannot be designed, with the remedy in the words of the TOML."""
    try:
        return make(), None
    except InvalidInput as error:
        return None, replace(error.problem, severity="warning", remedy=remedy)
