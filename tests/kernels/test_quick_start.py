"""numba is the same after its quick start: a user's own functions compile, and find BLAS."""

from __future__ import annotations

import subprocess
import sys

SIMULATION = """
import numpy as np, lostmotion as lm

plant = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0)
lm.simulate(plant, torque_motor=np.full(100, 5.0), dt=1e-4)["speed_load"]
"""
#: scipy.linalg stands for all of numba's tables: it comes with them.
AFTERWARDS = """
import gc, numba, sys
assert gc.isenabled()
assert "scipy.linalg" not in sys.modules

@numba.njit
def product(a):
    return np.dot(a, a), np.kron(a, a)[0, 0], np.linalg.inv(a)

square, first, inverse = product(2.0 * np.eye(2))
assert square[0, 0] == 4.0 and first == 4.0 and inverse[0, 0] == 0.5
"""


def test_compiled_kernels_need_none_of_numbas_tables_and_other_functions_get_them() -> None:
    for code in (SIMULATION, SIMULATION + AFTERWARDS):  # the first may have to compile
        subprocess.run([sys.executable, "-c", code], check=True)
