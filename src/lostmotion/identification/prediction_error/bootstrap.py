"""What the observer's sampling and the sensor shift, from the same fit of exact simulations of what was found."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...errors import InvalidInput
from ...simulation import simulate
from ..statistics.levenberg_marquardt import Fit
from .gain_schedule import Box, Stage, fit
from .innovations import Predictor
from .warnings import count_step

Array = NDArray[np.float64]

#: Exact simulations of what was found (numerics: each adds its own scatter by a half), and over which part of the gap
#: their starts are spread: they go apart from there.
REPLICAS, APART = 2, 0.5

#: Gauss–Newton steps at most from what was found to the fit of a replica (numerics: two move it by all but a
#: hundredth).
STEPS = 3

#: A simulated speed that is further from the recorded one than this part of its deviation goes another way (calibrated
#: on exact recordings of two masses, seeds 201 to 300, where it is an eighth: the torsional oscillations go apart).
ASTRAY = 0.5

#: A fit whose sum of squares is more than so many times that of the recording has ended elsewhere (calibrated on the
#: same, where it is within a half of it).
ELSEWHERE = 2.0

#: Time over which the first speed of a segment is averaged, s (numerics: several counts of a coarse encoder; half and
#: double give the same on the rigs 1 and 2, ``benchmarks/calibrations.py``).
FIRST = 0.005


@dataclass(frozen=True, eq=False)
class Replica:
    """A drivetrain with the fitted values, simulated exactly with the recorded torque and sensor, and its own fit.

    Parameters
    ----------
    predictor : Predictor
        With the simulated speed.
    fit : Fit
        Off the values that the replica was made with by what sampling and sensor shift.
    """

    predictor: Predictor
    fit: Fit


def replicas(predictor: Predictor, stage: Stage, box: Box) -> list[Replica]:
    """Replicas of a fit; none where one goes another way than the recording, or where none can be made.

    The parametric bootstrap's estimate of a bias (Efron 1979, Ann. Statist. 7, 1–26), with the exact simulator in
    the place of the model.
    """
    if not predictor.replicable:
        return []
    made = []
    predicted = predictor.speed - predictor.speed_residual(stage.fit.residual)
    for number in range(REPLICAS):
        try:
            angle, speed = _simulated(predictor, stage.fit.theta, number)
        except InvalidInput:
            return []
        if not np.std(speed - predicted) < ASTRAY * np.std(predicted):
            return []
        shown = _shown(predictor, stage.fit.residual, angle, speed, number)
        # The observer starts in the middle of the gap and has to find the replica first.
        skip = max(predictor.skip, min(predictor.skip_later, predictor.bounds[1] // 4))
        other = replace(predictor, speed=shown, skip=skip)
        found = fit(other, stage.fit.theta, stage.free, box, stage.bandwidth, STEPS)
        if not found.cost < ELSEWHERE * stage.fit.cost:
            return []
        made.append(Replica(other, found))
    return made


def _simulated(predictor: Predictor, theta: Array, number: int) -> tuple[Array, Array]:
    """(n,) motor angle (rad, of each segment from zero) and speed (rad/s), number places the start in the gap."""
    drivetrain = predictor.drivetrain(theta)
    unlimited = replace(drivetrain.actuator, torque_limit=np.inf, rate_limit=np.inf)
    drivetrain = replace(drivetrain, actuator=unlimited)
    twist = APART * ((number + 0.5) / REPLICAS - 0.5) * drivetrain.backlash
    rows = max(1, int(FIRST / predictor.dt))
    angles, speeds = [], []
    for piece in predictor.pieces:
        first = float(np.mean(predictor.speed[piece][:rows]))
        torque = predictor.torque[piece]
        run = simulate(drivetrain, dt=predictor.dt, torque_motor=torque, state=(twist, first, first))
        angles.append(run["angle_motor"])
        speeds.append(run["speed_motor"])
    return np.concatenate(angles), np.concatenate(speeds)


def _shown(predictor: Predictor, residual: Array, angle: Array, speed: Array, number: int) -> Array:
    """What the recording's sensor would show: counts where it has counts, else white noise as large as usual."""
    rng = np.random.default_rng([number, 40])
    step = count_step(predictor.speed)
    if step is not None and predictor.speed_from_counts:
        count = step * predictor.dt
        angle = np.floor(angle / count + rng.uniform()) * count
    if predictor.speed_from_counts:
        speed = np.concatenate(
            # The first count difference of a segment is not known: the one after it stands for it.
            [
                np.diff(a, prepend=2.0 * a[0] - a[1]) / predictor.dt
                for a in (angle[p] for p in predictor.pieces)
            ]
        )
    if step is None or not predictor.speed_from_counts:
        # By the median, which moments without a good prediction do not raise.
        usual = 1.4826 * float(np.median(np.abs(residual[predictor.settled()])))
        speed = speed + usual * rng.standard_normal(speed.size)
    return speed
