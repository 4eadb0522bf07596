"""Where motor and load are divided if no gap shows: a joint beside that shaft may belong to either side."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...innovations import NAMES as TOLD
from ..likelihood import Candidate
from .softest_shaft import Chain

Array = NDArray[np.float64]

#: Part of the motor's inertia that a joint has which is not seen (calibrated on development drives 2050 to 2890,
#: 2026-11-26; on 3460 to 3580 two of 235 values more are outside with a third).
UNSEEN = 0.01
MOTOR, LOAD, STIFFNESS = (TOLD.index(name) for name in ("inertia_motor", "inertia_load", "stiffness"))


def room_for_division(candidate: Candidate, widest: float) -> Array:
    """(8,) half widths, in the logarithm, for a gap that does not show, in another shaft.

    The joint on the other side then is one that is not seen, or a further inertia of the model; but none that changes
    a value by more than ``widest``: that is no joint. Between inertias like these the softest shaft divides the drive.
    """
    motor, load = candidate.values["inertia_motor"], candidate.values["inertia_load"]
    chain, others = Chain.of(candidate), [np.zeros(len(TOLD))]
    if chain is not None:
        before = np.cumsum(chain.inertias[:-1])
        changes = [_moved(before[chain.joint] - each, motor, load) for each in before]
        others += [change for change in changes if np.max(change) < widest]
    return np.asarray(np.hypot(_moved(UNSEEN * motor, motor, load), np.max(others, axis=0)))


def _moved(joint: float, motor: float, load: float) -> Array:
    """(8,) what inertia (kg m²) that goes from motor to load changes, the torsional mode as it is."""
    change = np.zeros(len(TOLD))
    change[MOTOR], change[LOAD] = np.log1p(-joint / motor), np.log1p(joint / load)
    change[STIFFNESS] = change[MOTOR] + change[LOAD]
    return np.abs(change)
