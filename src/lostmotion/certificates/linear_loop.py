"""The loop made linear: every curve is a slope times its argument. Floats; nothing here is part of a proof."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .sampled_proof import SampledProof

Array = NDArray[np.float64]


def flow_and_step(proof: SampledProof, slopes: Array) -> tuple[Array, Array]:
    """Rates over a sample (n, n), and the state's map from sample to sample (n, n), for slopes of all curves."""
    from scipy.linalg import expm

    p = proof.sizes[1]
    w = slopes[:p, np.newaxis] * proof.Z
    of_law = slopes[p:, np.newaxis]
    v = np.linalg.solve(np.eye(of_law.size) - of_law * proof.N_v, of_law * (proof.N + proof.N_w @ w))
    flow = (proof.A + proof.E @ w) * proof.substeps
    return flow, (proof.S + proof.S_w @ w + proof.S_v @ v) @ expm(flow)


def is_stable(step: Array) -> bool:
    """Whether the linear loop goes to its rest."""
    return bool(np.max(np.abs(np.linalg.eigvals(step))) < 1.0)


def is_stable_in_sectors(proof: SampledProof) -> bool:
    """Whether the loop is stable with each curve, and its copies, at the top of its sector.

    The sectors allow these slopes: where the linear loop is unstable there, the solver is not asked. Copies whose
    sectors differ get slopes that differ, which cross multipliers may exclude: then a proof may be missed.
    """
    for curve in range(proof.sizes[1]):
        group = {curve} | {c.second for c in proof.copies if c.first == curve}
        places = [j for j in group if np.isfinite(proof.sectors[j, 1])]
        slopes = np.array(proof.slopes, dtype=float)
        slopes[places] = proof.sectors[places, 1]
        if not is_stable(flow_and_step(proof, slopes)[1]):
            return False
    return True
