"""Linear model of an angle that is known in encoder counts only: maximum likelihood, with the counts as intervals."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class CountFit:
    """angle ≈ values @ columns, seen in counts.

    Attributes
    ----------
    values, margins : (p,) arrays
        Maximum likelihood, and half widths of the 95 % intervals.
    scatter : float
        Standard deviation about the model beside the counts, in the angle's unit.
    """

    values: Floats
    margins: Floats
    scatter: float


#: Smallest scatter about the model, in counts (numerics): keeps the likelihood smooth where there is no noise.
SMALLEST_SCATTER = 0.03
#: Slack beyond the least that makes all readings compatible, in counts (numerics: without it they may leave one point).
SLACK = 0.02


def count_fit(
    columns: Floats,
    angle: Floats,
    resolution: float,
    groups: NDArray[np.int64],
    *,
    known: Floats | float = 0.0,
) -> CountFit:
    """Fit a linear model to an angle of which each reading says: between this count and the next.

    A reading q stands for q ≤ angle < q + resolution (an offset is part of the model, so rounding instead of
    cutting off changes nothing else), blurred by normal scatter that is fitted too. Unlike least squares this has no
    bias where the angle sweeps a few counts only. With ``resolution`` 0: least squares.

    Intervals: sandwich over groups of rows that belong together (ramps), with Student's t. They do not contain the
    uncertainty by the counts themselves: see ``compatible_range``.

    Parameters
    ----------
    columns : (p, n) array
    angle : (n,) array
    resolution : float, in the angle's unit
    groups : (n,) int array
        Number of the ramp that each row belongs to.
    known : (n,) array
        A known part of the angle.
    """
    unit = resolution if resolution > 0.0 else 1.0
    # Orthogonal columns of size one: the minimiser then needs a few steps.
    size = float(np.sqrt(angle.size))
    basis, triangle = np.linalg.qr(columns.T)
    x = basis.T * size
    y = (np.round(angle / unit) if resolution > 0.0 else angle) - known / unit
    start = x @ y / angle.size
    scatter = float(np.std(y - start @ x))
    if resolution > 0.0:
        p, score, hessian = _most_likely(x, y, start, scatter)
        scatter = float(np.exp(p[-1]))
    else:
        p = start
        score, hessian = x * (y - start @ x), x @ x.T
    k = len(columns)
    to_values = np.linalg.inv(triangle) * size
    margins = _sandwich_margins(score, hessian, groups, to_values)
    return CountFit(to_values @ p[:k] * unit, margins * unit, scatter * unit)


def _most_likely(x: Floats, q: Floats, start: Floats, scatter: float) -> tuple[Floats, Floats, Floats]:
    """Parameters and the logarithm of the scatter, the scores of the rows, and the Hessian; in counts."""
    from scipy.optimize import minimize

    def objective(p: Floats) -> tuple[float, Floats]:
        log_p, score = _likelihood(p, x, q)
        return -float(log_p.mean()), -np.asarray(score.mean(axis=1))

    first = np.append(start, np.log(max(scatter, 0.3)))
    first[: len(start)] += 0.5 * x.mean(axis=1)  # the middle of a count lies half a count above its reading
    bounds = [(None, None)] * len(start) + [(np.log(SMALLEST_SCATTER), 5.0)]
    options: Any = {"maxiter": 500, "ftol": 1e-14, "gtol": 1e-9}
    best: Any = minimize(objective, first, jac=True, bounds=bounds, method="L-BFGS-B", options=options)
    p = np.asarray(best.x, dtype=float)
    return p, _likelihood(p, x, q)[1], _hessian(p, x, q)


def _sandwich_margins(score: Floats, hessian: Floats, groups: NDArray[np.int64], to_values: Floats) -> Floats:
    from scipy.stats import t as student

    inverse = np.linalg.pinv(hessian, rcond=1e-12)
    number = np.unique(groups, return_inverse=True)[1]
    count = int(number.max()) + 1
    summed = np.stack([np.bincount(number, s, count) for s in score])
    free = max(count - 1, 1)
    k = len(to_values)
    covariance = (inverse @ (summed @ summed.T) @ inverse)[:k, :k] * count / free
    variance = np.diag(to_values @ covariance @ to_values.T)
    return np.asarray(float(student.ppf(0.975, free)) * np.sqrt(np.maximum(variance, 0.0)))


def compatible_range(
    columns: Floats,
    angle: Floats,
    resolution: float,
    *,
    sweep: int = 1,
    bounds: Mapping[int, tuple[float | None, float | None]],
) -> tuple[Floats, Floats]:
    """Least and greatest value of each parameter with which the linear model fits every reading, by linear programming.

    The readings may be off by the least slack that makes them compatible at all; NaN where that is more than half a
    count, since the readings then scatter too much. Infinite where nothing bounds a parameter.

    Parameters
    ----------
    columns, angle, resolution
        As in ``count_fit``.
    sweep : int
        The column that changes gradually (the torque); the others have a few values only.
    bounds : mapping of parameter → (low, high)
        Prior bounds on parameters.
    """
    from scipy.optimize import linprog

    q = np.round(angle / resolution)
    others = np.delete(columns, sweep, axis=0)
    group = np.unique(np.vstack([others, q]), axis=1, return_inverse=True)[1].ravel()
    order = np.lexsort((columns[sweep], group))
    ends = np.flatnonzero(np.diff(group[order])) + 1
    # The model is monotonic in the swept column: only the first and last row of a group bind.
    rows = order[np.unique(np.concatenate([[0], ends, ends - 1, [order.size - 1]]))]
    size = np.maximum(np.abs(columns).max(axis=1), np.finfo(float).tiny)
    x, k = (columns[:, rows] / size[:, None]).T, len(columns)
    limits: list[tuple[float | None, float | None]] = [
        tuple(None if end is None else end * size[i] / resolution for end in bounds.get(i, (None, None)))  # type: ignore[misc]
        for i in range(k)
    ]
    one, b = np.ones((len(rows), 1)), np.concatenate([q[rows] + 1.0, -q[rows]])
    a = np.vstack([np.hstack([x, -one]), np.hstack([-x, -one])])
    least = linprog(np.append(np.zeros(k), 1.0), a, b, bounds=[*limits, (0.0, None)])
    nothing = np.full(k, np.nan)
    if least.x is None or least.x[-1] > 0.5:
        return nothing, nothing
    b = b + float(least.x[-1]) + SLACK
    found = np.empty((2, k))
    for i in range(k):
        for j, sign in enumerate((1.0, -1.0)):
            end = linprog(sign * np.eye(k)[i], a[:, :k], b, bounds=limits)
            found[j, i] = -sign * np.inf if end.x is None else end.x[i]
    return found[0] / size * resolution, found[1] / size * resolution


def _likelihood(p: Floats, x: Floats, q: Floats) -> tuple[Floats, Floats]:
    """Logarithm of the likelihood (n,) and its derivatives (len(p), n); angles in counts."""
    from scipy.special import log_ndtr

    sigma = np.exp(p[-1])
    low = (q - p[:-1] @ x) / sigma
    high = low + 1.0 / sigma
    # Far above the interval both tails are tiny: mirrored, their difference keeps its digits.
    flip = low + high > 0.0
    upper, lower = np.where(flip, -low, high), np.where(flip, -high, low)
    log_upper = log_ndtr(upper)
    log_p = log_upper + np.log1p(-np.exp(np.minimum(log_ndtr(lower) - log_upper, -1e-300)))
    log_p = np.maximum(log_p, -1e6)
    density_low, density_high = (np.exp(-0.5 * z**2 - 0.5 * np.log(2.0 * np.pi) - log_p) for z in (low, high))
    by_mean = (density_low - density_high) / sigma
    by_sigma = low * density_low - high * density_high
    return log_p, np.concatenate([x * by_mean, by_sigma[None, :]])


def _hessian(p: Floats, x: Floats, q: Floats) -> Floats:
    """Of minus the logarithm of the likelihood, by differences of its derivatives."""
    rows = []
    for i in range(p.size):
        step = np.zeros(p.size)
        step[i] = 1e-4
        plus, minus = (_likelihood(p + s * step, x, q)[1].sum(axis=1) for s in (1.0, -1.0))
        rows.append(-(plus - minus) / 2e-4)
    hessian = np.array(rows)
    return np.asarray(0.5 * (hessian + hessian.T))
