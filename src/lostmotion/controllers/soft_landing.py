"""Soft landing: limits the speed at which the gap closes, behind any law that wishes a torque."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..curves import PiecewiseLinear, saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from .feedback.curve_chain import CurveChain

Array = NDArray[np.float64]

#: The approach-speed control acts within lag + dt, but not within less than this many samples (calibrated on the
#: virtual rigs 1 to 5).
LEAST_SAMPLES = 4.0
#: Torque kept for braking, as a share of the torque limit: the rest is for model errors (calibrated
#: likewise).
BRAKING_SHARE = 0.9
#: Torque allowed per estimated shaft torque, once the shaft is wound (calibrated likewise).
RELEASE = 10.0
#: Torque allowed per estimated shaft torque by the bound of the motor's speed (calibrated on the virtual rigs 1 to 5:
#: 1 costs 0.2 ms of t90, 4 lets the motor run 0.4 rad/s beyond the set-point while the shaft winds up).
BOUND_RELEASE = 2.0
#: Steepest fall of the approach speed with the distance, as a share of the control's rate. The feedforward of braking
#: then never takes more than this share of the speed: the motor cannot stall before the edge (numerics).
STEEPEST = 0.5
#: The motor's Coulomb friction counts so many times. A torque on its way counts as motion, which a motor at rest does
#: not make: K·(lag + dt)/J ≤ 1 times the torque is missing, so a motor starts from twice its friction on (physics).
FRICTION_RESERVE = 2.0
#: Default of ``patience``: times of a crossing from edge to edge at the contact speed (option: that is the slowest
#: crossing there is, and the friction may hold the motor up for as long again).
PATIENCE = 2.0
#: A limit counts as holding a torque back from this share of the torque limit on (numerics: less is left to an integral
#: action); with little patience from more on, so that each sample opens it by so much of what it holds (numerics: from
#: 2 on it would chatter).
HELD, OPENED = 0.01, 0.5
#: Points of the braking parabola (numerics: on the paper's rig the chords then lie up to 2 % below it).
POINTS = 8

_INPUTS = (
    "torque_wished",
    "twist_estimated",
    "twist_elastic_estimated",
    "speed_motor_estimated",
    "speed_load_estimated",
    "torque_motor_acting",
)


@checks_arguments
def soft_landing(
    drivetrain: Drivetrain,
    *,
    dt: float,
    contact_speed: float,
    torque_limit: float,
    braking_torque: float | None = None,
    rate: float | None = None,
    release: float = RELEASE,
    tolerance: float = 0.0,
    patience: float | None = None,
    backlash_estimated: bool = False,
    motor_bounded: bool = False,
) -> DiscreteSystem:
    """Limit of the approach speed in the gap: torque_motor = max(min(torque_wished, U₊), −U₋) within ±torque_limit.

    ::

        U₊ = K·(W(h − x) − w) + M + release·stiffness·max(twist_elastic, 0) + G      U₋ likewise, with all signs turned
        W(s) = V(s)·(1 − V′(s)·J/K)                V·V′ = min(a, c·V) from V(0) = v on, V = v behind the edge
        w = speed_motor − speed_load + (lag·torque_actuator + dt·torque_motor_acting)/J
        x = twist + lag·(speed_motor − speed_load) + dt·(w − dt·torque_motor_acting/(2·J))

    J is the motor's inertia, h half the backlash, K = rate·J, a = braking_torque/J, v = contact_speed, c = rate/2.
    w and x are speed and distance after the torque that is on its way: under lag and one sample of delay the motor in
    the gap is a double integrator of the next torque. V is the speed from which the motor can brake to v with the
    deceleration a, straight near the edge, where the parabola would be steeper than the control can follow; W carries
    the braking torque as feedforward. Once the shaft is wound the limit gives way with its torque, and the wished
    torque goes through.

    No crossing lasts for ever: a limit that still holds a torque back after the ``patience`` takes a shaft in contact
    for one in the gap, as it may where an observer has missed the contact. G then opens it. ``held`` is 1 − e⁻¹ after
    that time, and falls as slowly::

        patience·d(held)/dt = b − held      b = 1 while U₊ holds a torque back, −1 while U₋ does, else 0
        G = torque_limit·e·max(held − (1 − e⁻¹), 0)

    To cross the gap in least time the motor runs beyond the set-point. ``motor_bounded`` keeps it below, in the gap
    and while the shaft winds up; small steps of the set-point still cross the gap with the contact speed::

        U₊ = min(U₊, K·(max(speed_reference − speed_load, v) − w) + M + BOUND_RELEASE·stiffness·max(twist_elastic, 0))

    A hard brake swings the inertia between shaft and joint, which then meets the edge with the speed that it has by
    chance. Behind a bound there is less speed to brake, so take less ``braking_torque``.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
    contact_speed : float, rad/s
        Speed v at which the gap may close.
    torque_limit : float, Nm
    braking_torque : float, Nm
        Kept for braking; default ``BRAKING_SHARE``·torque_limit.
    rate : float, 1/s
        Of the approach-speed control; default 1/(lag + dt), at most 1/(``LEAST_SAMPLES``·dt).
    release : float
        Torque allowed per shaft torque; at 1 + rate·(lag + dt) or below the limit would hold back a steady torque.

    tolerance : float
        Share of the backlash by which the gap may be narrower than known: so much earlier v is reached. The crossing
        takes longer by tolerance·backlash/v.
    patience : float, s
        Time for which a torque may be held back; default ``PATIENCE``·backlash/v.
    backlash_estimated : bool
        Read the backlash from an observer that tracks it, as one more input ``backlash_estimated`` (rad).
    motor_bounded : bool
        Keep the motor below the set-point, one more input ``speed_reference`` (rad/s).

    Returns
    -------
    DiscreteSystem
        Inputs torque_wished, twist_estimated, twist_elastic_estimated, speed_motor_estimated, speed_load_estimated,
        torque_motor_acting (what acts from this sample on, see ``lqi``), and those asked for; output torque_motor;
        states torque_actuator, where the drivetrain has a lag, and held.

    Raises
    ------
    InvalidInput
        If there are not two masses with backlash, a number is not positive, the rate is beyond 1/dt, or the release too
        small.

    Notes
    -----
    The load's acceleration is left out: on the paper's rig 10 Nm at the load shift the contact speed by 0.03 rad/s. The
    motor's Coulomb friction counts as if it always held the motor back, ``FRICTION_RESERVE`` times, or the motor would
    come to rest in the gap: U₊ has that torque M on top. So the gap closes faster than wished, by M/K or less where the
    friction holds back, by 1.5·M/K where it helps.
    """
    braking_torque = BRAKING_SHARE * torque_limit if braking_torque is None else braking_torque
    rate = approach_rate(drivetrain.lag, dt) if rate is None else rate
    _check(drivetrain, dt, rate, release, tolerance, contact_speed=contact_speed, torque_limit=torque_limit,
           braking_torque=braking_torque)  # fmt: skip
    patience = PATIENCE * drivetrain.backlash / contact_speed if patience is None else patience
    if not patience > 0.0:
        raise InvalidInput("soft_landing.patience", repr(patience), "more than 0 s", "Leave it out.")
    inertia, lag = drivetrain.inertia_motor, drivetrain.lag
    gain = rate * inertia
    further = ["backlash_estimated"] * backlash_estimated + ["speed_reference"] * motor_bounded
    inputs = (*_INPUTS, *further)
    states = ("torque_actuator", "held") if lag > 0.0 else ("held",)
    net = CurveChain((*states, *inputs))
    one = net.signals
    speed, distance = _after_the_delay(one, inertia, lag, dt)
    elastic, wished = one["twist_elastic_estimated"], one["torque_wished"]
    # The curve is over the way to the edge; a known edge is in the curve, an estimated one in its argument.
    half = 0.5 * one["backlash_estimated"] if backlash_estimated else 0.0 * distance
    edge = (0.0 if backlash_estimated else 0.5 * drivetrain.backlash) - tolerance * drivetrain.backlash
    motor = drivetrain.frictions[0]
    friction = FRICTION_RESERVE * max(motor.coulomb_plus, motor.coulomb_minus)
    approach = _approach(
        drivetrain.backlash, edge, contact_speed, braking_torque / inertia, rate, gain, friction
    )
    upper, lower = net.both(approach, -distance, half)
    wound = net.both(_beyond(0.0, release * drivetrain.stiffness), elastic)
    upper, lower = upper + wound[0] - gain * speed, lower + wound[1] + gain * speed
    if motor_bounded:
        error = one["speed_reference"] - one["speed_load_estimated"]
        ahead_of_load = net.both(_beyond(contact_speed, gain, friction), error)
        wound = net.both(_beyond(0.0, BOUND_RELEASE * drivetrain.stiffness), elastic)
        upper = net.least(upper, ahead_of_load[0] + wound[0] - gain * speed)
        lower = net.least(lower, ahead_of_load[1] + wound[1] + gain * speed)
    opened = net.both(_opening(torque_limit), one["held"])
    upper, lower = upper + opened[0], lower + opened[1]
    torque = -net.least(-net.least(wished, upper), lower)
    binds = PiecewiseLinear(((0.0, 0.0), (torque_limit * max(HELD, math.e * dt / patience / OPENED), 1.0)))
    direction = net.curve(binds, wished - upper) - net.curve(binds, -wished - lower)
    torque = net.curve(saturation(torque_limit), torque)
    following = {"held": _lag(one["held"], direction, patience, dt)}
    if lag > 0.0:
        following = {
            "torque_actuator": _lag(one["torque_actuator"], one["torque_motor_acting"], lag, dt),
            **following,
        }
    return net.system("soft_landing", torque, inputs, dt, following)


def _after_the_delay(one: Mapping[str, Array], inertia: float, lag: float, dt: float) -> tuple[Array, Array]:
    """Speed and twist of the motor against the load after the torque that is on its way, over the signals."""
    closing, acting = one["speed_motor_estimated"] - one["speed_load_estimated"], one["torque_motor_acting"]
    coming = lag * one["torque_actuator"] + dt * acting if lag > 0.0 else dt * acting
    speed = closing + coming / inertia
    ahead = speed - 0.5 * dt / inertia * acting
    return speed, one["twist_estimated"] + lag * closing + dt * ahead


def _lag(state: Array, follows: Array, time_constant: float, dt: float) -> Array:
    """The state one sample later that follows another signal."""
    decay = math.exp(-dt / time_constant)
    return np.asarray(decay * state + (1.0 - decay) * follows)


def _opening(torque_limit: float) -> PiecewiseLinear:
    """Torque that opens a limit which holds it back for too long, from ``held`` on: 0 … 1 → Nm."""
    return PiecewiseLinear(((1.0 - math.exp(-1.0), 0.0),), 0.0, math.e * torque_limit)


def _beyond(level: float, slope: float, offset: float = 0.0) -> PiecewiseLinear:
    """slope·max(z, level) + offset."""
    return PiecewiseLinear(((level, slope * level + offset),), 0.0, slope)


def approach_rate(lag: float, dt: float) -> float:
    """Rate (1/s) of the approach-speed control by default; lag and dt in s."""
    return 1.0 / max(lag + dt, LEAST_SAMPLES * dt)


def _approach(
    backlash: float, edge: float, contact: float, braking: float, rate: float, gain: float, friction: float
) -> PiecewiseLinear:
    """K·W + friction over the way to the edge − ``edge``: rad → Nm.

    The points of the parabola lie at equal steps of the speed.
    """
    corner = max(contact, braking / (STEEPEST * rate))
    straight = (corner - contact) / (STEEPEST * rate)
    top = math.sqrt(corner**2 + 2.0 * braking * backlash)
    parabola = np.linspace(corner, top, POINTS)
    s = straight + (parabola**2 - corner**2) / (2.0 * braking)
    w = parabola - braking / rate
    if straight > 0.0:
        s, w = np.append(0.0, s), np.append(contact * (1.0 - STEEPEST), w)
    behind = contact / rate
    points = np.column_stack([np.append(-behind, s) - edge, gain * np.append(contact, w) + friction])
    slope = float(np.diff(points[-2:, 1])[0] / np.diff(points[-2:, 0])[0])
    return PiecewiseLinear(tuple((float(a), float(b)) for a, b in points), 0.0, slope)


def _check(
    drivetrain: Drivetrain, dt: float, rate: float, release: float, tolerance: float, **torques: float
) -> None:
    for name, value in {"dt": dt, "rate": rate, **torques}.items():
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidInput(
                f"soft_landing.{name}", repr(value), "a positive number in SI units", "Check the unit."
            )
    if not drivetrain.backlash > 0.0:
        raise InvalidInput("soft_landing", "a drivetrain without backlash", "a gap", "Leave the limiter out.")
    if rate * dt > 1.0:
        raise InvalidInput(
            "soft_landing.rate", f"{rate:g} 1/s", f"at most 1/dt = {1.0 / dt:g} 1/s", "Lower it."
        )
    least = 1.0 + rate * (drivetrain.lag + dt)
    if not 0.0 <= tolerance < 1.0:
        raise InvalidInput(
            "soft_landing.tolerance", f"{tolerance!r}", "0 or a share below 1", "0.05 is usual."
        )
    if not release > least:
        raise InvalidInput("soft_landing.release", f"{release:g}", f"more than {least:.3g}", "Raise it.")
