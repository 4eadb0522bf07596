"""Flatness-based speed control: a jerk-limited course of the load speed, its torque fed forward, feedback."""

from __future__ import annotations

import math

import numpy as np

from ..argument_checks import checks_arguments
from ..curves import saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem, connect
from ..systems.checks import sample_time
from .feedback.feedback_law import QuadraticFeedback, feedback_law
from .lqi import quadratic_feedback

#: Rate of the acceleration's follower as a multiple of that of the speed's (numerics: no overshoot from 4 on).
RATE_RATIO = 4.0


@checks_arguments
def speed_course(*, largest_acceleration: float, largest_jerk: float, dt: float) -> DiscreteSystem:
    """A course to the set-point within an acceleration (rad/s²) and a jerk (rad/s³), without overshoot.

    ::

        wished = clip(c·(speed_reference − speed_course), ±largest_acceleration)
        jerk_course = clip(4·c·(wished − acceleration_course), ±largest_jerk)
        acceleration_course⁺ = acceleration_course + dt·jerk_course
        speed_course⁺ = speed_course + dt·acceleration_course + ½·dt²·jerk_course

    with c = largest_jerk/(4·largest_acceleration).

    Returns
    -------
    DiscreteSystem
        Input speed_reference; outputs speed_course (rad/s), acceleration_course (rad/s²), jerk_course (rad/s³), all
        from the same sample on.

    Raises
    ------
    InvalidInput
        If a limit is not positive, or so large that the course would need steps beyond the sample time.
    """
    dt = sample_time("speed_course.dt", dt)
    for name, value in (("largest_acceleration", largest_acceleration), ("largest_jerk", largest_jerk)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidInput(
                f"speed_course.{name}", repr(value), "a positive number in SI units", "Check it."
            )
    rate = largest_jerk / (RATE_RATIO * largest_acceleration)
    if RATE_RATIO * rate * dt > 1.0:
        raise InvalidInput(
            "speed_course.largest_jerk", f"{largest_jerk:g} rad/s³",
            f"at most largest_acceleration/dt = {largest_acceleration / dt:g} rad/s³", "Lower it.",
        )  # fmt: skip
    fast = RATE_RATIO * rate
    return DiscreteSystem(
        inputs=("speed_reference",), outputs=("speed_course", "acceleration_course", "jerk_course"),
        states=("speed_course", "acceleration_course"), dt=dt, name="speed_course",
        curves=(saturation(largest_acceleration), saturation(largest_jerk)),
        F=np.array([[-rate, 0.0], [0.0, -fast]]), G=np.array([[rate], [0.0]]), H=np.array([[0.0, 0.0], [fast, 0.0]]),
        A=np.array([[1.0, dt], [0.0, 1.0]]), E=np.array([[0.0, 0.5 * dt**2], [0.0, dt]]),
        C=np.eye(3, 2), J=np.eye(3)[:, 1:] * np.array([0.0, 1.0]),
    )  # fmt: skip


@checks_arguments
def flatness(
    drivetrain: Drivetrain,
    *,
    dt: float,
    largest_acceleration: float,
    largest_jerk: float,
    largest_error: float,
    largest_torque: float,
    largest_oscillation: float | None = None,
    torque_limit: float = math.inf,
) -> DiscreteSystem:
    """Speed control along a jerk-limited course, by flatness: the load speed y is the flat output of the drivetrain.

    ::

        torque_shaft = inertia_load·y′ + friction − torque_load
        speed_motor  = y + inertia_load·y″/stiffness
        torque_motor = torque_shaft + inertia_motor·(speed_motor)′

    These are the states that belong to the course (``speed_course``), and the torque that holds the plant on it; the
    feedback of ``lqi`` acts on the difference alone. The third derivative of y is left out, the shaft's damping too.

    Parameters
    ----------
    drivetrain, dt, largest_error, largest_torque, largest_oscillation, torque_limit : as in ``lqi``
    largest_acceleration, largest_jerk : float, rad/s², rad/s³
        Of the course.

    Returns
    -------
    DiscreteSystem
        Inputs and output as those of ``lqi``.

    Raises
    ------
    InvalidInput
        As ``lqi`` and ``speed_course``.

    Notes
    -----
    Fliess, Lévine, Martin & Rouchon 1995, Int. J. Control 61, 1327–1361; for an elastic drivetrain: Thomsen & Fuchs
    2010, IEEE SPEEDAM, 1386–1391 (flatness with a jerk-limited course).
    """
    design = quadratic_feedback(
        drivetrain, dt, largest_error=largest_error, largest_torque=largest_torque,
        largest_oscillation=largest_oscillation,
    )  # fmt: skip
    along = feedback_law(
        "flatness", drivetrain, design, dt=dt, torque_limit=torque_limit, load_torque=True,
        further=_feedforward(drivetrain, design, dt),
    )  # fmt: skip
    course = speed_course(largest_acceleration=largest_acceleration, largest_jerk=largest_jerk, dt=dt)
    law = along.renamed({"speed_reference": "speed_course"})
    inputs = ("speed_reference", *(name for name in law.inputs if not name.endswith("_course")))
    return connect([course, law], inputs=inputs, outputs=("torque_motor",), name="flatness")


def _feedforward(drivetrain: Drivetrain, design: QuadraticFeedback, dt: float) -> dict[str, float]:
    """Torque per acceleration (Nm s²/rad) and jerk (Nm s³/rad) of the course."""
    k = dict(zip(design.states, design.gain, strict=True))
    torques = sum(value for name, value in k.items() if name.startswith("torque_"))
    load, total = drivetrain.inertia_load / drivetrain.stiffness, drivetrain.inertia_total
    # The torque leads, for it acts after delay, hold and current loop; the one before leads by the current loop alone.
    ahead = drivetrain.lag * (1.0 + k["torque_last"]) + 1.5 * dt
    return {
        "acceleration_course": k["twist"] * load + torques * total + total,
        "jerk_course": k["speed_motor"] * load + ahead * total,
    }
