"""What most tests of the prediction error stand on: the paper's drive with a torque lag, and its encoder."""

from __future__ import annotations

import numpy as np
from table_i import PAPER

import lostmotion as lm
from lostmotion.identification.prediction_error.innovations import NAMES, to_theta

DT = 1e-4
PLANT = PAPER.with_parameters(lag=3e-4)
THETA = to_theta([getattr(PLANT, n) for n in NAMES], DT)


def speed_from_counts(run: lm.Recording, count: float) -> np.ndarray:
    """Motor speed, rad/s, as differences of the encoder's counts of so many rad."""
    counts = np.floor(run["angle_motor"] / count)
    return np.diff(counts, prepend=counts[0]) * count / DT
