"""Upper bounds of ∫₀^∞ |c·exp(A t)·v| dt that hold whatever floats round: how far bounded inputs can move an output.

exp(A t) v is stepped in floats. In the norm |x|² = xᵀP x, in which the flow contracts at a rate α, all that floats, the
trapezoidal rule and the end of the integral leave out is added (docs/proofs.md, equations 28 and 29).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import factorial, inf, nextafter, sqrt

import numpy as np
from numpy.typing import NDArray

from ..certificate import short
from ..rational import Matrix, identity, is_positive_definite, rational, solve

Array = NDArray[np.float64]

#: Half a unit in the last place of floats (numerics).
UNIT = 2.0**-53

#: Degree of the Taylor polynomial of one step (numerics: the step is a fraction of the fastest time constant).
DEGREE = 16

#: Step over the fastest time constant, and how many slowest time constants are stepped through (numerics: finer and
#: longer bring the bound nearer to the integral).
FINE, LONG = 0.04, 12.0

#: Share of the slowest decay that the norm has (numerics: with all of it there is no such norm).
CONTRACTION = 0.5


@dataclass(frozen=True, eq=False)
class Norm:
    """|x|² = xᵀP x, in which exp(A t) decays like exp(−α t), and |A x| ≤ fastest·|x|: proved in fractions."""

    P: Matrix
    rate: float
    fastest: float

    def of(self, columns: Array) -> Array:
        """At least the norm of each column."""
        p = self.P.astype(float)
        squares = np.einsum("ik,ij,jk->k", columns, p, columns)
        size = np.abs(columns)
        rounding = 8 * len(p) ** 2 * UNIT * np.einsum("ik,ij,jk->k", size, np.abs(p), size)
        return np.asarray(np.sqrt(np.maximum(squares, 0.0) + rounding) * (1.0 + 4 * UNIT))

    def of_any_signs(self, sizes: Array) -> Array:
        """At least the norm of each column of which the sizes of all entries are known."""
        return np.asarray(
            np.sqrt(np.einsum("ik,ij,jk->k", sizes, np.abs(self.P.astype(float)), sizes)) * (1.0 + 1e-9)
        )

    def dual(self, row: Matrix) -> float:
        """At least the largest row·x over |x| = 1."""
        solution = solve(self.P, row[:, np.newaxis])
        assert solution is not None
        return nextafter(sqrt(float(row @ solution[:, 0])) * (1.0 + 4 * UNIT), inf)


def contracting_norm(a: Matrix) -> Norm | None:
    """A norm in which the flow of the exact matrix contracts; None where none is found."""
    from scipy.linalg import solve_continuous_lyapunov

    floats, size = a.astype(float), len(a)
    poles = np.linalg.eigvals(floats)
    rate = -CONTRACTION * float(np.max(poles.real))
    if not rate > 0.0:
        return None
    scale = np.exp2(np.round(np.log2(np.maximum(np.abs(floats).max(axis=1), 1.0))))
    own = floats * scale / scale[:, np.newaxis] + rate * np.eye(size)
    p = solve_continuous_lyapunov(own.T, -np.eye(size)) / np.outer(scale, scale)
    exact = rational(short(0.5 * (p + p.T)))
    falls = -(a.T @ exact + exact @ a + 2 * Fraction(rate) * exact)
    if not (is_positive_definite(exact) and is_positive_definite(falls)):
        return None
    fastest = 2.0 * float(np.max(np.abs(poles)))
    while not is_positive_definite(Fraction(fastest) ** 2 * exact - a.T @ exact @ a):
        fastest *= 2.0
    return Norm(exact, rate, fastest)


def peak_integrals(a: Matrix, columns: Matrix, rows: Matrix) -> Array | None:
    """Upper bounds (m, k) of ∫ |row·exp(A t)·column| dt for exact ``a`` (n, n), ``columns`` (n, k), ``rows`` (m, n).

    None where the flow does not contract, or no norm shows that it does.
    """
    norm = contracting_norm(a)
    if norm is None:
        return None
    poles = np.linalg.eigvals(a.astype(float))
    dt = float(np.exp2(np.floor(np.log2(FINE / np.max(np.abs(poles))))))
    phi, left = _step(a, dt, norm)
    c, dual = rows.astype(float), np.array([norm.dual(row) for row in rows])
    bending = np.array([norm.dual(row) for row in rows @ a @ a])
    v = columns.astype(float)
    # Columns are floats or nearly so: what their rounding leaves out starts the error.
    wrong = norm.of((columns - rational(v)).astype(float)) if v.size else np.zeros(0)
    total, errors, lengths = np.zeros((len(c), v.shape[1])), np.zeros(v.shape[1]), np.zeros(v.shape[1])
    before = np.abs(c @ v) + 2 * len(v) * UNIT * (np.abs(c) @ np.abs(v))
    for _ in range(int(-LONG / (float(np.max(poles.real)) * dt))):
        size = norm.of(v) + wrong
        lengths += size
        errors += wrong
        new = phi @ v
        wrong = wrong + left * size + norm.of_any_signs(2 * len(v) * UNIT * (np.abs(phi) @ np.abs(v)))
        v = new
        after = np.abs(c @ v) + 2 * len(v) * UNIT * (np.abs(c) @ np.abs(v))
        total += 0.5 * dt * (before + after)
        before = after
    total += dt * np.outer(dual, errors + wrong) + dt**3 / 12.0 * np.outer(bending, lengths)
    return np.asarray((total + np.outer(dual, norm.of(v) + wrong) / norm.rate) * (1.0 + 1e-9))


def _step(a: Matrix, dt: float, norm: Norm) -> tuple[Array, float]:
    """exp(A·dt) in floats, and at least the norm of what it is wrong by."""
    term, total = identity(len(a)), identity(len(a))
    for i in range(1, DEGREE + 1):
        term = term @ a * Fraction(dt) / i
        total = total + term
    phi = total.astype(float)
    wrong, bound = total - rational(phi), 1e-15
    while not is_positive_definite(Fraction(bound) ** 2 * norm.P - wrong.T @ norm.P @ wrong):
        bound *= 4.0
    reach = norm.fastest * dt
    # The rest of the series is below its first term times 1 + reach + reach² + …
    rest = reach ** (DEGREE + 1) / factorial(DEGREE + 1) * (1.0 / (1.0 - reach) if reach < 1.0 else inf)
    return phi, bound + rest
