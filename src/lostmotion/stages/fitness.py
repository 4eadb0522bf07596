"""Whether a default law is worth having: it keeps its margin, is not far slower than PI, and settles."""

from __future__ import annotations

import math
from collections.abc import Mapping

from ..controllers import PiTuning
from ..controllers.tuning.symmetrical_optimum import LARGEST_SENSITIVITY
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..metrics import StepMetrics, step_metrics
from ..simulation import simulate
from ..systems import DiscreteSystem
from .speed_step import SpeedStep

#: A law whose slowest pole is so many times slower than the PI controller is of no use (option).
MUCH_SLOWER = 10.0
#: Steady error (fraction of the step) from which on a loop counts as not settling: the project's own target (option).
STEADY = 0.005
#: Largest overshoot in simulation, % of the step (calibrated on the development drives 3 to 99 of the zoo,
#: ``benchmarks/fitted_laws.py``, for 10 % on the drive itself: one with 10.0 simulated has 13, one with 7.9 has 8.4).
OVERSHOOT = 8.0
#: Friction where none is known, over the torque that turns the drive through the step in the step's time (option: less
#: than drives have; without a gap instead, a law that counts with the gap swings).
LITTLE_FRICTION = 0.1
#: A step that has not settled is simulated with twice the time, at most so often (option: four times).
JUDGED_DOUBLINGS = 2


def check_gains(tuning: PiTuning, largest_noise_gain: float) -> None:
    """Raise ``InvalidInput`` where no gains keep margin and noise on every drive that this one may be.

    ``largest_noise_gain``: standard deviation of the torque over that of the measured speed's noise, Nm s/rad.
    """
    if tuning.sensitivity > LARGEST_SENSITIVITY:
        got = "an unstable loop" if not tuning.stable else f"a sensitivity of {tuning.sensitivity:.2g}"
        raise InvalidInput("controller pi", f"{got} with any gains", f"at most {LARGEST_SENSITIVITY:g}", "")
    if tuning.noise_gain > largest_noise_gain:
        times = tuning.noise_gain / largest_noise_gain
        got = f"noise of the measured speed, {times:.2g} times what the torque may show, with any gains"
        raise InvalidInput("controller pi", got, "a torque that does not chatter", "")


def check_speed(slowest: float, filter_time: float) -> None:
    """Raise ``InvalidInput`` where a law is much slower than PI.

    Parameters
    ----------
    slowest : float, 1/s
        Decay rate of its slowest pole.
    filter_time : float, s
        Of PI's set-point filter, the slowest part of that loop; zero: there is none to compare with.
    """
    times = 1.0 / (slowest * filter_time) if filter_time > 0.0 else 0.0
    if times > MUCH_SLOWER:
        got = f"poles that keep the margin, but are {times:.0f} times slower than PI"
        raise InvalidInput("controller pole_placement", got, f"at most {MUCH_SLOWER:g} times", "")


def responses(
    law: DiscreteSystem, drives: Mapping[str, Drivetrain], step: SpeedStep, dt: float
) -> dict[str, StepMetrics]:
    """Of the load's speed, on each drive. Without friction a load would float in its gap for ever: it gets a little."""
    little = LITTLE_FRICTION * abs(step.high - step.low) / (step.stop - step.start)
    held = {
        what: drive if drive.coulomb > 0.0 else drive.with_parameters(coulomb=little * drive.inertia_total)
        for what, drive in drives.items()
    }
    return {what: _response(law, drive, step, dt) for what, drive in held.items()}


def _response(law: DiscreteSystem, drive: Drivetrain, step: SpeedStep, dt: float) -> StepMetrics:
    """With as much time as it takes to settle, if it does."""
    for _ in range(JUDGED_DOUBLINGS + 1):
        run = simulate(
            drive, law=law, dt=dt, delay=1, speed_reference=step.reference(dt), state=(0.0, step.low, step.low)
        )  # fmt: skip
        metrics = step_metrics(
            run.time, run["speed_load"], step.start, step.low, step.high, stop_time=step.stop
        )
        longer = step.longer(dt)
        if _settles(metrics) or longer == step:
            break
        step = longer
    return metrics


def _settles(metrics: StepMetrics) -> bool:
    return metrics.settling_time is not None and metrics.steady_error < STEADY


def overshoots(found: Mapping[str, StepMetrics]) -> bool:
    """Whether a load that settles goes too far beyond the set-point before."""
    return any(_settles(metrics) and metrics.overshoot > OVERSHOOT for metrics in found.values())


def check_responses(law: str, found: Mapping[str, StepMetrics]) -> None:
    """Raise ``InvalidInput`` where a load does not settle at the set-point, or goes far beyond it before."""
    for what, metrics in found.items():
        got = ""
        if not _settles(metrics):
            got = f"{percent_left(metrics.steady_error)} of the step left"
        elif metrics.overshoot > OVERSHOOT:
            got = f"an overshoot of {metrics.overshoot:.0f} % of the step"
        if got:
            expected = f"a load speed that settles at the set-point, with at most {OVERSHOOT:g} % overshoot"
            raise InvalidInput(f"controller {law} with {what}", got, expected, "")


def percent_left(error: float | None) -> str:
    """Of a step, for a message."""
    return f"{100.0 * error:.2g} %" if error is not None and math.isfinite(error) else "all"
