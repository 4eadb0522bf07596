"""numba is the same after its quick start: it finds its BLAS when it needs it."""

from __future__ import annotations

import subprocess
import sys

CODE = """
import sys
import lostmotion.kernels.jit
assert "scipy.linalg" not in sys.modules
import gc, numba, numpy as np
assert gc.isenabled()

@numba.njit
def product(a):
    return np.dot(a, a), np.kron(a, a)[0, 0], np.linalg.inv(a)

square, first, inverse = product(2.0 * np.eye(2))
assert square[0, 0] == 4.0 and first == 4.0 and inverse[0, 0] == 0.5
"""


def test_blas_is_found_when_it_is_needed() -> None:
    subprocess.run([sys.executable, "-c", CODE], check=True)
