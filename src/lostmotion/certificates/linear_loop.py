"""The loop made linear: every curve is a slope times its argument. Floats; nothing here is part of a proof."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray

from .sampled_proof import SampledProof

Array = NDArray[np.float64]

#: Groups of curves of which all combinations of slopes are tried (numerics: 32 loops, a few ms).
MOST_GROUPS = 5
#: Terms of Taylor's series (numerics: of a matrix of norm 1/2 the rest is below 1e-17).
TERMS = 15


def exponential(matrix: Array) -> Array:
    """exp(matrix) of a small square matrix, by scaling, Taylor's series and squaring.

    ``scipy.linalg.expm`` wakes the threads of its BLAS for a few rows: from Python, with two threads on two cores that
    have other work, it takes 10 ms instead of 0.07 ms, and ``harmonic_balance`` 6.5 s instead of 0.3 s. The command
    line has one thread; a library must not choose for the program that imports it.
    """
    squarings = max(0, int(np.ceil(np.log2(max(float(np.max(np.sum(np.abs(matrix), axis=1))), 1e-300)))) + 1)
    scaled = matrix * 0.5**squarings
    total, term = np.eye(len(matrix)), np.eye(len(matrix))
    for i in range(1, TERMS):
        term = term @ scaled / i
        total = total + term
    for _ in range(squarings):
        total = total @ total
    return total


def flow_and_step(proof: SampledProof, slopes: Array) -> tuple[Array, Array]:
    """Rates over a sample (n, n), and the state's map from sample to sample (n, n), for slopes of all curves."""
    p = proof.sizes[1]
    w = slopes[:p, np.newaxis] * proof.Z
    of_law = slopes[p:, np.newaxis]
    v = np.linalg.solve(np.eye(of_law.size) - of_law * proof.N_v, of_law * (proof.N + proof.N_w @ w))
    flow = (proof.A + proof.E @ w) * proof.substeps
    return flow, (proof.S + proof.S_w @ w + proof.S_v @ v) @ exponential(flow)


def is_stable(step: Array) -> bool:
    """Whether the linear loop goes to its rest."""
    return bool(np.max(np.abs(np.linalg.eigvals(step))) < 1.0)


def is_stable_in_sectors(proof: SampledProof) -> bool:
    """Whether the loop is stable with each curve, and its copies, at the top or at the bottom of its sector, in all
    combinations.

    The sectors allow these slopes: where the linear loop is unstable there, the solver is not asked. Copies whose
    sectors differ get slopes that differ, which cross multipliers may exclude: then a proof may be missed.
    """
    groups = _copied(proof)
    for ends in product((1, 0), repeat=len(groups)):
        slopes = np.array(proof.slopes, dtype=float)
        for group, end in zip(groups, ends, strict=True):
            places = [j for j in group if np.isfinite(proof.sectors[j, end])]
            slopes[places] = proof.sectors[places, end]
        if not is_stable(flow_and_step(proof, slopes)[1]):
            return False
    return True


def _copied(proof: SampledProof) -> list[set[int]]:
    """Numbers of the curves, those together that are copies of one."""
    groups: list[set[int]] = []
    for curve in range(len(proof.slopes)):
        mine = {curve} | {c.first for c in proof.copies if c.second == curve}
        groups = [g for g in groups if not g & mine] + [set().union(mine, *(g for g in groups if g & mine))]
    return groups[:MOST_GROUPS]
