"""What makes a drive of the zoo: every range in one place, each number drawn from the seed and its own name."""

from __future__ import annotations

import math
import zlib
from dataclasses import dataclass

import numpy as np

#: Seeds. Rules and constants are found on the development drives, the inflation of intervals on the calibration
#: drives. The test drives are run once for each change of rules, and never looked into.
DEVELOPMENT, CALIBRATION, TEST = range(0, 10_000), range(10_000, 20_000), range(20_000, 30_000)
SETS = {"development": DEVELOPMENT, "calibration": CALIBRATION, "test": TEST}

#: Log-uniform ranges: from a small servo axis to a mill drive.
INERTIA = (1e-5, 1e3)  # total, kg m2 (option)
RATIO = (1.0 / 30.0, 30.0)  # load over motor (option)
POLE = (5.0, 500.0)  # first torsional frequency, Hz (option)
DAMPING_RATIO = (0.001, 0.1)  # option
BACKLASH = (0.05, 10.0)  # times the wind-up at rated torque (option)
COULOMB = (0.002, 0.3)  # of rated torque (option)
VISCOUS = (0.001, 0.1)  # of rated torque, at rated speed (option)
SECOND_MODE = (1.5, 15.0)  # times the first (option)
SAMPLES_PER_PERIOD = (6.0, 200.0)  # option
DURATION = (2.0, 60.0)  # s (option)
ACCELERATION_TIME = (0.1, 1.0)  # from rest to rated speed with rated torque, s (option)
RATED_SPEED = (10.0, 500.0)  # rad/s (option)
SPEED_NOISE = (1e-5, 1e-2)  # of rated speed, sensors without counts (option)
TORQUE_NOISE = (1e-4, 1e-2)  # of rated torque, measured torque (option)
LOAD_TORQUE = (0.02, 0.3)  # of rated torque (option)
#: Uniform ranges (option).
LAG = DELAY = (0.0, 2e-3)  # s
ENCODER_BITS = (12, 24)  # option
#: The nameplate is off by up to this factor either way, each value for itself (option).
NAMEPLATE = 3.0

#: Torsional periods in a recording at least; rows at most (option: what the slowest of the ranges above need).
LEAST_PERIODS, MOST_ROWS = 200, 250_000
#: Wind-up at rated torque at most, rad (option: 11°, a rubber coupling); the rated speed is lowered for it.
MOST_WIND_UP = 0.2

LAWS = ("viscoelastic", "dead_zone", "limited", "clipped", "physical")


class Draw:
    """Random numbers of one drive, each from the seed and its name alone: a new one changes no other."""

    def __init__(self, seed: int) -> None:
        self.seed = seed

    def stream(self, name: str) -> np.random.Generator:
        return np.random.default_rng([self.seed, zlib.crc32(name.encode())])

    def uniform(self, name: str, low: float, high: float) -> float:
        return float(self.stream(name).uniform(low, high))

    def log_uniform(self, name: str, bounds: tuple[float, float]) -> float:
        return math.exp(self.uniform(name, math.log(bounds[0]), math.log(bounds[1])))

    def happens(self, name: str, probability: float) -> bool:
        return self.uniform(name, 0.0, 1.0) < probability

    def choice(self, name: str, weights: dict[str, float]) -> str:
        return str(self.stream(name).choice(list(weights), p=np.array(list(weights.values()))))

    def near(self, name: str, value: float) -> float:
        """A nameplate's number."""
        return value * self.log_uniform(name, (1.0 / NAMEPLATE, NAMEPLATE))


@dataclass(frozen=True)
class Rating:
    """Rated torque (Nm) and speed (rad/s): the torque reaches the speed within ``acceleration_time`` (s)."""

    torque: float
    speed: float
    acceleration_time: float


def rating(draw: Draw, inertia: float, stiffness: float) -> Rating:
    """The rating of a drive of this total inertia (kg m2) and stiffness (Nm/rad; inf: rigid)."""
    time = draw.log_uniform("acceleration_time", ACCELERATION_TIME)
    speed = min(draw.log_uniform("rated_speed", RATED_SPEED), MOST_WIND_UP * stiffness * time / inertia)
    return Rating(inertia * speed / time, speed, time)
