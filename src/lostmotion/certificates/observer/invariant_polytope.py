"""A polytope that the error of an observer enters and does not leave, found in floats.

The error obeys ė = A e + Σ E w, where each w, the difference of a curve between drivetrain and observer, lies between 0
and what the difference of its argument allows, whatever the motion is: a differential inclusion. A polytope
{|h·e| ≤ 1} is invariant if h·ė < 0 on each of its faces; it is if one step e + τ·ė of any length τ > 0 leads inside
(Euler's approximating system: Blanchini & Miani 2008, Set-Theoretic Methods in Control, section 4).
docs/proofs.md, equations 19 to 22.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Length of Euler's step over its largest stable one (numerics: longer finds the polytope sooner, and a larger one).
STEP = 0.2

#: Decay, over that of the slowest pole, that the search adds to what is asked, and the part of it that the last round
#: must leave (numerics: the exact check needs a margin).
SPARE, LEFT = 0.1, 0.5

#: Where the search starts, over the polytope of differences that are free within their limits (numerics: below what is
#: found, since it grows from there).
START = 0.15

#: Rounds of the search, and the growth over its start at which it is given up (numerics).
ROUNDS, LARGEST = 3000, 100.0

#: Step over the fastest pole, and duration over the slowest, of the integrals of ``_peaks`` (numerics: they only shape
#: and start the search).
FINE, LONG = 0.05, 10.0

#: An argument so much smaller than the largest counts as zero: there a jump takes either sign (numerics).
ZERO = 1e-9


class Difference(NamedTuple):
    """Of a curve between drivetrain and observer: w has the sign of row·e, |w| ≤ limit, and |w| ≤ |row·e| unless it
    ``jumps``.

    ``row`` and ``effect`` (n,): ė = A e + effect·w.
    """

    row: Array
    effect: Array
    limit: float
    jumps: bool

    def bounds(self, errors: Array) -> tuple[Array, Array]:
        """Smallest and largest w (k,) at errors (k, n)."""
        z = errors @ self.row
        if not self.jumps:
            return np.clip(z, -self.limit, 0.0), np.clip(z, 0.0, self.limit)
        zero = ZERO * float(np.max(np.abs(z)))
        return np.where(z <= zero, -self.limit, 0.0), np.where(z >= -zero, self.limit, 0.0)

    @property
    def corners(self) -> tuple[float, ...]:
        """Values of row·e at which the bounds have a corner."""
        return (0.0,) if self.jumps else (-self.limit, 0.0, self.limit)


def invariant_polytope(a: Array, differences: Sequence[Difference], faces: int) -> Array | None:
    """Rows h (3 + faces, 3) with {|h·e| ≤ 1} invariant; the first three bound one state each. None if none is found.

    ``a`` is (3, 3); ``faces`` is the number of further pairs of faces.
    """
    poles = np.linalg.eigvals(a)
    slowest = -float(np.max(poles.real))
    if not slowest > 0.0:
        return None
    spare = SPARE * slowest
    spared = a + spare * np.eye(3)
    step = STEP * float(np.min(-2.0 * poles.real / np.abs(poles) ** 2))
    directions = _directions(_coordinates(a, differences), faces)
    start = START * _peaks(a, differences, directions)
    widths = start
    for _ in range(ROUNDS):
        points = _corners_of(directions, widths, differences)
        reached = (points + step * points @ spared.T) @ directions.T
        for difference in differences:
            low, high = difference.bounds(points)
            push = directions @ difference.effect
            reached += step * np.maximum(np.outer(low, push), np.outer(high, push))
        new = np.maximum(widths, reached.max(axis=0))
        if np.max(new / widths) < 1.0 + (1.0 - LEFT) * step * spare:
            return np.asarray(directions / widths[:, np.newaxis])
        widths = new
        if np.max(widths / start) > LARGEST:
            return None
    return None


def _coordinates(a: Array, differences: Sequence[Difference]) -> Array:
    """Columns: eigenvectors (real and imaginary part of a pair), each as long as the error may become along it."""
    values, vectors = np.linalg.eig(a)
    columns: list[Array] = []
    pairs: list[int] = []
    for value, vector in zip(values, vectors.T, strict=True):
        if value.imag == 0.0:
            columns.append(vector.real)
        elif value.imag > 0.0:
            pairs.append(len(columns))
            columns += [vector.real, vector.imag]
    unit = np.array(columns, dtype=float).T
    lengths = _peaks(a, differences, np.linalg.inv(unit))
    for i in pairs:
        lengths[[i, i + 1]] = np.max(lengths[[i, i + 1]])
    return np.asarray(unit * lengths)


def _peaks(a: Array, differences: Sequence[Difference], rows: Array) -> Array:
    """Largest rows·e (m,) if every difference were free within its limit: Σ limit·∫|rows exp(At) effect|dt."""
    from scipy.linalg import expm

    poles = np.linalg.eigvals(a)
    dt = FINE / float(np.max(np.abs(poles)))
    phi = expm(a * dt)
    moved = np.column_stack([d.effect * d.limit for d in differences])
    total = np.zeros(len(rows))
    for _ in range(int(-LONG / (float(np.max(poles.real)) * dt))):
        total += dt * np.abs(rows @ moved).sum(axis=1)
        moved = phi @ moved
    return total


def _directions(unit: Array, faces: int) -> Array:
    """Normals (3 + faces, 3): of the states, then evenly spread over half a sphere in ``unit``'s coordinates.

    Fibonacci's lattice: González 2010, Mathematical Geosciences 42, 49-64.
    """
    k = np.arange(faces) + 0.5
    height, turn = 1.0 - k / faces, np.pi * (1.0 + np.sqrt(5.0)) * k
    radius = np.sqrt(1.0 - height**2)
    sphere = np.column_stack([radius * np.cos(turn), radius * np.sin(turn), height])
    return np.vstack([np.eye(3), sphere @ np.linalg.inv(unit)])


def _corners_of(directions: Array, widths: Array, differences: Sequence[Difference]) -> Array:
    """Vertices (k, 3) of the polytope, and the points of its edges where a difference's bounds have a corner.

    Between them the largest h·ė over an error is that of a convex combination of them.
    """
    from scipy.spatial import ConvexHull

    rows = np.vstack([directions, -directions]) / np.tile(widths, 2)[:, np.newaxis]
    # The polar polytope: its facets are the vertices, its neighbours the edges.
    scale = np.max(np.abs(rows), axis=0)
    polar = ConvexHull(rows / scale)
    facets = rows[polar.simplices]
    vertices = np.linalg.solve(facets, np.ones((len(facets), 3, 1)))[:, :, 0]
    first, second = np.repeat(np.arange(len(facets)), 3), polar.neighbors.ravel()
    start, end = vertices[first[first < second]], vertices[second[first < second]]
    points = [vertices]
    for difference in differences:
        for corner in difference.corners:
            before, after = start @ difference.row - corner, end @ difference.row - corner
            crosses = before * after < 0.0
            share = (before[crosses] / (before[crosses] - after[crosses]))[:, np.newaxis]
            points.append(start[crosses] + share * (end[crosses] - start[crosses]))
    return np.vstack(points)
