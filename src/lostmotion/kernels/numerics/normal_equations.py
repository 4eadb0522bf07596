"""Normal equations of a least-squares fit: half of a symmetric product, without BLAS and its threads."""

from __future__ import annotations

import numpy as np

from ..jit import njit


@njit(cache=True, nogil=True, fastmath={"contract", "reassoc", "nsz"}, error_model="numpy")
def products(jacobian, residual):
    """J Jᵀ (p, p) and J r (p,) for J (p, n), whose rows lie one after the other, and r (n,)."""
    p, n = jacobian.shape
    hessian, gradient = np.empty((p, p)), np.empty(p)
    for i in range(p):
        total = 0.0
        for k in range(n):
            total += jacobian[i, k] * residual[k]
        gradient[i] = total
        for j in range(i + 1):
            total = 0.0
            for k in range(n):
                total += jacobian[i, k] * jacobian[j, k]
            hessian[i, j] = hessian[j, i] = total
    return hessian, gradient
