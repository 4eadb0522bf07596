"""Interacting models: from which model, and from where in it, each model starts into the next piece of a sample.

A model holds while its argument z = twist + lead·rate lies in its region. So what goes from one model to another is
the part of the first one's normal distribution in which z lies in the other's region: its chance, and mean and
covariance given that it lies there (moments of a truncated normal distribution). With a small chance a model begins
anew, at its edge of the gap or in its middle: so a place that was wrong is found again.
"""

from __future__ import annotations

import math

from numba import njit

from ..two_mass_model import LEAD_MIDDLE, START_VARIANCE
from .state import ANEW, CHANCE, HALF, MODELS, ONE, N

#: Regions of a model less likely than this are not looked at; what is a smaller part of a model than ``SMALLEST`` is
#: left out of it, or its distance would widen the model's covariance (both chosen).
RARE, SMALLEST = 1e-9, 1e-3

# Places in what is kept of a model: chances of the regions, moves of the mean and lost shares of the variance there (of
# z; after ``_divide`` per variance of z), covariance of each state with z.
SHIFT, LOST_SHARE, ALONG = MODELS, 2 * MODELS, 3 * MODELS
PART = ALONG + N

_ROOT_HALF = math.sqrt(0.5)
_DENSITY = 1.0 / math.sqrt(2.0 * math.pi)


@njit(cache=True)
def regions(z, half, deviation, part):
    """A normal z in the three regions: chances, mean − z, and shares of the variance that are lost, to part (≥ 9,)."""
    for i in range(3 * MODELS):
        part[i] = 0.0
    upper, lower = half - z, -half - z
    if deviation * 6.0 < min(abs(upper), abs(lower)) or deviation <= 0.0:
        part[0 if upper < 0.0 else 2 if lower > 0.0 else 1] = 1.0
        return
    a, b = upper / deviation, lower / deviation
    density_a, density_b = _DENSITY * math.exp(-0.5 * a * a), _DENSITY * math.exp(-0.5 * b * b)
    above, below = 0.5 * math.erfc(a * _ROOT_HALF), 0.5 * math.erfc(-b * _ROOT_HALF)
    chance = (above, 1.0 - above - below, below)
    mean = (density_a, density_b - density_a, -density_b)
    square = (a * density_a, b * density_b - a * density_a, -b * density_b)
    for m in range(MODELS):
        if chance[m] > RARE:
            ratio = mean[m] / chance[m]
            part[m] = chance[m]
            part[SHIFT + m] = deviation * ratio
            part[LOST_SHARE + m] = min(max(ratio * ratio - square[m] / chance[m], 0.0), 1.0)


@njit(cache=True)
def _divide(p, s, n, part):
    """Model n in the three regions, to part (PART,); its chance included."""
    at, lead = n * ONE, p[LEAD_MIDDLE]
    for i in range(N):
        row = at + N + i * N
        part[ALONG + i] = s[row] + lead * (s[row + 1] - s[row + 2])
    variance = max(part[ALONG] + lead * (part[ALONG + 1] - part[ALONG + 2]), 0.0)
    regions(s[at] + lead * (s[at + 1] - s[at + 2]), p[HALF], math.sqrt(variance), part)
    for m in range(MODELS):
        part[m] *= s[CHANCE + n]
        if variance > 0.0:
            part[SHIFT + m] /= variance
            part[LOST_SHARE + m] /= variance


@njit(cache=True)
def mix(p, s, mixed, parts):
    """Chances of the models in the next piece; each model's start for it, mean and covariance, in mixed (3, ONE).

    parts (3, PART) is scratch.
    """
    likeliest = 0
    for n in range(MODELS):
        _divide(p, s, n, parts[n])
        if s[CHANCE + n] > s[CHANCE + likeliest]:
            likeliest = n
    whole = 0.0
    for m in range(MODELS):
        total = p[ANEW] + parts[0, m] + parts[1, m] + parts[2, m]
        _join(s, m, parts, SMALLEST * total, mixed[m])
        if p[ANEW] > SMALLEST * total:
            _begin_anew(p, s, m, likeliest, p[ANEW] / total, mixed[m])
        s[CHANCE + m] = total
        whole += total
    for m in range(MODELS):
        s[CHANCE + m] /= whole


@njit(cache=True)
def _join(s, m, parts, least, mixed):
    """Mean and covariance of model m's parts from all models, to mixed (ONE,); zero if there is none."""
    total = 0.0
    for i in range(ONE):
        mixed[i] = 0.0
    for n in range(MODELS):
        if parts[n, m] > least:
            total += parts[n, m]
    for n in range(MODELS):
        if parts[n, m] > least:
            weight, shift = parts[n, m] / total, parts[n, SHIFT + m]
            for i in range(N):
                mixed[i] += weight * (s[n * ONE + i] + parts[n, ALONG + i] * shift)
    for n in range(MODELS):
        if parts[n, m] > least:
            weight, shift, at = parts[n, m] / total, parts[n, SHIFT + m], n * ONE
            lost = weight * parts[n, LOST_SHARE + m]
            for i in range(N):
                first = weight * (s[at + i] + parts[n, ALONG + i] * shift - mixed[i])
                narrower = lost * parts[n, ALONG + i]
                for j in range(i, N):
                    apart = s[at + j] + parts[n, ALONG + j] * shift - mixed[j]
                    mixed[N + i * N + j] += (
                        weight * s[at + N + i * N + j] + first * apart - narrower * parts[n, ALONG + j]
                    )
    _mirror(mixed)


@njit(cache=True)
def _mirror(mixed):
    for i in range(N):
        for j in range(i):
            mixed[N + i * N + j] = mixed[N + j * N + i]


@njit(cache=True)
def _begin_anew(p, s, m, source, weight, mixed):
    """``weight`` of model m is the likeliest model's state with the twist at m's own place, known as at the start."""
    at = source * ONE
    for i in range(N):
        new = s[at + i] if i else (1 - m) * p[HALF]
        mixed[i] += weight * (new - mixed[i])
    left = weight / (1.0 - weight) if weight < 1.0 else 0.0
    for i in range(N):
        first = (s[at + i] if i else (1 - m) * p[HALF]) - mixed[i]
        for j in range(i, N):
            second = (s[at + j] if j else (1 - m) * p[HALF]) - mixed[j]
            new = s[at + N + i * N + j] if i else 0.0 if j else p[START_VARIANCE]
            old = mixed[N + i * N + j]
            mixed[N + i * N + j] = old + weight * (new - old) + left * first * second
    _mirror(mixed)
