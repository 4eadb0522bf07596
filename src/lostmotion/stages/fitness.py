"""Whether a default law is worth having: it keeps its margin, is not far slower than PI, and settles."""

from __future__ import annotations

import math

from ..controllers import PiTuning
from ..controllers.tuning.symmetrical_optimum import LARGEST_SENSITIVITY
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..metrics import step_metrics
from ..simulation import simulate
from ..systems import DiscreteSystem
from .speed_step import SpeedStep

#: A law whose slowest pole is so many times slower than the PI controller is of no use (option).
MUCH_SLOWER = 10.0
#: Steady error (fraction of the step) from which on a loop counts as not settling: the project's own target (option).
STEADY = 0.01
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


def settling(law: DiscreteSystem, drivetrain: Drivetrain, step: SpeedStep, dt: float) -> DiscreteSystem:
    """The law, if the load of its own model settles at the set-point; raises ``InvalidInput`` if not.

    Without friction the load floats in its gap, which no law prevents: such a model says nothing about it.
    """
    if drivetrain.backlash > 0.0 and not drivetrain.coulomb > 0.0:
        return law
    for _ in range(JUDGED_DOUBLINGS + 1):
        response = simulate(
            drivetrain, law=law, dt=dt, delay=1, speed_reference=step.reference(dt), state=(0.0, step.low, step.low)
        )  # fmt: skip
        metrics = step_metrics(
            response.time, response["speed_load"], step.start, step.low, step.high, stop_time=step.stop
        )
        if metrics.settling_time is not None and metrics.steady_error < STEADY:
            return law
        longer = step.longer(dt)
        if longer == step:
            break
        step = longer
    where = f"controller {law.name} with its own model"
    got = f"{percent_left(metrics.steady_error)} of the step left after {step.stop - step.start:.3g} s"
    raise InvalidInput(where, got, "a load speed that settles at the set-point", "")


def percent_left(error: float | None) -> str:
    """Of a step, for a message."""
    return f"{100.0 * error:.2g} %" if error is not None and math.isfinite(error) else "all"
