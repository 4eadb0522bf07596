"""Interacting models: from which model, and from where in it, each model starts into the next piece of a sample.

A model holds while its argument z = twist + lead·rate lies in its region. So what goes from one model to another is
the part of the first one's normal distribution in which z lies in the other's region: its chance, and mean and
covariance given that it lies there (moments of a truncated normal distribution). With a small chance a model begins
anew, at its edge of the gap or in its middle: so a place that was wrong is found again.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .steppers_interacting_state import ANEW, CHANCE, HALF, MODELS, ONE, N
from .steppers_model import LEAD_MIDDLE, START_VARIANCE

#: Regions of a model less likely than this are not looked at; what is a smaller part of a model than ``SMALLEST`` is
#: left out of it, or its distance would widen the model's covariance (both chosen).
RARE, SMALLEST = 1e-9, 1e-3

_ROOT_HALF = math.sqrt(0.5)
_DENSITY = 1.0 / math.sqrt(2.0 * math.pi)


@njit(cache=True)
def regions(z, half, deviation, chance, shift, kept):
    """A normal z in the three regions: its chance, mean − z, and share of the variance that is left, for each (3,)."""
    for m in range(MODELS):
        chance[m] = shift[m] = 0.0
        kept[m] = 1.0
    upper, lower = half - z, -half - z
    if deviation * 6.0 < min(abs(upper), abs(lower)) or deviation <= 0.0:
        chance[0 if upper < 0.0 else 2 if lower > 0.0 else 1] = 1.0
        return
    a, b = upper / deviation, lower / deviation
    density_a, density_b = _DENSITY * math.exp(-0.5 * a * a), _DENSITY * math.exp(-0.5 * b * b)
    chance[0], chance[2] = 0.5 * math.erfc(a * _ROOT_HALF), 0.5 * math.erfc(-b * _ROOT_HALF)
    chance[1] = 1.0 - chance[0] - chance[2]
    mean = (density_a, density_b - density_a, -density_b)
    square = (a * density_a, b * density_b - a * density_a, -b * density_b)
    for m in range(MODELS):
        if chance[m] < RARE:
            chance[m] = 0.0
            continue
        ratio = mean[m] / chance[m]
        shift[m] = deviation * ratio
        kept[m] = min(max(1.0 + square[m] / chance[m] - ratio * ratio, 0.0), 1.0)


@njit(cache=True)
def _along(s, at, lead, slope):
    """Covariance of every state with the argument z of the model at s[at …], to ``slope`` (N,); variance of z."""
    for i in range(N):
        row = at + N + i * N
        slope[i] = s[row] + lead * (s[row + 1] - s[row + 2])
    return slope[0] + lead * (slope[1] - slope[2])


@njit(cache=True)
def mix(p, s, mixed):
    """Chances of the models in the next piece; each model's start for it, mean and covariance, in mixed (3, ONE)."""
    lead = p[LEAD_MIDDLE]
    chance, shift, kept = np.empty((MODELS, MODELS)), np.empty((MODELS, MODELS)), np.empty((MODELS, MODELS))
    slope, total = np.empty((MODELS, N)), np.empty(MODELS)
    likeliest = 0
    for n in range(MODELS):
        at = n * ONE
        variance = max(_along(s, at, lead, slope[n]), 0.0)
        z = s[at] + lead * (s[at + 1] - s[at + 2])
        regions(z, p[HALF], math.sqrt(variance), chance[n], shift[n], kept[n])
        for m in range(MODELS):
            chance[n, m] *= s[CHANCE + n]
            if variance > 0.0:
                shift[n, m] /= variance
                kept[n, m] = (1.0 - kept[n, m]) / variance
        if s[CHANCE + n] > s[CHANCE + likeliest]:
            likeliest = n
    for m in range(MODELS):
        total[m] = p[ANEW] + chance[0, m] + chance[1, m] + chance[2, m]
        _join(s, m, chance, shift, kept, slope, SMALLEST * total[m], mixed[m])
        if p[ANEW] > SMALLEST * total[m]:
            _begin_anew(p, s, m, likeliest, p[ANEW] / total[m], mixed[m])
    whole = total[0] + total[1] + total[2]
    for m in range(MODELS):
        s[CHANCE + m] = total[m] / whole


@njit(cache=True)
def _join(s, m, chance, shift, kept, slope, least, mixed):
    """Mean and covariance of model m's parts from all models, to mixed (ONE,); zero if there is none."""
    total = 0.0
    for i in range(ONE):
        mixed[i] = 0.0
    for n in range(MODELS):
        if chance[n, m] > least:
            total += chance[n, m]
    for n in range(MODELS):
        if chance[n, m] > least:
            weight = chance[n, m] / total
            for i in range(N):
                mixed[i] += weight * (s[n * ONE + i] + slope[n, i] * shift[n, m])
    for n in range(MODELS):
        if chance[n, m] > least:
            weight, at = chance[n, m] / total, n * ONE
            for i in range(N):
                first = weight * (s[at + i] + slope[n, i] * shift[n, m] - mixed[i])
                narrower = weight * kept[n, m] * slope[n, i]
                for j in range(i, N):
                    apart = s[at + j] + slope[n, j] * shift[n, m] - mixed[j]
                    mixed[N + i * N + j] += (
                        weight * s[at + N + i * N + j] + first * apart - narrower * slope[n, j]
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
