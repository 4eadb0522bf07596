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
    past = delays + SPEEDS + TORQUES
    if y.size < 4 * past:
        return None
    costs = np.array([_innovations(y, u, past, delay) for delay in range(delays)])
    best = int(np.argmin(costs))
    if not 0.5 * np.log(costs[0] / costs[best]) > SHOWN:
        return None
    return (best + 0.5 * (TORQUES - 1)) * mean * flt.dt


def _means(signal: Array, rows: int) -> Array:
    whole = signal.size // rows * rows
    return np.asarray(signal[:whole].reshape(-1, rows).mean(axis=1))


def _innovations(speed: Array, torque: Array, past: int, delay: int) -> float:
    """Mean square of what the past does not predict."""
    n = speed.size

    def before(signal: Array, rows: int) -> Array:
        return signal[past - rows : n - rows]

    columns = [before(speed, rows) for rows in range(1, SPEEDS + 1)]
    columns += [before(torque, 1 + delay + rows) for rows in range(TORQUES)]
    # Friction and a constant torque.
    columns += [np.sign(columns[0]), np.ones(n - past)]
    matrix = np.stack(columns, axis=1)
    matrix /= np.linalg.norm(matrix, axis=0) + np.finfo(np.float64).tiny
    rest = speed[past:] - matrix @ np.linalg.lstsq(matrix, speed[past:])[0]
    return float(np.mean(rest**2))
