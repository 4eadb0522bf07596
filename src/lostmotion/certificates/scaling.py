"""Powers of two that bring states and conditions to like sizes for the solver; a proof does not need them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .linear_loop import flow_and_step, is_stable
from .sampled_proof import SampledProof

Array = NDArray[np.float64]


def power_of_two(values: Array) -> Array:
    """The nearest powers of two of positive numbers: scaling by them rounds nothing."""
    return np.asarray(np.exp2(np.round(np.log2(values))))


def state_sizes(proof: SampledProof) -> Array | None:
    """Typical sizes (n,) of the states by how far they move the plant; None if the linear loop is not stable.

    proof in floats. The loop made linear at its equilibrium, from sample to sample; W of its observability by the
    plant's speeds and accelerations: a state of size 1/√Wᵢᵢ moves them by about one.
    """
    from scipy.linalg import solve_discrete_lyapunov

    flow, step = flow_and_step(proof, np.asarray(proof.slopes, dtype=float))
    if not is_stable(step):
        return None
    turn = np.max(np.abs(np.linalg.eigvals(flow[:3, :3])))
    shown = np.vstack([np.eye(flow.shape[0])[1:3], flow[1:3] / turn])
    seen = np.diag(solve_discrete_lyapunov(step.T, shown.T @ shown))
    # What nothing reads, the gap's memory, is as large as what it remembers.
    read = np.any(step, axis=0)
    sizes = np.zeros(len(seen))
    sizes[read] = power_of_two(np.sqrt(np.max(seen[1:3]) / seen[read]))
    sizes[~read] = power_of_two(np.abs(proof.S[~read]) @ sizes)
    return sizes


def condition_sizes(proof: SampledProof, sizes: Array) -> list[Array]:
    """Typical sizes of the vector of each of ``proof.conditions``, in their order; proof in floats."""
    highest = np.abs(proof.sectors).max(axis=1)
    w = power_of_two(highest[: proof.sizes[1]] * (np.abs(proof.Z) @ sizes))
    v = np.zeros(proof.sizes[2])
    for j in range(v.size):
        s = np.abs(proof.N[j]) @ sizes + np.abs(proof.N_w[j]) @ w + np.abs(proof.N_v[j]) @ v
        v[j] = power_of_two(highest[w.size + j] * s)
    zeta = np.concatenate([sizes, v[list(proof.of_state)]])
    jump = np.concatenate([sizes, w[list(proof.seen)], v, v[list(proof.of_state)]])
    sizes_of = [zeta] * (proof.substeps + 1) + [np.concatenate([zeta, w])] * (2 * proof.substeps) + [jump]
    if proof.limit is not None:
        sizes_of.append(jump[: jump.size - len(proof.of_state)])
        sizes_of.append(power_of_two(1.0 / np.linalg.norm(np.asarray(proof.start) / sizes, axis=1)))
    return sizes_of
