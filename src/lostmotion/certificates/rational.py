"""Matrices of exact fractions: a float is one, so the data of a law and of a proof are taken without rounding."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from math import lcm
from typing import Any

import numpy as np
from numpy.typing import NDArray

#: An array of ``Fraction``, or of floats: what proves is written once for both.
Matrix = NDArray[Any]


def rational(values: Any) -> Matrix:
    """The array as exact fractions, in the same shape."""
    given = np.asarray(values, dtype=object)
    exact = np.empty(given.shape, dtype=object)
    exact[...] = Fraction(0)
    for place, value in np.ndenumerate(given):
        exact[place] = Fraction(value)
    return exact


def zeros(*shape: int) -> Matrix:
    """Zeros as fractions."""
    return rational(np.zeros(shape))


def identity(size: int) -> Matrix:
    """The identity matrix of fractions."""
    return rational(np.eye(size))


def solve(matrix: Matrix, right: Matrix) -> Matrix | None:
    """The solution (n, m) of a square system by Gaussian elimination; None if it has not exactly one."""
    rows = [[*map(Fraction, a), *map(Fraction, b)] for a, b in zip(matrix, right, strict=True)]
    size = len(rows)
    for i in range(size):
        pivot = next((j for j in range(i, size) if rows[j][i]), None)
        if pivot is None:
            return None
        rows[i], rows[pivot] = rows[pivot], rows[i]
        first = rows[i][i]
        rows[i] = [value / first for value in rows[i]]
        for j in range(size):
            if j != i and (factor := rows[j][i]):
                rows[j] = [a - factor * b for a, b in zip(rows[j], rows[i], strict=True)]
    return rational([row[size:] for row in rows])


def is_positive_definite(matrix: Sequence[Sequence[Fraction]] | Matrix) -> bool:
    """Whether a symmetric matrix of fractions is positive definite: exact, by its leading minors.

    Bareiss 1968, Mathematics of Computation 22, 565-578: elimination without fractions; its pivots are the leading
    minors of the matrix in whole numbers, all of which are positive if and only if the matrix is positive definite
    (Sylvester's criterion).
    """
    rows = [[Fraction(value) for value in row] for row in matrix]
    size = len(rows)
    if any(rows[i][j] != rows[j][i] for i in range(size) for j in range(i)):
        return False
    # A congruence with a positive diagonal changes no sign: it makes the entries whole.
    scale = [lcm(*(value.denominator for value in row)) for row in rows]
    whole = [[int(rows[i][j] * scale[i] * scale[j]) for j in range(size)] for i in range(size)]
    last = 1
    for i in range(size):
        pivot = whole[i][i]
        if pivot <= 0:
            return False
        for j in range(i + 1, size):
            for k in range(j, size):
                whole[j][k] = (whole[j][k] * pivot - whole[i][j] * whole[i][k]) // last
        last = pivot
    return True
