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

#: Clarabel's tolerance, its default (numerics): what is smaller, of scaled unknowns of total trace 1, it does not see.
TOLERANCE = 1e-8
#: ``Inequalities.centred`` ends at this margin (1: that of the centre), or within this share of the largest one; and
#: where no margin is above ``NOTHING`` (numerics: the exact check needs some margin, not the largest).
ENOUGH, NEARLY, NOTHING = 0.1, 0.2, 1e-9
#: Times that Clarabel refines the solution of a linear system: its default, and where the largest margin is asked for
#: (numerics: more cost a quarter of the time there; without any, two loops of ``benchmarks/certify.py`` prove less).
REFINED, REFINED_FOR_MARGIN = 10, 1


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
        return sum(n * (n + 1) // 2 for n in self.symmetric.values()) + self.multiplier_count

    @property
    def multiplier_count(self) -> int:
        return sum(self.multipliers.values())

    def unknowns(self, vector: Array) -> dict[str, Array]:
        """The unknowns out of one vector."""
        made: dict[str, Array] = {}
        start = 0
        for name, n in self.symmetric.items():
            upper = _upper(n)
            matrix = np.zeros((n, n))
            matrix[upper] = matrix[upper[::-1]] = vector[start : start + upper[0].size]
            made[name] = matrix
            start += upper[0].size
        for name, count in self.multipliers.items():
            made[name] = vector[start : start + count]
            start += count
        return made

    def row_of(self, multiplier: str) -> Array:
        """The row that reads a single multiplier from the vector."""
        places = np.repeat(list(self.multipliers), list(self.multipliers.values())) == multiplier
        return np.append(np.zeros(self.size - self.multiplier_count), places)


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
        self.layout, self.conditions, self.scales = layout, conditions, scales
        made = [conditions(layout.unknowns(row)) for row in np.eye(layout.size)]
        #: For each condition (size, n, n): what each unknown adds to it.
        self.parts = [
            np.array([one[i] for one in made], dtype=float) * np.outer(scale, scale)
            for i, scale in enumerate(scales)
        ]

    def hold(self, unknowns: Unknowns) -> bool:
        """Whether every condition is positive definite."""
        made = self.conditions(unknowns)
        return all(
            np.linalg.eigvalsh(matrix * np.outer(scale, scale))[0] > 0.0
            for scale, matrix in zip(self.scales, made, strict=True)
        )

    def largest_margin(self, nearly: bool = False) -> tuple[dict[str, Array], float] | None:
        """Unknowns for which every condition minus margin·I is positive semidefinite, with the largest margin.

        Scaled, they have a total trace of 1 at most. None if the solver ends without numbers. ``nearly``: a margin
        within ``NEARLY`` of the largest will do, and takes a quarter less time.
        """
        trace = np.concatenate([_diagonal(self.layout), np.ones(self.layout.multiplier_count)])
        weights = _weights(self.parts)
        return _solved(self.layout, self.parts, weights, trace, _is_nearly_largest if nearly else None)

    def centred(self, centre: Unknowns) -> dict[str, Array] | None:
        """Unknowns with a margin in bases in which each condition is the identity at a centre; None if none has.

        The largest margin is often below Clarabel's tolerance: V of a slow motion falls in a sample by 1e-8 of what V
        of a fast one does, and no scaling of states helps. Around a centre that nearly satisfies the conditions,
        margins are shares of what each motion has there.
        """
        parts = self._around(centre)
        weights = _weights(parts)
        trace = weights * sum(np.trace(part, axis1=1, axis2=2) for part in parts)
        found = _solved(self.layout, parts, weights, trace / sum(part.shape[1] for part in parts), _ended)
        return None if found is None or _is_nothing(found[1]) else found[0]

    def largest(self, wanted: str, bounded: str, margin: float) -> dict[str, Array] | None:
        """Unknowns with the largest multiplier ``wanted`` where the multiplier ``bounded`` is 1 at most and every
        condition minus margin·I is positive semidefinite; None if the solver ends without numbers."""
        weights = _weights(self.parts)
        cost = -self.layout.row_of(wanted)
        found = _cheapest(
            self.layout, self.parts, weights, cost, self.layout.row_of(bounded) * weights, margin=margin
        )
        return None if found is None else _unknowns(self.layout, found * weights)

    def _around(self, centre: Unknowns) -> list[Array]:
        """The parts in such bases, as far as a condition is positive at the centre."""
        made = self.conditions(centre)
        scaled = [np.asarray(m * np.outer(s, s), dtype=float) for m, s in zip(made, self.scales, strict=True)]
        accuracy = TOLERANCE * max(float(np.max(np.abs(matrix))) for matrix in scaled)
        parts = []
        for part, matrix in zip(self.parts, scaled, strict=True):
            values, vectors = np.linalg.eigh(matrix)
            basis = vectors / np.sqrt(np.maximum(values, accuracy))
            parts.append(basis.T @ part @ basis)
        return parts


def _ended(info: Any) -> bool:
    """Whether Clarabel may stop: with a margin that will do, or since there is none."""
    margin, bound = -info.cost_primal, -info.cost_dual
    if margin > TOLERANCE and info.res_primal < 1e-6 * margin:
        return bool(margin > ENOUGH or abs(bound - margin) < NEARLY * margin)
    return _is_nothing(margin) and bound < NOTHING


def _is_nearly_largest(info: Any) -> bool:
    """Whether Clarabel has nearly the largest margin, with equations that hold much better than that."""
    margin, bound = -info.cost_primal, -info.cost_dual
    return bool(
        margin > TOLERANCE and info.res_primal < 1e-3 * margin and abs(bound - margin) < NEARLY * margin
    )


def _is_nothing(margin: float) -> bool:
    """All unknowns zero have the margin 0: where nothing is above, the solver goes there from below."""
    return -NOTHING < margin <= 0.0


def _weights(parts: Sequence[Array]) -> Array:
    """Powers of two, one for each unknown, that bring the largest entries which they add to 1."""
    largest = np.max([np.abs(part).max(axis=(1, 2)) for part in parts], axis=0)
    return np.asarray(np.exp2(-np.round(np.log2(np.where(largest > 0.0, largest, 1.0)))))


def _solved(
    layout: Layout,
    parts: Sequence[Array],
    weights: Array,
    trace: Array,
    ended: Callable[[Any], bool] | None = None,
) -> tuple[dict[str, Array], float] | None:
    """Unknowns with the largest margin, and the margin; trace · unknowns/weights ≤ 1. Stops where ``ended``."""
    bounded, cost = np.append(trace, 0.0), np.append(np.zeros(layout.size), -1.0)
    found = _cheapest(layout, parts, weights, cost, bounded, ended=ended)
    return None if found is None else (_unknowns(layout, found[:-1] * weights), float(found[-1]))


def _cheapest(
    layout: Layout,
    parts: Sequence[Array],
    weights: Array,
    cost: Array,
    bounded: Array,
    *,
    margin: float | None = None,
    ended: Callable[[Any], bool] | None = None,
) -> Array | None:
    """The scaled unknowns of least cost, with bounded · unknowns/weights ≤ 1, for which every condition keeps a margin;
    None: the margin is one unknown more. Stops where ``ended``."""
    import clarabel
    from scipy.sparse import csc_matrix, vstack

    size, count = layout.size, layout.multiplier_count
    blocks: list[Any] = []
    cones: list[Any] = []
    right: list[Array] = []
    for part in parts:
        one = _packed(np.eye(part.shape[1]))
        columns = -_packed(part * weights[:, None, None]).T
        blocks.append(csc_matrix(columns if margin is not None else np.column_stack([columns, one])))
        cones.append(clarabel.PSDTriangleConeT(part.shape[1]))
        right.append(-(margin or 0.0) * one)
    positive = np.hstack(
        [np.zeros((count, size - count)), -np.eye(count), np.zeros((count, cost.size - size))]
    )
    blocks += [csc_matrix(positive), csc_matrix(bounded[np.newaxis])]
    cones += [clarabel.NonnegativeConeT(count), clarabel.NonnegativeConeT(1)]
    right += [np.zeros(count), np.ones(1)]
    matrix = csc_matrix(vstack(blocks))
    settings = clarabel.DefaultSettings()
    settings.verbose = False
    settings.max_threads = 1
    # Where the largest margin is asked for, all is scaled already, and dense within its blocks: these would cost more
    # than they gain. A gain that is asked for may be far from 1.
    settings.equilibrate_enable = settings.chordal_decomposition_enable = margin is not None
    settings.iterative_refinement_max_iter = REFINED_FOR_MARGIN if margin is None else REFINED
    nothing = csc_matrix((cost.size, cost.size))
    solver = clarabel.DefaultSolver(nothing, cost, matrix, np.concatenate(right), cones, settings)
    if ended is not None:
        solver.set_termination_callback(ended)
    try:
        found = np.asarray(solver.solve().x)
    except BaseException as error:  # a panic of the solver's library is no Exception
        if type(error).__name__ != "PanicException":
            raise
        return None
    return found if found.size == cost.size and np.all(np.isfinite(found)) else None


def _unknowns(layout: Layout, values: Array) -> dict[str, Array]:
    """The unknowns out of one vector, multipliers not below zero."""
    start = layout.size - layout.multiplier_count
    return layout.unknowns(np.append(values[:start], np.maximum(values[start:], 0.0)))


def _diagonal(layout: Layout) -> Array:
    """1 for each diagonal entry of the symmetric unknowns, in the order of the vector."""
    return np.concatenate([np.equal(*np.triu_indices(n)).astype(float) for n in layout.symmetric.values()])


def _packed(matrix: Matrix) -> Array:
    """The upper triangle column by column, off the diagonal times √2 (Clarabel's PSDTriangleConeT)."""
    given = np.asarray(matrix, dtype=float)
    rows, columns, weights = _triangle(given.shape[-1])
    return np.asarray(weights * given[..., columns, rows])


@cache
def _upper(size: int) -> tuple[Any, Any]:
    """Rows and columns of the upper triangle."""
    return np.triu_indices(size)


@cache
def _triangle(size: int) -> tuple[Any, Any, Array]:
    """Rows, columns and weights of ``_packed``."""
    rows, columns = np.tril_indices(size)
    return rows, columns, np.where(rows == columns, 1.0, np.sqrt(2.0))
