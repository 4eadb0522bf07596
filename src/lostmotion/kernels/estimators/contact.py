"""Contact at an edge of the gap that is uncertain: the mean gap term, and predicted contacts that never come.

The gap enters by its mean over the estimate's own spread (statistical linearisation: Gelb 1974, Applied Optimal
Estimation, chapter 6), so its slope is the chance of being inside it and never jumps.
"""

from __future__ import annotations

import math

from ..jit import njit
from .layout import (
    BACKLASH,
    INVERSE_INERTIA_LOAD,
    INVERSE_INERTIA_MOTOR,
    SPEED_LOAD,
    SPEED_MOTOR,
    STIFFNESS,
    TWIST,
)
from .two_mass_model import gap_argument

#: A predicted contact is cancelled once the log-odds against it exceed the first, of which one sample gives at most the
#: second. Calibration: the paper's rig with a shaft 8 to 16 times as stiff, excitations 11 to 16.
LOG_ODDS, MOST_LOG_ODDS = 2.0, 2.0
#: Only where a contact within the spread before it turns the motor by this part of an innovation's deviation within a
#: sample. Calibration: the same; there it is 0.9 to 2.6, and at most 0.2 where a filter that linearises once keeps
#: hold.
LEAST_EFFECT = 0.5

#: Of the normal distribution (numerics).
_ROOT_HALF = math.sqrt(0.5)
_DENSITY = 1.0 / math.sqrt(2.0 * math.pi)


@njit(cache=True, inline="always")
def mean_gap(z, half, deviation):
    """Mean of clip(z, ±half) if z is normal with ``deviation``, and the chances of contact at +half and at −half."""
    if deviation * 6.0 < min(abs(z - half), abs(z + half)) or deviation <= 0.0:
        if z > half:
            return half, 1.0, 0.0
        if z < -half:
            return -half, 0.0, 1.0
        return z, 0.0, 0.0
    above = (z - half) / deviation
    below = (-z - half) / deviation
    chance_above = 0.5 * math.erfc(-above * _ROOT_HALF)
    chance_below = 0.5 * math.erfc(-below * _ROOT_HALF)
    excess = deviation * (above * chance_above + _DENSITY * math.exp(-0.5 * above * above))
    lack = deviation * (below * chance_below + _DENSITY * math.exp(-0.5 * below * below))
    return z - excess + lack, chance_above, chance_below


@njit(cache=True)
def edge_deviation(P, lead):
    """Standard deviation of z = twist + lead·rate against the edge of the gap."""
    p00, p01, p02 = P[TWIST, TWIST], P[TWIST, SPEED_MOTOR], P[TWIST, SPEED_LOAD]
    p11, p12, p22 = P[SPEED_MOTOR, SPEED_MOTOR], P[SPEED_MOTOR, SPEED_LOAD], P[SPEED_LOAD, SPEED_LOAD]
    variance = p00 + 2.0 * lead * (p01 - p02) + lead * lead * (p11 - 2.0 * p12 + p22)
    variance += 0.25 * P[BACKLASH, BACKLASH]
    return math.sqrt(max(variance, 0.0))


@njit(cache=True)
def predict_contact(p, x, P, contact):
    """Before a prediction: the torque that it expects of a contact, and how wide the estimate was before that contact.

    While the shaft comes near an edge and nothing happens, a filter that linearises once grows sure of itself too soon.
    """
    lead = p.lead_middle + 0.5 * (p.substeps - 1.0) / p.substeps * p.dt
    z = gap_argument(x, lead)
    side = 1.0 if z >= 0.0 else -1.0
    beyond = side * z - 0.5 * x[BACKLASH]
    by_backlash = P[TWIST, BACKLASH] + lead * (P[SPEED_MOTOR, BACKLASH] - P[SPEED_LOAD, BACKLASH])
    variance = edge_deviation(P, lead) ** 2 - side * by_backlash
    speed_variance = P[SPEED_LOAD, SPEED_LOAD]
    if beyond < 0.0 and beyond * beyond > 4.0 * variance:
        contact.variance, contact.speed_variance = variance, speed_variance
    else:
        contact.variance = max(variance, contact.variance)
        contact.speed_variance = max(speed_variance, contact.speed_variance)
    contact.torque = p.stiffness * x[STIFFNESS] * side * beyond if beyond > 0.0 else 0.0


@njit(cache=True)
def cancel_contact(p, x, P, contact, nu, S):
    """Cancel a predicted contact once the log-odds exceed ``LOG_ODDS``.

    The motor's speed then goes on as if there were none. The odds add up sample by sample and never fall below even
    (Page 1954, Biometrika 41, 100–115). The shaft is in the gap again, as far from the edge and as uncertain as before,
    and the load has not got the contact's impulse.
    """
    gain = p.dt * x[INVERSE_INERTIA_MOTOR] / p.inertia_motor * (0.5 * p.dt if p.counted else 1.0)
    reach = p.stiffness * x[STIFFNESS] * gain
    if contact.torque == 0.0 or reach * reach * contact.variance < LEAST_EFFECT * LEAST_EFFECT * S:
        contact.log_odds = contact.impulse = 0.0
        return
    effect = contact.torque * gain
    contact.log_odds += min(effect * (nu - 0.5 * effect) / S, MOST_LOG_ODDS)
    contact.impulse += contact.torque * p.dt
    if contact.log_odds < 0.0:
        contact.log_odds = contact.impulse = 0.0
    elif contact.log_odds > LOG_ODDS:
        x[SPEED_LOAD] -= contact.impulse * x[INVERSE_INERTIA_LOAD] / p.inertia_load
        free = max(0.5 * x[BACKLASH] - math.sqrt(contact.variance), 0.0)
        x[TWIST] = free if contact.torque > 0.0 else -free
        P[TWIST, TWIST] += contact.variance
        P[SPEED_LOAD, SPEED_LOAD] += contact.speed_variance
        contact.log_odds = contact.impulse = 0.0


@njit(cache=True, inline="always")
def no_contact(contact):
    """Nothing is predicted."""
    contact.torque = contact.variance = contact.speed_variance = contact.log_odds = contact.impulse = 0.0
