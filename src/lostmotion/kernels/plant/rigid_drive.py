"""One inertia with set-valued friction that differs by direction, exact from event to event."""

from __future__ import annotations

import math

import numpy as np

from ..jit import njit

#: Changes of direction within one sample that are followed; the torque is held, so two are the most (numerics).
MOST_PIECES = 4


@njit(cache=True)
def run_rigid_drive(torque, dt, inertia, coulomb, viscous, offset, angle, speed):
    """Angle and speed before each torque acts, (n, 2); ``coulomb`` and ``viscous`` are (2,): plus, minus."""
    n = torque.size
    out = np.empty((n, 2))
    for k in range(n):
        out[k, 0] = angle
        out[k, 1] = speed
        drive = torque[k] - offset
        left = dt
        for _ in range(MOST_PIECES):
            if speed == 0.0:
                if drive > coulomb[0]:
                    side = 0
                elif drive < -coulomb[1]:
                    side = 1
                else:
                    break
            else:
                side = 0 if speed > 0.0 else 1
            sign = 1.0 - 2.0 * side
            force = (drive - sign * coulomb[side]) / inertia
            rate = viscous[side] / inertia
            step = left
            stops = False
            if sign * force < 0.0:
                # speed(t) = speed·e^(−rate t) + force·(1 − e^(−rate t))/rate reaches zero at:
                rest = math.log1p(-rate * speed / force) / rate if rate > 0.0 else -speed / force
                if rest < left:
                    step = rest
                    stops = True
            x = rate * step
            e1 = -math.expm1(-x) / rate if rate > 0.0 else step
            e2 = (step - e1) / rate if x > 1e-4 else 0.5 * step * step * (1.0 - x / 3.0)
            angle += speed * e1 + force * e2
            speed = 0.0 if stops else speed * (1.0 - rate * e1) + force * e1
            left -= step
            if not stops:
                break
    return out
