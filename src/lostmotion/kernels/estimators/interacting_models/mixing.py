"""Interacting models: from which model, and from where in it, each model starts into the next substep.

A model holds while its argument z = twist + lead·rate lies in its region. So what goes from one model to another is
the part of the first one's normal distribution in which z lies in the other's region: its chance, and mean and
covariance given that it lies there (moments of a truncated normal distribution). With a small chance a model begins
anew, at its edge of the gap or in its middle: so a place that was wrong is found again.
"""

from __future__ import annotations

import math

from ...jit import njit
from ..layout import MODEL_STATES, MODELS, SPEED_LOAD, SPEED_MOTOR, TWIST, record
from ..two_mass_model import gap_argument
from .state import edge

#: Numerics: regions of a model less likely than this are left out; so is what is a smaller part of a model than
#: ``SMALLEST``, or its distance would widen the model's covariance.
RARE, SMALLEST = 1e-9, 1e-3

#: A model in the three regions: their chances, moves of the mean and lost shares of the variance there (of z; after
#: ``_divide`` per variance of z), covariance of each state with z.
PARTS = record(
    ("chance", (MODELS,)), ("shift", (MODELS,)), ("lost_share", (MODELS,)), ("along", (MODEL_STATES,))
)

#: Of the normal distribution (numerics).
_ROOT_HALF = math.sqrt(0.5)
_DENSITY = 1.0 / math.sqrt(2.0 * math.pi)


@njit(cache=True)
def regions(z, half, deviation, part):
    """A normal z in the three regions: their chances, mean − z, and shares of the variance that are lost, to part."""
    chance, shift, lost_share = part.chance, part.shift, part.lost_share
    for m in range(MODELS):
        chance[m] = shift[m] = lost_share[m] = 0.0
    upper, lower = half - z, -half - z
    if deviation * 6.0 < min(abs(upper), abs(lower)) or deviation <= 0.0:
        chance[0 if upper < 0.0 else 2 if lower > 0.0 else 1] = 1.0
        return
    a, b = upper / deviation, lower / deviation
    density_a, density_b = _DENSITY * math.exp(-0.5 * a * a), _DENSITY * math.exp(-0.5 * b * b)
    above, below = 0.5 * math.erfc(a * _ROOT_HALF), 0.5 * math.erfc(-b * _ROOT_HALF)
    share = (above, 1.0 - above - below, below)
    mean = (density_a, density_b - density_a, -density_b)
    square = (a * density_a, b * density_b - a * density_a, -b * density_b)
    for m in range(MODELS):
        if share[m] > RARE:
            ratio = mean[m] / share[m]
            chance[m] = share[m]
            shift[m] = deviation * ratio
            lost_share[m] = min(max(ratio * ratio - square[m] / share[m], 0.0), 1.0)


@njit(cache=True)
def _divide(own, s, n, part):
    """Model n in the three regions, its chance included."""
    x, P, along, lead = s.models[n].x, s.models[n].P, part.along, own.common.lead_middle
    for i in range(MODEL_STATES):
        along[i] = P[i, TWIST] + lead * (P[i, SPEED_MOTOR] - P[i, SPEED_LOAD])
    variance = max(gap_argument(along, lead), 0.0)
    regions(gap_argument(x, lead), own.half_gap, math.sqrt(variance), part)
    for m in range(MODELS):
        part.chance[m] *= s.probability[n]
        if variance > 0.0:
            part.shift[m] /= variance
            part.lost_share[m] /= variance


@njit(cache=True)
def likeliest_model(s):
    best = 0
    for m in range(MODELS):
        if s.probability[m] > s.probability[best]:
            best = m
    return best


@njit(cache=True)
def mix(own, s, mixed, parts):
    """Probabilities of the models in the next substep; each one's start for it to mixed (MODELS,).

    parts (MODELS,) is scratch.
    """
    likeliest = likeliest_model(s)
    for n in range(MODELS):
        _divide(own, s, n, parts[n])
    whole = 0.0
    for m in range(MODELS):
        total = own.anew + parts[0].chance[m] + parts[1].chance[m] + parts[2].chance[m]
        _join(s, m, parts, SMALLEST * total, mixed[m].x, mixed[m].P)
        if own.anew > SMALLEST * total:
            _begin_anew(own, s, m, likeliest, own.anew / total, mixed[m].x, mixed[m].P)
        s.probability[m] = total
        whole += total
    for m in range(MODELS):
        s.probability[m] /= whole


@njit(cache=True)
def _join(s, m, parts, least, x, P):
    """Mean x and covariance P of model m's parts from all models; zero if there is none."""
    total = 0.0
    for i in range(MODEL_STATES):
        x[i] = 0.0
        for j in range(MODEL_STATES):
            P[i, j] = 0.0
    for n in range(MODELS):
        if parts[n].chance[m] > least:
            total += parts[n].chance[m]
    for n in range(MODELS):
        if parts[n].chance[m] > least:
            weight, shift = parts[n].chance[m] / total, parts[n].shift[m]
            for i in range(MODEL_STATES):
                x[i] += weight * (s.models[n].x[i] + parts[n].along[i] * shift)
    for n in range(MODELS):
        if parts[n].chance[m] > least:
            weight, shift, along = parts[n].chance[m] / total, parts[n].shift[m], parts[n].along
            of_x, of_P = s.models[n].x, s.models[n].P
            lost = weight * parts[n].lost_share[m]
            for i in range(MODEL_STATES):
                first = weight * (of_x[i] + along[i] * shift - x[i])
                narrower = lost * along[i]
                for j in range(i, MODEL_STATES):
                    apart = of_x[j] + along[j] * shift - x[j]
                    P[i, j] += weight * of_P[i, j] + first * apart - narrower * along[j]
    _mirror(P)


@njit(cache=True)
def _mirror(P):
    for i in range(MODEL_STATES):
        for j in range(i):
            P[i, j] = P[j, i]


@njit(cache=True)
def _begin_anew(own, s, m, source, weight, x, P):
    """``weight`` of model m is the likeliest model's state with the twist at m's own place, known as at the start."""
    of_x, of_P, place = s.models[source].x, s.models[source].P, edge(own, m)
    for i in range(MODEL_STATES):
        new = of_x[i] if i else place
        x[i] += weight * (new - x[i])
    left = weight / (1.0 - weight) if weight < 1.0 else 0.0
    for i in range(MODEL_STATES):
        first = (of_x[i] if i else place) - x[i]
        for j in range(i, MODEL_STATES):
            second = (of_x[j] if j else place) - x[j]
            new = of_P[i, j] if i else 0.0 if j else own.common.P0[TWIST]
            old = P[i, j]
            P[i, j] = old + weight * (new - old) + left * first * second
    _mirror(P)
