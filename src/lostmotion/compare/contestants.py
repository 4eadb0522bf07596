"""The observers that are compared: one list, each made from a drivetrain and the data sheets of the sensors."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from .. import observers
from ..drivetrain import Drivetrain
from ..observers.filters.extended_kalman import extended_kalman
from ..observers.filters.interacting_models import interacting_models
from ..observers.filters.moving_horizon import moving_horizon
from ..observers.filters.unscented_kalman import unscented_kalman
from ..observers.motor_speed.neural_network import neural_network
from ..observers.motor_speed.sliding_mode import sliding_mode
from ..observers.motor_speed.super_twisting import super_twisting
from ..observers.scale import mode_rate
from ..recording import Recording


class Runs(Protocol):
    """What every observer is here: DiscreteSystem and Stepper alike."""

    @property
    def inputs(self) -> tuple[str, ...]: ...

    def run(self, data: Recording) -> Recording: ...


@dataclass(frozen=True)
class Sensing:
    """What an observer is given about the sensors.

    Parameters
    ----------
    dt : float, s
    averaged : bool
        The motor speed is a mean over the last sample.
    speed_noise : float, rad/s
        Standard deviation of one sample of the motor speed, from the encoder's resolution.
    torque_noise : float, Nm
        The same for the torque sensor on the shaft.
    """

    dt: float
    averaged: bool
    speed_noise: float
    torque_noise: float


@dataclass(frozen=True)
class Contestant:
    """One row of the leaderboard.

    Parameters
    ----------
    name : str
        Unique; key of the tables.
    kind : str
        "naive", "fixed gain" or "stepper".
    make : callable (drivetrain, sensing) → observer
    """

    name: str
    kind: str
    make: Callable[[Drivetrain, Sensing], Runs]


class MotorSpeed:
    """The motor speed taken as load speed: what a drive without an observer has."""

    inputs = ("torque_motor", "speed_motor")

    def run(self, data: Recording) -> Recording:
        speed = data["speed_motor"]
        good = np.isfinite(speed)
        held = speed[np.maximum.accumulate(np.where(good, np.arange(speed.size), 0))]
        return Recording(
            time=data.time,
            signals={"speed_load_estimated": held, "speed_motor_estimated": held},
            origin=dict.fromkeys(("speed_load_estimated", "speed_motor_estimated"), "estimated"),
        )


def _kalman(d: Drivetrain, s: Sensing, measured: tuple[str, ...] = ("speed_motor",), **options: Any) -> Runs:
    return observers.kalman(d, measured=measured, dt=s.dt, speed_from_counts=s.averaged, **options)


#: Of either end (physics).
NO_FRICTION = dict.fromkeys(("coulomb", "viscous", "coulomb_motor", "viscous_motor"), 0.0)
#: Process covariance of "load torque, fast" (calibrated by search: the smallest worst error of load speed and shaft
#: torque on rigs 1 to 3 with any one parameter off by 20 %).
FAST = {"twist": 72.0, "speed_motor": 1e7, "speed_load": 42.0, "torque_load": 8.5}


def _fast(d: Drivetrain, s: Sensing) -> Runs:
    return _kalman(d, s, load_torque=True, process_covariance=FAST)


#: κ of "injection" times the closed shaft's angular frequency (calibrated on Table I by
#: ``certificates.best_injection``: the largest share of the gap's slope with known friction).
INJECTION = 0.94


def _injection(d: Drivetrain, s: Sensing) -> Runs:
    return _kalman(d, s, injection={"speed_motor": INJECTION / mode_rate(d)})


def _stepper(make: Callable[..., Runs], **options: Any) -> Callable[[Drivetrain, Sensing], Runs]:
    """A stepper that takes the noise of its sensors from the data sheets."""

    def made(d: Drivetrain, s: Sensing) -> Runs:
        noise = {"speed_motor": s.speed_noise, "torque_shaft": s.torque_noise}
        given = {name: noise[name] for name in options.get("measured", ("speed_motor",))}
        return make(d, dt=s.dt, speed_from_counts=s.averaged, sensor_noise=given, **options)

    return made


#: Observer that all others are compared with.
REFERENCE = "Observer 1"

CONTESTANTS: tuple[Contestant, ...] = (
    Contestant("motor speed", "naive", lambda d, s: MotorSpeed()),
    Contestant("without backlash", "naive", lambda d, s: _kalman(d.with_parameters(backlash=0.0), s)),
    Contestant("without friction", "naive", lambda d, s: _kalman(d.with_parameters(**NO_FRICTION), s)),
    Contestant(REFERENCE, "fixed gain", _kalman),
    Contestant("Observer 2", "fixed gain", lambda d, s: _kalman(d, s, ("torque_shaft", "speed_motor"))),
    Contestant(
        "Observer 2, load torque",
        "fixed gain",
        lambda d, s: _kalman(d, s, ("torque_shaft", "speed_motor"), load_torque=True),
    ),
    Contestant("load torque", "fixed gain", lambda d, s: _kalman(d, s, load_torque=True)),
    Contestant("scheduled", "fixed gain", lambda d, s: _kalman(d, s, contact_scheduling=True)),
    Contestant(
        "load torque, scheduled",
        "fixed gain",
        lambda d, s: _kalman(d, s, load_torque=True, contact_scheduling=True),
    ),
    Contestant("load torque, fast", "fixed gain", _fast),
    Contestant("injection", "fixed gain", _injection),
    Contestant(
        "H∞", "fixed gain", lambda d, s: observers.h_infinity(d, dt=s.dt, speed_from_counts=s.averaged)
    ),
    Contestant(
        "H∞, load torque",
        "fixed gain",
        lambda d, s: observers.h_infinity(d, dt=s.dt, speed_from_counts=s.averaged, load_torque=True),
    ),
    Contestant(
        "disturbance observer",
        "fixed gain",
        lambda d, s: observers.disturbance_observer(d, dt=s.dt, speed_from_counts=s.averaged),
    ),
    Contestant("extended Kalman", "stepper", _stepper(extended_kalman)),
    Contestant(
        "extended Kalman, both sensors",
        "stepper",
        _stepper(extended_kalman, measured=("torque_shaft", "speed_motor")),
    ),
    Contestant("unscented Kalman", "stepper", _stepper(unscented_kalman)),
    Contestant("interacting models", "stepper", _stepper(interacting_models)),
    Contestant("moving horizon", "stepper", _stepper(moving_horizon)),
    Contestant("sliding mode", "stepper", _stepper(sliding_mode)),
    Contestant("super-twisting", "stepper", _stepper(super_twisting)),
    Contestant("neural network", "stepper", _stepper(neural_network)),
)
