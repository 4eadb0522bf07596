"""Gains of the PI speed controller from an identified drivetrain: the symmetrical optimum."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DesignModel, design_model
from ..systems.checks import sample_time


@dataclass(frozen=True)
class PiTuning:
    """Gains for ``pi``, and what they were made of.

    Parameters
    ----------
    kp : float, Nm s/rad
    ki : float, Nm/rad
    filter_time : float, s
        Of the set-point filter that belongs to them: it cancels the controller's zero.
    inertia : float, kg m2
        Of motor and load together.
    time_constant : float, s
        Sum of all small time constants, of which ``shaft_time`` is that of the shaft and ``delay_time`` that of current
        loop, computing delay and hold.
    shaft_time, delay_time : float, s
    stable : bool
        Whether the sampled loop is stable with the gap closed, torsional mode included. The optimum does not know the
        mode: late drives with little damping need a larger spread.
    """

    kp: float
    ki: float
    filter_time: float
    inertia: float
    time_constant: float
    shaft_time: float
    delay_time: float
    stable: bool

    def gains(self) -> dict[str, float]:
        """The arguments of ``pi``: kp, ki and filter_time."""
        return {"kp": self.kp, "ki": self.ki, "filter_time": self.filter_time}


@checks_arguments
def symmetrical_optimum(
    drivetrain: Drivetrain, *, dt: float, delay: int = 1, spread: float = 2.0
) -> PiTuning:
    """Symmetrical optimum of the motor-speed loop, with the shaft as its largest small time constant.

    ::

        T = 1/ω_zero + lag + (delay + ½)·dt        ω_zero = √(stiffness/inertia_load)
        kp = J/(a·T)        ki = kp/(a²·T)        filter_time = a²·T        J = inertia_motor + inertia_load

    The loop crosses at 1/(a·T), a factor a below 1/T: the load then turns with the motor. With the current loop's time
    constant alone the loop would cross above the shaft's zero and swing (measured on the virtual rig: 49 % overshoot).

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses, as identified.
    dt : float, s
    delay : int
        Samples of computing delay; half a sample of hold comes on top.
    spread : float
        a: 2 is the classical choice, larger is slower and better damped.

    Raises
    ------
    InvalidInput
        If there are not two masses, dt is not positive, the delay is negative or the spread not above 1.

    Notes
    -----
    Kessler 1958, Regelungstechnik 6, 395–400 and 432–436; Schröder 2009, Elektrische Antriebe – Regelung von
    Antriebssystemen (textbook form).
    """
    dt = sample_time("symmetrical_optimum.dt", dt)
    if not (isinstance(delay, int) and delay >= 0):
        raise InvalidInput(
            "symmetrical_optimum.delay", repr(delay), "zero or more samples", "Give a whole number."
        )
    if not (math.isfinite(spread) and spread > 1.0):
        raise InvalidInput("symmetrical_optimum.spread", repr(spread), "a number above 1", "2 is usual.")
    shaft = math.sqrt(drivetrain.inertia_load / drivetrain.stiffness)
    delays = drivetrain.lag + (delay + 0.5) * dt
    time = shaft + delays
    kp = drivetrain.inertia_total / (spread * time)
    ki = kp / (spread**2 * time)
    return PiTuning(
        kp=kp,
        ki=ki,
        filter_time=spread**2 * time,
        inertia=drivetrain.inertia_total,
        time_constant=time,
        shaft_time=shaft,
        delay_time=delays,
        stable=_is_stable(design_model(drivetrain, dt, delay), kp, ki),
    )


def _is_stable(model: DesignModel, kp: float, ki: float) -> bool:
    """Poles of the sampled loop of ``pi`` around the design model."""
    speed, n = model.row(speed_motor=1.0), len(model.states)
    loop = np.eye(n + 1)
    loop[:n, :n] = model.A - kp * np.outer(model.B, speed)
    loop[:n, n] = model.B
    loop[n, :n] = -model.dt * ki * speed
    return bool(np.max(np.abs(np.linalg.eigvals(loop))) < 1.0)
