"""The step of the speed set-point that the laws are compared on, from the drive's own speeds and torque."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .. import signals
from ..drivetrain import Drivetrain
from ..recording import Recording

#: Set-point of the paper's step, rad/s, when it comes, when it goes back, and the end, s: Fietzek & Rinderknecht,
#: section IV and Fig. 15. For the virtual rig, and where no speed was recorded.
PAPER_SPEED, PAPER_TIMES = 2.0, (1.0, 1.5, 2.0)
#: The step stays within this share of the recorded speeds (option), which are taken without their outermost per cent
#: (numerics: spikes).
SHARE, OUTERMOST = 0.5, 0.01
#: A direction is the drive's own if its speeds reach this share of the other direction's (option).
OWN_DIRECTION = 0.1
#: Half the step over the speed that the torque beyond friction gives within a time constant of the slowest pole
#: (option: that of the paper's step on its rig).
TORQUE_SHARE = 1.4
#: Torque for the acceleration is at least this share of the limit (numerics: a limit below friction gives a time too).
LEAST_TORQUE = 0.1
#: Time before and after the step, in time constants of the slowest pole, in times of acceleration with the limit, and
#: in samples (numerics: a law that is as fast as designed settles within half of it).
SETTLES, ACCELERATES, SAMPLES = 12.0, 3.0, 50
#: Rows of the response at most (option: some seconds of work, 0.2 GB): a law that needs longer is not seen to settle.
MOST_ROWS = 1_000_000


@dataclass(frozen=True)
class SpeedStep:
    """From ``low`` to ``high`` (rad/s) at ``start``, back at ``stop``, until ``end`` (s)."""

    low: float
    high: float
    start: float
    stop: float
    end: float

    def reference(self, dt: float) -> NDArray[np.float64]:
        """The set-point, rad/s, (n,)."""
        return signals.steps((self.start, self.stop), (self.low, self.high, self.low), self.end, dt)

    def without_return(self) -> SpeedStep:
        """The step alone: it does not go back."""
        return replace(self, stop=self.end)

    def longer(self, dt: float) -> SpeedStep:
        """The same step with twice the time, or as much as there is room for; dt in s."""
        factor = min(2.0, MOST_ROWS * dt / self.end)
        if factor < 1.01:  # numerics: the rounding of what is full already
            return self
        return replace(self, start=factor * self.start, stop=factor * self.stop, end=factor * self.end)


PAPER_STEP = SpeedStep(-PAPER_SPEED, PAPER_SPEED, *PAPER_TIMES)


def speed_step(
    recording: Recording | None,
    drivetrain: Drivetrain,
    torque_limit: float,
    slowest: float,
    filter_time: float,
    dt: float,
) -> SpeedStep:
    """The step for a drive, from what was recorded of it.

    Parameters
    ----------
    recording : Recording or None
        Its motor speed gives the range; without one the step is the paper's.
    drivetrain : Drivetrain
    torque_limit : float, Nm
    slowest : float, 1/s
        Decay rate of the slowest pole of the law.
    filter_time : float, s
        Of the other law's set-point filter.
    dt : float, s
    """
    low, high = _range(recording)
    half, middle = 0.5 * (high - low), 0.5 * (high + low)
    friction = drivetrain.coulomb + drivetrain.coulomb_motor
    friction += (drivetrain.viscous + drivetrain.viscous_motor) * max(abs(low), abs(high))
    torque = max(torque_limit - friction, LEAST_TORQUE * torque_limit)
    if math.isfinite(torque):
        half = min(half, TORQUE_SHARE * torque / (drivetrain.inertia_total * slowest))
    accelerates = 2.0 * half * drivetrain.inertia_total / torque
    time = SETTLES * max(1.0 / slowest, filter_time) + ACCELERATES * accelerates + SAMPLES * dt
    time = min(time, MOST_ROWS * dt / 3.0)
    return SpeedStep(middle - half, middle + half, time, 2.0 * time, 3.0 * time)


def _range(recording: Recording | None) -> tuple[float, float]:
    """Speeds that the step may have, rad/s: in both directions if the drive was turned in both, else in its own."""
    if recording is None or "speed_motor" not in recording:
        return -PAPER_SPEED, PAPER_SPEED
    low, high = (float(np.quantile(recording["speed_motor"], q)) for q in (OUTERMOST, 1.0 - OUTERMOST))
    slower, faster = sorted((abs(low), abs(high)))
    if low < 0.0 < high and slower >= OWN_DIRECTION * faster:
        return -SHARE * slower, SHARE * slower
    middle, half = 0.5 * (low + high), 0.5 * SHARE * (high - low)
    return (middle - half, middle + half) if half > 0.0 else (-PAPER_SPEED, PAPER_SPEED)
