"""The laws that are compared: one list, each made from an identified drivetrain."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ... import controllers, observers
from ...controllers.soft_landing import approach_rate
from ...curves import saturation
from ...drivetrain import Drivetrain
from ...stages.target_law import default_poles, target_law
from ...systems import DiscreteSystem, Stepper, connect, rate_limit
from .work import LOAD_STEP, STEP_TO

Law = DiscreteSystem | Stepper

#: Process covariance of the load torque in the laws that feed it back, Nm²/s (calibrated on the virtual rigs 1 to 5:
#: a load step is back within 60 ms).
LOAD_TORQUE = 1e6
#: Highest frequency of a notch, in samples (numerics: half of the sample rate is the end).
HIGHEST_NOTCH = 0.4
#: Poles of the controller in the paper, 1/s (Fietzek & Rinderknecht, section V).
POLES = (-400.0, -400.0, -400.0)


@dataclass(frozen=True)
class Setting:
    """What every law is designed for: model, sample time (s), largest torque (Nm)."""

    model: Drivetrain
    dt: float
    torque_limit: float


@dataclass(frozen=True)
class Contestant:
    """One row of the leaderboard.

    Parameters
    ----------
    name : str
    kind : str
        "speed" or "torque": what its set-point is.
    control : callable (setting) → laws
        Controllers only; they read ``torque_motor_acting`` and the observer's estimates.
    observer : callable (setting) → law, or None
        None: the laws read the motor speed alone.
    """

    name: str
    kind: str
    control: Callable[[Setting], Sequence[Law]]
    observer: Callable[[Setting], Law] | None


def plain_observer(s: Setting) -> Law:
    """Observer 1 of the paper."""
    return observers.kalman(s.model, dt=s.dt, speed_from_counts=True)


def load_observer(s: Setting) -> Law:
    """Observer 1 with the load torque as a state."""
    return observers.kalman(
        s.model,
        dt=s.dt,
        speed_from_counts=True,
        load_torque=True,
        process_covariance={"torque_load": LOAD_TORQUE},
    )


#: How well the parameters are known at the start and how far they drift, in shares, where the observer tracks the load
#: inertia: stiffness, motor inertia, friction and backlash are held, for in the loop they can limit-cycle (calibrated
#: on the virtual rigs 1 and 2).
_HELD = dict.fromkeys(("stiffness", "inertia_motor", "coulomb", "backlash"), 1e-9)
ADAPTIVE: dict[str, Any] = {
    "uncertainty": {**_HELD, "inertia_load": 0.3},
    "drift": {**_HELD, "inertia_load": 0.01, "torque_load": 3.0},
}


def adaptive_observer(s: Setting) -> Law:
    """Extended Kalman filter that tracks load inertia and load torque."""
    return observers.extended_kalman(s.model, dt=s.dt, speed_from_counts=True, **ADAPTIVE)


def _pi(s: Setting, **options: Any) -> list[Law]:
    return [controllers.pi(dt=s.dt, torque_limit=s.torque_limit, **options)]


def _pi_optimum(s: Setting, friction: bool = False, **options: Any) -> list[Law]:
    gains: dict[str, Any] = controllers.symmetrical_optimum(s.model, dt=s.dt, **options).gains()
    return _pi(s, **gains, friction_of=s.model if friction else None)


def _pi_notch(s: Setting) -> list[Law]:
    gains: dict[str, Any] = controllers.symmetrical_optimum(s.model, dt=s.dt).gains()
    wished = controllers.pi(dt=s.dt, torque_limit=s.torque_limit, **gains).renamed(
        {"torque_motor": "torque_wished"}
    )
    # A drive that is sampled too slowly for its mode has none.
    frequency = min(s.model.pole_frequency, HIGHEST_NOTCH / s.dt)
    notch = controllers.notch("torque_wished", "torque_notched", frequency=frequency, dt=s.dt)
    # The notch swings beyond what went in.
    limit = DiscreteSystem(
        inputs=("torque_notched",), outputs=("torque_motor",), dt=s.dt, curves=(saturation(s.torque_limit),),
        G=np.eye(1), J=np.eye(1),
    )  # fmt: skip
    return [
        connect([wished, notch, limit], inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))
    ]


#: PI by its margins: a phase margin of 45° or more, and a sensitivity of 2 at most, torsional mode and gap included.
MARGIN: dict[str, Any] = {"spread": None, "speed_from_counts": True}


@functools.lru_cache(maxsize=64)
def _optimised_gains(s: Setting) -> dict[str, Any]:
    """By seconds of simulation, so once for each model."""
    return controllers.optimised_pi(
        s.model, dt=s.dt, torque_limit=s.torque_limit, speed=STEP_TO, torque_load=abs(LOAD_STEP),
        speed_from_counts=True,
    ).gains()  # fmt: skip


def _pi_optimised(s: Setting) -> list[Law]:
    return _pi(s, **_optimised_gains(s), friction_of=s.model)


@functools.lru_cache(maxsize=64)
def _run_law(s: Setting, landing: bool) -> DiscreteSystem:
    """What ``lostmotion run`` designs without any setting, its observer included."""
    poles = default_poles(s.model, s.dt, speed_from_counts=True).values
    landing = landing and s.model.backlash > 0.0
    return target_law(s.model, poles, s.torque_limit, s.dt, speed_from_counts=True, landing=landing)


def _pole_placement(s: Setting) -> list[Law]:
    return [controllers.pole_placement(s.model, poles=POLES, dt=s.dt, torque_limit=s.torque_limit)]


def behind(wished: DiscreteSystem, s: Setting, **options: Any) -> DiscreteSystem:
    """A law with soft landing behind it; the law alone where there is no gap."""
    if s.model.backlash == 0.0:
        return wished
    landing = controllers.soft_landing(s.model, dt=s.dt, torque_limit=s.torque_limit, **options)
    first = wished.renamed({"torque_motor": "torque_wished"})
    inputs = dict.fromkeys([*first.inputs, *landing.inputs])
    inputs.pop("torque_wished")
    return connect([first, landing], inputs=tuple(inputs), outputs=("torque_motor",))


def _soft(s: Setting, error: float, oscillation: float, **options: Any) -> list[Law]:
    return [behind(_lqi(s, error, oscillation), s, **options)]


def _bounded(s: Setting) -> list[Law]:
    return _soft(s, 2.37, 8.0, rate=BOUNDED_RATE * approach_rate(s.model.lag, s.dt), **BOUNDED)


def _wishes(s: Setting, error: float = 2.0, oscillation: float = 4.0) -> dict[str, Any]:
    return {
        "dt": s.dt, "largest_error": error, "largest_oscillation": oscillation, "largest_torque": s.torque_limit,
        "torque_limit": s.torque_limit,
    }  # fmt: skip


def _lqi(s: Setting, error: float = 2.0, oscillation: float = 4.0) -> DiscreteSystem:
    return controllers.lqi(s.model, **_wishes(s, error, oscillation))


def _scheduled(s: Setting, error: float = 2.0, oscillation: float = 4.0) -> Stepper:
    return controllers.scheduled_lqi(s.model, **_wishes(s, error, oscillation))


def _scheduled_soft(s: Setting) -> list[Law]:
    wished = _scheduled(s, 2.3, 8.0)
    if s.model.backlash == 0.0:
        return [wished]
    landing = controllers.soft_landing(s.model, dt=s.dt, torque_limit=s.torque_limit, **TOLERANT)
    return [wished.renamed({"torque_motor": "torque_wished"}), landing]


def _h_infinity(s: Setting) -> list[Law]:
    return [controllers.h_infinity(s.model, load_torque=10.0, margin=3.0, **_wishes(s))]


def _predictive(s: Setting) -> DiscreteSystem:
    return controllers.predictive(s.model, **_wishes(s, error=1.0))


def _hybrid_predictive(s: Setting, **options: Any) -> list[Law]:
    """The linear one where there is no gap to plan."""
    if s.model.backlash == 0.0:
        return [controllers.predictive(s.model, **_wishes(s, 1.0, 6.0))]
    return [controllers.hybrid_predictive(s.model, **_wishes(s, 1.0, 6.0), **options)]


def _flat(s: Setting, acceleration: float, jerk: float) -> list[Law]:
    # At a long sample time the course is slower.
    jerk = min(jerk, 0.9 * acceleration / s.dt)
    return [controllers.flatness(s.model, largest_acceleration=acceleration, largest_jerk=jerk, **_wishes(s))]


def _sliding_mode(s: Setting) -> list[Law]:
    return [controllers.sliding_mode(s.model, dt=s.dt, switching_torque=40.0, torque_limit=s.torque_limit)]


def _super_twisting(s: Setting) -> list[Law]:
    return [
        controllers.super_twisting(
            s.model, dt=s.dt, switching_torque=20.0, integral_rate=200.0, torque_limit=s.torque_limit
        )
    ]


def _damping(s: Setting) -> DiscreteSystem:
    return controllers.active_damping(s.model, dt=s.dt, torque_limit=s.torque_limit)


def _tip_landing(s: Setting) -> dict[str, Any]:
    return {**TIP_LANDING, "rate": TIP_RATE * approach_rate(s.model.lag, s.dt)}


def _ramp(s: Setting, slope: float) -> list[Law]:
    """The torque asked for, by at most so many Nm/s, with active damping."""
    ramp = rate_limit("torque_reference", "torque_ramp", rate=slope, dt=s.dt)
    return [ramp, _damping(s).renamed({"torque_reference": "torque_ramp"})]


def _tip(s: Setting) -> list[Law]:
    """The same with soft landing, and a ramp of its own."""
    damped = _damping(s).renamed({"torque_reference": "torque_ramp"})
    return [controllers.torque_ramp(dt=s.dt, **TIP_RAMP), behind(damped, s, **_tip_landing(s))]


#: Ramps of the torque that are compared, Nm/s (option: from what a passenger does not feel to a step).
RAMPS = (100.0, 300.0, 400.0, 500.0, 1000.0, 10000.0)
#: Ramp in front of soft landing, Nm/s (calibrated on the virtual rigs 1 to 40: the most that keeps the jerk of the load
#: below 45 krad/s³ in tip-in and tip-out; the fast part keeps the time in the gap below 10 ms on all of them).
TIP_RAMP: dict[str, float] = {"unwinding_rate": 4000.0, "winding_rate": 20000.0}
#: Its contact speed, rad/s, and release (calibrated likewise).
TIP_LANDING: dict[str, Any] = {"contact_speed": 0.4, "release": 4.0}
#: Its approach-speed control, as a share of the usual rate: with the little torque of a tip-in a slower one meets the
#: joint's own inertia at rest (calibrated likewise: 0.36 instead of 0.55 rad/s).
TIP_RATE = 0.8

#: Soft landing that stays below pole placement's impact where the backlash is known to ±20 % alone (calibrated on the
#: virtual rigs 1 to 5).
TOLERANT: dict[str, Any] = {"contact_speed": 0.5, "tolerance": 0.03, "release": 20.0}
#: Soft landing with the motor below the set-point. A limit that gives way slowly meets the edge of a gap that is wider
#: than known below pole placement's impact; it costs time, which a higher contact speed and a harder brake give back
#: (calibrated on the virtual rigs 1 to 40: of 35 settings that whose shares of pole placement's numbers are most
#: surely kept in the median of 20 rigs drawn from them).
BOUNDED: dict[str, Any] = {
    "motor_bounded": True,
    "contact_speed": 0.7,
    "braking_torque": 32.0,
    "release": 16.0,
}
#: Its approach-speed control, as a share of the usual rate: a slower one does not swing the joint's own inertia
#: (calibrated likewise: the impact is 0.3 rad/s less).
BOUNDED_RATE = 0.7
#: Soft landing near the bound of time: all of the torque brakes, and the limit gives way at once (calibrated on the
#: virtual rigs 1 to 4).
FAST: dict[str, Any] = {"contact_speed": 0.45, "release": 100.0, "braking_torque": 73.5}

#: Hybrid predictive control: impact speed of its plans, rad/s (calibrated on the virtual rigs 1 to 4).
HYBRID: dict[str, Any] = {"contact_speed": 0.4}

CONTESTANTS: tuple[Contestant, ...] = (
    Contestant("PI, Table II", "speed", _pi, None),
    Contestant("PI, symmetrical optimum", "speed", _pi_optimum, None),
    Contestant("PI, symmetrical optimum, friction", "speed", lambda s: _pi_optimum(s, friction=True), None),
    Contestant("PI, phase margin, friction", "speed", lambda s: _pi_optimum(s, True, **MARGIN), None),
    Contestant("PI, symmetrical optimum, notch", "speed", _pi_notch, None),
    Contestant("PI, optimised, friction", "speed", _pi_optimised, None),
    Contestant("pole placement", "speed", _pole_placement, plain_observer),
    Contestant("law of run", "speed", lambda s: [_run_law(s, False)], None),
    Contestant("law of run, soft landing", "speed", lambda s: [_run_law(s, True)], None),
    Contestant("LQI", "speed", lambda s: [_lqi(s)], load_observer),
    Contestant("H∞", "speed", _h_infinity, load_observer),
    Contestant("predictive", "speed", lambda s: [_predictive(s)], load_observer),
    Contestant("hybrid predictive", "speed", lambda s: _hybrid_predictive(s, **HYBRID), load_observer),
    Contestant("flat, 300 rad/s²", "speed", lambda s: _flat(s, 300.0, 1e5), load_observer),
    Contestant("flat, 100 rad/s²", "speed", lambda s: _flat(s, 100.0, 1e4), load_observer),
    Contestant("sliding mode", "speed", _sliding_mode, load_observer),
    Contestant("super-twisting", "speed", _super_twisting, load_observer),
    Contestant("soft landing", "speed", lambda s: _soft(s, 2.3, 8.0, contact_speed=0.5), load_observer),
    Contestant("soft landing, tolerant", "speed", lambda s: _soft(s, 2.3, 7.5, **TOLERANT), load_observer),
    Contestant("soft landing, bounded", "speed", _bounded, load_observer),
    Contestant("soft landing, fast", "speed", lambda s: _soft(s, 1.0, 6.0, **FAST), load_observer),
    Contestant("adaptive LQI", "speed", lambda s: [_scheduled(s)], adaptive_observer),
    Contestant("adaptive flat, 200 rad/s²", "speed", lambda s: _flat(s, 200.0, 4e4), adaptive_observer),
    Contestant("adaptive soft landing", "speed", _scheduled_soft, adaptive_observer),
    *(
        Contestant(f"ramp {rate:g} Nm/s, active damping", "torque", partial(_ramp, slope=rate), load_observer)
        for rate in RAMPS
    ),
    Contestant("ramp, active damping, soft landing", "torque", _tip, load_observer),
)
#: The law of the paper; the others are seen beside it.
REFERENCE = "pole placement"
