"""What each sensor should show: h(x) and its row H, innovation and variance, and what the model alone has moved."""

from __future__ import annotations

from ...jit import njit
from ..contact import edge_deviation, mean_gap
from ..kalman import variance_along
from ..layout import BACKLASH, SPEED_LOAD, SPEED_MOTOR, STIFFNESS, TRACKED, TWIST
from ..sensors import OF_TORQUE_SHAFT, sensor_variance, state_measured, state_shown
from ..two_mass_model import elastic_change, gap_argument, shaft_torque


@njit(cache=True)
def predicted(p, x, P, kind, H):
    """h(x): what a sensor should show (from counts: the angle turned); the row ∂h/∂x goes to H."""
    for i in range(TRACKED):
        H[i] = 0.0
    if kind != OF_TORQUE_SHAFT:
        state = state_measured(p, kind)
        H[state] = 1.0
        return x[state]
    k, d, lead = p.stiffness * x[STIFFNESS], p.damping * x[STIFFNESS], p.lead
    gap, above, below = mean_gap(gap_argument(x, lead), 0.5 * x[BACKLASH], edge_deviation(P, lead))
    inside = 1.0 - above - below
    H[TWIST] = k * (1.0 - inside)
    H[SPEED_MOTOR] = d - k * lead * inside
    H[SPEED_LOAD] = -H[SPEED_MOTOR]
    H[BACKLASH] = -0.5 * k * (above - below)
    H[STIFFNESS] = shaft_torque(p, x, gap)
    return H[STIFFNESS] * x[STIFFNESS]


@njit(cache=True)
def innovation_of(p, memory, x, P, i, value, H, PHt):
    """Equations (1) and (2) of ``kalman`` for sensor i: ν, S, and R; H and P Hᵀ go to ``H`` and ``PHt``."""
    nu = value * p.scale[i] - predicted(p, x, P, int(p.kind[i]), H)
    R = sensor_variance(p, i, memory)
    return nu, R + variance_along(P, H, PHt), R


@njit(cache=True)
def moved_by_model(p, s, kind):
    """Change of a predicted signal over the last sample by the model alone."""
    state, half = state_shown(kind), 0.5 * s.estimate.x[BACKLASH]
    now, before = s.estimate.x[state], s.before[state]
    if kind == OF_TORQUE_SHAFT:
        return p.stiffness * elastic_change(now, before, half)
    return now - before
