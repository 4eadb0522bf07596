"""Exact linear algebra: solutions, and where a matrix stops being positive definite."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from lostmotion.certificates.rational import is_positive_definite, rational, solve


def test_a_float_is_taken_without_rounding() -> None:
    assert rational([0.1])[0] == Fraction(3602879701896397, 36028797018963968)


def test_the_solution_is_exact() -> None:
    matrix = rational([[2, 1], [1, Fraction(1, 3)]])
    solution = solve(matrix, rational([[1], [1]]))
    assert solution is not None and list(solution[:, 0]) == [2, -3]
    assert solve(rational([[1, 2], [2, 4]]), rational([[1], [1]])) is None


def test_the_border_of_positive_definiteness_is_exact() -> None:
    tiny = Fraction(1, 10**40)
    assert not is_positive_definite([[1, 1], [1, 1]])
    assert not is_positive_definite([[1, 1], [1, 1 - tiny]])
    assert is_positive_definite([[1, 1], [1, 1 + tiny]])
    assert not is_positive_definite([[1, 0], [1, 1]]), "not symmetric"


def test_it_agrees_with_eigenvalues() -> None:
    rng = np.random.default_rng(3)
    for _ in range(60):
        half = rng.normal(size=(5, 5))
        matrix = half @ half.T - rng.uniform(0.0, 0.3) * np.eye(5)
        matrix = 0.5 * (matrix + matrix.T)
        assert is_positive_definite(rational(matrix)) == bool(np.linalg.eigvalsh(matrix)[0] > 0.0)
