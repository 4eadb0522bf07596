"""How much later than its row a torque acts: what a linear prediction of the speed from its past and the torque's says.

In a closed loop as well: what is predicted is the next speed from all that was before, so that a torque that answers
the speed is no other cause. Source: Ljung, System Identification, 2nd ed. (1999), section 13.4 (direct method) and
section 16.4 (delay by the fit of ARX models).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..filter import ContactFilter
from .longest_segment import longest_segment

Array = NDArray[np.float64]

#: Past speeds and torques of the prediction (numerics: three inertias have five poles; a lag smears the torque).
SPEEDS, TORQUES = 8, 3
#: Samples of a torsional period of the nameplate at most, and delays that are tried (numerics).
FINEST, MOST = 24, 60
#: Rows that are taken into the triangle at once (numerics: some 5 MB).
CHUNK = 8192
#: How much worse no delay must predict, in the logarithm of the innovations (calibrated on 45 development drives in
#: closed loop of 3460 to 4266, 2026-11-27: 13 of 14 delays above are right within a quarter of a torsional period).
SHOWN = 0.02


def torque_delay(flt: ContactFilter, pole: float, longest: float) -> float | None:
    """Lag and delay together, s, at most ``longest``; None where no delay predicts about as well.

    ``pole``: the nameplate's torsional frequency, Hz.
    """
    torque, speed = longest_segment(flt)
    mean = max(1, int(1.0 / (pole * flt.dt * FINEST)))
    delays = int(min(longest / (mean * flt.dt), MOST)) + 1
    y, u = (_means(signal, mean) for signal in (speed, torque))
    if y.size < 4 * (delays + SPEEDS + TORQUES):
        return None
    costs = _innovations(y, u, delays)
    best = int(np.argmin(costs))
    if not 0.5 * np.log(costs[0] / costs[best]) > SHOWN:
        return None
    return (best + 0.5 * (TORQUES - 1)) * mean * flt.dt


def _means(signal: Array, rows: int) -> Array:
    whole = signal.size // rows * rows
    return np.asarray(signal[:whole].reshape(-1, rows).mean(axis=1))


def _innovations(speed: Array, torque: Array, delays: int) -> Array:
    """(delays,) what the past does not predict with the torque of each delay: sums of squares, over that of the speed.

    The regressions share most of their columns: all are made of one triangle, which has their products.
    """
    past = delays + SPEEDS + TORQUES
    # Friction and a constant torque stand beside the past speeds.
    always, torques = SPEEDS + 2, delays + TORQUES - 1
    triangle = np.empty((0, always + torques + 1))
    for first in range(past, speed.size, CHUNK):
        rows = slice(first, min(first + CHUNK, speed.size))
        before = [speed[rows.start - ago : rows.stop - ago] for ago in range(1, SPEEDS + 1)]
        before += [np.sign(before[0]), np.ones(before[0].size)]
        before += [torque[rows.start - ago : rows.stop - ago] for ago in range(1, torques + 1)]
        part = np.column_stack([*before, speed[rows]])
        triangle = np.asarray(np.linalg.qr(np.vstack([triangle, part]), mode="r"))
    triangle /= np.linalg.norm(triangle, axis=0) + np.finfo(np.float64).tiny
    past_speeds, measured = triangle[:, :always], triangle[:, -1]
    costs = []
    for delay in range(delays):
        acting = triangle[:, always + delay : always + delay + TORQUES]
        known = np.hstack([past_speeds, acting])
        rest = measured - known @ np.linalg.lstsq(known, measured)[0]
        costs.append(float(rest @ rest))
    return np.array(costs)
