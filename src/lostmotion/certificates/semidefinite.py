"""Linear matrix inequalities for Clarabel: unknown matrices and multipliers with the largest margin."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .rational import Matrix

Array = NDArray[np.float64]

#: Unknowns by name: symmetric (n, n) arrays and (m,) arrays of multipliers.
Unknowns = Mapping[str, Matrix]

#: Matrices, linear in the unknowns, all of which must become positive definite.
Conditions = Callable[[Unknowns], Sequence[Matrix]]


@dataclass(frozen=True)
class Layout:
    """Names and sizes of the unknowns.

    Parameters
    ----------
    symmetric : mapping of name → rows of a symmetric matrix
    multipliers : mapping of name → number of multipliers that are zero or positive
    """

    symmetric: Mapping[str, int]
    multipliers: Mapping[str, int]

    @property
    def size(self) -> int:
        return sum(n * (n + 1) // 2 for n in self.symmetric.values()) + sum(self.multipliers.values())

    def unknowns(self, vector: Array) -> dict[str, Array]:
        """The unknowns out of one vector."""
        made: dict[str, Array] = {}
        start = 0
        for name, n in self.symmetric.items():
            upper = _upper(n)
            matrix = np.zeros((n, n))
            matrix[upper] = vector[start : start + upper[0].size]
            matrix[upper[::-1]] = matrix[upper]
            made[name] = matrix
            start += upper[0].size
        for name, count in self.multipliers.items():
            made[name] = vector[start : start + count]
            start += count
        return made


class Inequalities:
    """Conditions as Clarabel takes them, scaled; all in floats.

    Parameters
    ----------
    conditions, layout
    scales : sequence of (n,) arrays
        For each condition: typical sizes of its vector.

    What comes back holds to the solver's accuracy alone: the exact check decides.
    """

    def __init__(self, conditions: Conditions, layout: Layout, scales: Sequence[Array]) -> None:
        self.layout, self.scales = layout, scales
        self.weights = np.ones(layout.size)
        self.columns: list[list[Array]] = []
        for i, row in enumerate(np.eye(layout.size)):
            made = conditions(layout.unknowns(row))
            parts = [m * np.outer(scale, scale) for m, scale in zip(made, scales, strict=True)]
            largest = max(float(np.max(np.abs(part))) for part in parts)
            self.weights[i] = np.exp2(-np.round(np.log2(largest))) if largest > 0.0 else 1.0
            self.columns.append([_packed(part) * self.weights[i] for part in parts])
        #: Sum of all traces and multipliers, over the scaled unknowns.
        self.trace = np.concatenate([_diagonal(layout), np.ones(sum(layout.multipliers.values()))])

    def largest_margin(self) -> tuple[dict[str, Array], float] | None:
        """Unknowns of total trace 1 at most for which every condition minus margin·I is positive semidefinite, with the
        largest margin; None if the solver ends without numbers."""
        size = self.layout.size
        margins = [_packed(np.eye(scale.size)) for scale in self.scales]
        found = self._solution(np.append(np.zeros(size), -1.0), np.append(self.trace, 0.0), margins)
        return None if found is None else (self._unknowns(found[:-1]), float(found[-1]))

    def largest(self, wanted: str, bounded: str, margin: float) -> dict[str, Array] | None:
        """Unknowns with the largest multiplier ``wanted`` where the multiplier ``bounded`` is 1 at most and every
        condition minus margin·I is positive semidefinite; None if the solver ends without numbers."""
        cost = -np.sign(self._weighted(wanted))
        found = self._solution(cost, self._weighted(bounded), [], margin)
        return None if found is None else self._unknowns(found)

    def _weighted(self, name: str) -> Array:
        """The row that reads one multiplier from the scaled vector."""
        places = dict.fromkeys(self.layout.symmetric, 0) | {
            n: int(n == name) for n in self.layout.multipliers
        }
        counts = {n: k * (k + 1) // 2 for n, k in self.layout.symmetric.items()} | dict(
            self.layout.multipliers
        )
        return (
            np.concatenate([np.full(counts[n], float(place)) for n, place in places.items()]) * self.weights
        )

    def _unknowns(self, scaled: Array) -> dict[str, Array]:
        values = scaled * self.weights
        start = self.layout.size - sum(self.layout.multipliers.values())
        values[start:] = np.maximum(values[start:], 0.0)
        return self.layout.unknowns(values)

    def _solution(
        self, cost: Array, bounded: Array, further: Sequence[Array], margin: float = 0.0
    ) -> Array | None:
        """The cheapest scaled unknowns with bounded·x ≤ 1; ``further``: columns of one unknown more."""
        import clarabel
        from scipy.sparse import csc_matrix, vstack

        size = self.layout.size
        count = sum(self.layout.multipliers.values())
        blocks: list[Any] = []
        cones: list[Any] = []
        right: list[Array] = []
        for i, scale in enumerate(self.scales):
            columns = [*(-column[i] for column in self.columns), *further[i : i + 1]]
            blocks.append(csc_matrix(np.column_stack(columns)))
            cones.append(clarabel.PSDTriangleConeT(scale.size))
            right.append(-margin * _packed(np.eye(scale.size)))
        positive = np.hstack(
            [np.zeros((count, size - count)), -np.eye(count), np.zeros((count, cost.size - size))]
        )
        blocks += [csc_matrix(positive), csc_matrix(bounded[np.newaxis])]
        cones += [clarabel.NonnegativeConeT(count), clarabel.NonnegativeConeT(1)]
        right += [np.zeros(count), np.ones(1)]
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        nothing = csc_matrix((cost.size, cost.size))
        solution = clarabel.DefaultSolver(
            nothing, cost, csc_matrix(vstack(blocks)), np.concatenate(right), cones, settings
        ).solve()
        found = np.asarray(solution.x)
        return found if found.size == cost.size and np.all(np.isfinite(found)) else None


def _diagonal(layout: Layout) -> Array:
    """1 for each diagonal entry of the symmetric unknowns, in the order of the vector."""
    return np.concatenate([np.equal(*np.triu_indices(n)).astype(float) for n in layout.symmetric.values()])


def _packed(matrix: Matrix) -> Array:
    """The upper triangle column by column, off the diagonal times √2 (Clarabel's PSDTriangleConeT)."""
    given = np.asarray(matrix, dtype=float)
    rows, columns, weights = _triangle(given.shape[0])
    return np.asarray(weights * given[columns, rows])


@cache
def _upper(size: int) -> tuple[Any, Any]:
    """Rows and columns of the upper triangle."""
    return np.triu_indices(size)


@cache
def _triangle(size: int) -> tuple[Any, Any, Array]:
    """Rows, columns and weights of ``_packed``."""
    rows, columns = np.tril_indices(size)
    return rows, columns, np.where(rows == columns, 1.0, np.sqrt(2.0))
