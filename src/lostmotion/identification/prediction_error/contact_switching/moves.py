"""Moves out of the basin of a minimum, in the numbers in which starts get lost."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from .filter import INDEX
from .likelihood import Box, Candidate, minimise
from .starts import lag

Array = NDArray[np.float64]

#: Moves by which other minima are looked for, see ``_moved`` (numerics: starts were lost in these directions).
HOPS = {
    "inertia": (0.4, -0.4), "ratio": (0.7, -0.7), "pole": (0.25, -0.25), "backlash": (1.4, -1.4),
    "delay": (0.0, 0.9), "lag": (1.4, -1.4),
}  # fmt: skip
#: Steps after each, and the gain below which no more are tried (numerics).
HOP_STEPS, HOP_GAIN = 4, 0.02


def other_minima(candidate: Candidate, box: Box) -> list[Candidate]:
    """Minima that are found from a candidate by moves beyond its own basin, and onwards from the lowest one of them."""
    found = [candidate]
    while True:
        before = candidate.cost
        for name, sizes in HOPS.items():
            for size in sizes:
                theta = np.clip(_moved(candidate, name, size), box.lower, box.upper)
                theta, run = minimise(candidate.flt, theta, candidate.free, box, HOP_STEPS)
                found.append(
                    replace(candidate, start=f"{candidate.start}, {name}", theta=theta, cost=run.cost)
                )
                candidate = min(candidate, found[-1], key=lambda one: one.cost)
        if not candidate.cost < before - HOP_GAIN:
            return found


def _moved(candidate: Candidate, name: str, size: float) -> Array:
    """θ after a move in one of the loop's own numbers; ``size`` is a logarithm, for a delay its share of the lag."""
    theta, dt = candidate.theta.copy(), candidate.flt.dt
    motor, load, stiffness, damping = (
        INDEX[n] for n in ("inertia_motor", "inertia_load", "stiffness", "damping")
    )
    change = np.zeros(theta.size)
    if name == "delay":
        theta[INDEX["delay"]] = size * lag(candidate) / dt
        theta[INDEX["lag"]] = np.log((1.0 - size) * lag(candidate) + 1.1 * dt)
    elif name == "inertia":
        change[[motor, load, stiffness, damping]] = size
    elif name == "ratio":
        # Of the same total inertia, pole and damping ratio.
        total, ratio = np.sum(np.exp(theta[[motor, load]])), np.exp(theta[load] - theta[motor] + size)
        parts = np.log([total / (1.0 + ratio), total * ratio / (1.0 + ratio)])
        change[[motor, load]] = parts - theta[[motor, load]]
        change[[stiffness, damping]] = np.sum(change[[motor, load]])
    elif name == "pole":
        change[stiffness], change[damping] = 2.0 * size, size
    else:
        change[INDEX[name]] = size
    change[[i for i in range(theta.size) if i not in candidate.free]] = 0.0
    return np.asarray(theta + change)
