"""A law's estimation error as many samples of it, each moved through the law's own curves around the estimate."""

from __future__ import annotations

import math

import numpy as np

from ..estimators.layout import TORQUE_MOMENTS
from ..estimators.records import scratch
from ..estimators.two_mass_model import eigenmode_variance
from ..jit import njit

_moments = scratch(TORQUE_MOMENTS)


@njit(cache=True)
def _curve(z, points, values, slopes, count):
    """Value of a piecewise-linear curve by its points; its slopes are one more."""
    segment = 0
    while segment < count and z >= points[segment]:
        segment += 1
    anchor = max(segment - 1, 0)
    return values[anchor] + slopes[segment] * (z - points[anchor])


@njit(cache=True)
def _row(row, x):
    total = 0.0
    for i in range(x.size):
        total += row[i] * x[i]
    return total


@njit(cache=True)
def output_spread(arguments, faults, of_state, of_input, of_curve, curves, checked, noise, errors, rng):
    """Root mean square of each output's error over all samples of the error, row by row.

    An error e = true − estimated state moves by e⁺ = A e + E Δw − B v + q, Δw = curve(ẑ + Δz) − curve(ẑ), Δz = F e + H
    Δw − G v, with fresh noises v of the inputs and q of the process. Where an input was replaced by its prediction P x̂
    + R ŵ, P e + R Δw stands in the place of −v.

    Parameters
    ----------
    arguments : (n, n_curves) array
        ẑ of the curves, as the law ran.
    faults : (n,) int64 array
        Bits of the inputs that were rejected.
    of_state, of_input, of_curve : tuples of arrays
        F, A, C, P over states; G, B, D over inputs; H, E, J, R over curves.
    curves : tuple of arrays
        Points, values (n_curves, most), slopes (n_curves, most + 1), number of points (n_curves,).
    checked : (n_inputs,) int64 array
        Row of P and R for each input, or −1; one without a row counts as exact while it is replaced.
    noise : tuple of arrays
        Standard deviations that a sample has: of the process, per state; of each input.
    errors : (samples, n_states) array, changed in place
    rng : numpy Generator

    Returns
    -------
    (n, n_outputs) array
    """
    f, a, c, p = of_state
    g, b, d = of_input
    h, e, j, r = of_curve
    points, values, slopes, counts = curves
    process, sensor = noise
    n_w, n_x, n_u, n_y = g.shape[0], a.shape[0], b.shape[1], c.shape[0]
    found = np.zeros((faults.size, n_y))
    at, w, v, after = np.empty(n_w), np.empty(n_w), np.empty(n_u), np.empty(n_x)
    for k in range(faults.size):
        for i in range(n_w):
            at[i] = _curve(arguments[k, i], points[i], values[i], slopes[i], counts[i])
        for m in range(errors.shape[0]):
            x = errors[m]
            w[:] = 0.0
            for u in range(n_u):
                v[u] = -sensor[u] * rng.standard_normal() if sensor[u] > 0.0 else 0.0
                if faults[k] >> u & 1:
                    v[u] = _row(p[checked[u]], x) if checked[u] >= 0 else 0.0
            for i in range(n_w):
                z = arguments[k, i] + _row(f[i], x) + _row(g[i], v) + _row(h[i], w)
                w[i] = _curve(z, points[i], values[i], slopes[i], counts[i]) - at[i]
                for u in range(n_u):
                    if faults[k] >> u & 1 and checked[u] >= 0:
                        v[u] += r[checked[u], i] * w[i]
            for o in range(n_y):
                error = _row(c[o], x) + _row(j[o], w) + _row(d[o], v)
                found[k, o] += error * error
            for i in range(n_x):
                after[i] = _row(a[i], x) + _row(e[i], w) + _row(b[i], v)
                if process[i] > 0.0:
                    after[i] += process[i] * rng.standard_normal()
            x[:] = after
        for o in range(n_y):
            found[k, o] = math.sqrt(found[k, o] / errors.shape[0])
    return found


@njit(cache=True)
def eigenmode_variances(share, rate, torque):
    """Variance that ``eigenmode_variance`` gives to each sample of an estimated shaft torque."""
    moments, found = _moments(), np.empty(torque.size)
    moments.mean = moments.variance = 0.0
    for k in range(torque.size):
        found[k] = eigenmode_variance(share, rate, moments, torque[k])
    return found
