"""What the motor's sensor shows, and its noise: without any there is no likelihood."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .....errors import InvalidInput
from ....statistics.white_noise import white_noise
from ...innovations import Predictor
from ...warnings import count_step

Array = NDArray[np.float64]

#: Noise over the motion below which a speed has none, as from an exact simulation (numerics: so exactly the filter
#: finds an impact), and the noise that such a speed gets (numerics: with 1e-5 and with 1e-4 six exact drives come out
#: right).
EXACT, ADDED = 3e-6, 1e-4


def measured_with_noise(predictor: Predictor) -> tuple[Array, float, bool]:
    """(n,) speed of the motor, rad/s, or its angle, rad, where the speed is a difference of counts; the standard
    deviation of its noise, which an exact speed gets, the same at each call; and whether that is rounding.

    Raises
    ------
    InvalidInput
        If the speed never changes.
    """
    dt, counted = predictor.dt, predictor.speed_from_counts
    measured = np.cumsum(predictor.speed) * dt if counted else predictor.speed
    step = count_step(predictor.speed) if counted else None
    if step is not None:
        noise = step * dt / np.sqrt(12.0)
    else:  # recordings of several sensors are judged by the noisiest
        noise = max(white_noise(measured[piece]) for piece in predictor.pieces)
    motion = float(np.std(predictor.speed)) * (dt if counted else 1.0)
    if not motion > 0.0:
        raise InvalidInput("speed_motor", "a constant", "a speed that changes", "Check the channel.")
    if not noise > (0.0 if counted else EXACT * motion):
        noise = ADDED * motion
        measured = measured + noise * np.random.default_rng(0).standard_normal(measured.size)
    return measured, noise, step is not None
