"""Parameters of the observers with one sensor, the motor speed, and corrections that only contact lets through."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TypedDict

import numpy as np

from ...drivetrain import Drivetrain
from ...kernels.estimators.layout import Record
from ..arguments import known_options, positive
from ..filters.tuning import PROCESS_TORQUE
from ..filters.two_mass_parameters import FROZEN_MOVE, Parameters, model_parameters
from ..scale import scale_of

#: An innovation beyond this is a jump, rad/s; it grows by that rate while no sample is accepted, rad/s². Calibration:
#: the virtual rigs 1 to 4 with jumps of 8 rad/s for 20 ms, of which 98 % are refused; with half of the limit 99 %, with
#: double 64 %, and 96 to 99 % with double and half of the rate (benchmarks/calibrations.py). The limit is that of the
#: fixed gains.
JUMP_LIMIT, JUMP_LIMIT_RATE = 4.0, 800.0
#: Numerics: the sensor's noise adds so many of its standard deviations, which hardly ever occur.
OF_NOISE = 6.0
#: Numerics: largest share of the motor's error that a sample takes away, a margin to the stability limit of 2.
FASTEST = 0.7
#: Option: damping ratio of the errors of twist and load speed. Numerics: their rate over that at which the motor is
#: followed, since the correction takes that for immediate.
DAMPING_RATIO, SLOWER = 0.7, 0.33


class Following(TypedDict, total=False):
    """How the sliding observers follow the motor speed, each a keyword that may be left out.

    Attributes
    ----------
    bandwidth, damping_ratio : float, 1/s and –
        How errors of twist and load speed die out in contact; default √(k/J_l) and 0.7, less for a coarse encoder.
    sensor_noise : float, rad/s, or mapping
        Standard deviation of one sample of the motor speed, or ``{"speed_motor": …}`` as in ``extended_kalman``, with
        the same default.
    speed_from_counts : bool
        The measured motor speed is a difference of counts over dt: the innovation is that of the angle, over dt.
        Default False.
    """

    bandwidth: float | None
    damping_ratio: float | None
    sensor_noise: float | Mapping[str, float] | None
    speed_from_counts: bool


def speed_only_parameters(
    drivetrain: Drivetrain,
    dt: float,
    following: Following,
    layout: Record,
) -> Parameters:
    """The parameters of an observer with this layout, all but its own of them filled in."""
    known_options("following", following, Following)
    sensor_noise, speed_from_counts = following.get("sensor_noise"), following.get("speed_from_counts", False)
    if not isinstance(sensor_noise, Mapping | None):
        sensor_noise = {"speed_motor": sensor_noise}
    parameters = np.zeros((), layout)
    own, p = parameters["common"], parameters["common"]["common"]
    p[()] = model_parameters(drivetrain, ("speed_motor",), dt, sensor_noise, speed_from_counts)
    own["half_gap"], own["coulomb"] = 0.5 * drivetrain.backlash, drivetrain.coulomb
    scale = scale_of(drivetrain)
    still = p["still"][0]
    own["expected"] = (JUMP_LIMIT * scale.speed + OF_NOISE * still / FROZEN_MOVE) / p["gate"]
    own["growth"] = JUMP_LIMIT_RATE * scale.speed * scale.rate * dt / p["gate"]
    own["noise"], own["coarser"] = still / FROZEN_MOVE, OF_NOISE / p["gate"]
    return parameters


def load_corrections(drivetrain: Drivetrain, bandwidth: float, damping_ratio: float) -> tuple[float, float]:
    """Corrections of twist (s) and load speed per correction of the motor speed.

    Once the motor speed is followed, its correction ν shows the error of the twist, ν = −(k/J_m)·(twist error) with the
    gap closed. Feeding ν to both gives the errors of twist and load speed the poles s² + 2ζω s + ω².
    """
    k, jm, jl = drivetrain.stiffness, drivetrain.inertia_motor, drivetrain.inertia_load
    return -2.0 * damping_ratio * bandwidth * jm / k, (bandwidth**2 - k / jl) * jm / k


def default_poles(
    drivetrain: Drivetrain, share: float, dt: float, following: Following
) -> tuple[float, float]:
    """Bandwidth (1/s) and damping ratio of the errors of twist and load speed: as given, or the default.

    The default bandwidth is the frequency of the load on the held shaft: so the load speed needs no correction. The
    twist then settles at 2·damping ratio·bandwidth, by default DAMPING_RATIO, but no faster than a third of the rate at
    which the motor speed is followed, since the correction takes that for immediate.
    """
    bandwidth, damping_ratio = following.get("bandwidth"), following.get("damping_ratio")
    rate = math.sqrt(drivetrain.stiffness / drivetrain.inertia_load)
    rate = rate if bandwidth is None else positive("bandwidth", bandwidth)
    follow = -math.log(1.0 - share) / dt
    ratio = min(DAMPING_RATIO, SLOWER * follow / (2.0 * rate))
    return rate, ratio if damping_ratio is None else positive("damping_ratio", damping_ratio)


def follow_share(drivetrain: Drivetrain, p: Parameters) -> float:
    """Share of the motor's error that one sample takes away, at most FASTEST: the sensor's noise against the model's.

    That of a Kalman filter of the motor alone with ``tuning.PROCESS_TORQUE`` on it: (density of the acceleration /
    density of the sensor) to the power ¼ if it counts angles, ½ if speeds.
    """
    acceleration = (PROCESS_TORQUE["motor"] * scale_of(drivetrain).torque / drivetrain.inertia_motor) ** 2
    model = p["common"]["common"]
    power = 0.25 if model["counted"] else 0.5
    rate = (acceleration / (model["R"][0] * model["dt"])) ** power
    return min(1.0 - math.exp(-rate * model["dt"]), FASTEST)


def error_of_counts(p: Parameters) -> float:
    """Standard deviation of the innovation that the sensor alone makes, rad/s."""
    model = p["common"]["common"]
    return math.sqrt(model["R"][0]) / float(model["scale"][0])
