"""A discrete law run twice more, to compare the kernel with: in plain Python floats, and in compiled C."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lostmotion import export
from lostmotion.systems import DiscreteSystem

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")

_DRIVER = """
#include "law.h"
void run(const law_real *inputs, law_real *outputs, unsigned long *faults, long n);
void run(const law_real *inputs, law_real *outputs, unsigned long *faults, long n)
{
    law_state state;
    long k;
    law_init(&state);
    for (k = 0; k < n; k++) {
        faults[k] = law_step(&state, (const law_in *)inputs + k, (law_out *)outputs + k);
    }
}
"""


def numba_run(
    law: DiscreteSystem, inputs: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    from lostmotion.kernels.law import law_run

    state = np.concatenate([law.initial_state, np.zeros(len(law.inputs))])
    return law_run(law.tables(), state, inputs)


def python_run(
    law: DiscreteSystem, inputs: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The four equations, written down once more from the matrices themselves."""

    def sparse(*blocks: NDArray[np.float64]) -> list[list[tuple[int, float]]]:
        return [[(int(j), float(row[j])) for j in np.flatnonzero(row)] for row in np.hstack(blocks)]

    def total(row: list[tuple[int, float]], v: list[float]) -> float:
        result = 0.0
        for j, coefficient in row:
            result += coefficient * v[j]
        return result

    z_rows, y_rows = sparse(law.F, law.G, law.H), sparse(law.C, law.D, law.J)
    x_rows = sparse(law.A, law.B, law.E)
    curves = [(c.points, c.slopes) for c in law.curves]
    x, u = law.initial_state.tolist(), [0.0] * len(law.inputs)
    outputs, faults = [], []
    for sample in inputs.tolist():
        good = [abs(value) <= 1e30 for value in sample]
        u = [new if ok else old for new, old, ok in zip(sample, u, good, strict=True)]
        v = x + u
        for row, (points, slopes) in zip(z_rows, curves, strict=True):
            z = total(row, v)
            segment = sum(z >= point[0] for point in points)
            z_anchor, w_anchor = points[max(segment - 1, 0)]
            v.append(w_anchor + slopes[segment] * (z - z_anchor))
        outputs.append([total(row, v) for row in y_rows])
        x = [total(row, v) for row in x_rows]
        faults.append(sum(1 << i for i, ok in enumerate(good) if not ok))
    return np.array(outputs).reshape(len(inputs), len(law.outputs)), np.array(faults)


def c_run(
    law: DiscreteSystem, inputs: NDArray[np.float64], folder: Path, real: str = "double"
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    export.c(law, folder, name="law", real=real, vectors=2)
    number = np.float64 if real == "double" else np.float32
    (folder / "driver.c").write_text(_DRIVER)
    library = folder / "law.so"
    command = [COMPILER, *export.C_FLAGS, "-shared", "-fPIC", "-o", str(library), "law.c", "driver.c"]
    subprocess.run(command, cwd=folder, check=True, capture_output=True, text=True)
    inputs = np.ascontiguousarray(inputs, dtype=number)
    outputs = np.empty((len(inputs), len(law.outputs)), dtype=number)
    faults = np.zeros(len(inputs), dtype=np.uint64 if ctypes.sizeof(ctypes.c_ulong) == 8 else np.uint32)
    pointers = [ctypes.c_void_p(a.ctypes.data) for a in (inputs, outputs, faults)]
    ctypes.CDLL(str(library)).run(*pointers, ctypes.c_long(len(inputs)))
    return outputs, faults.astype(np.int64)


def random_inputs(law: DiscreteSystem, n: int, seed: int) -> NDArray[np.float64]:
    """Steps with noise, and one value in fifty NaN, infinite or absurd."""
    rng = np.random.default_rng(seed)
    inputs = np.repeat(3.0 * rng.normal(size=(n // 20 + 1, len(law.inputs))), 20, axis=0)[:n]
    inputs += 0.3 * rng.normal(size=inputs.shape)
    bad = rng.random(inputs.shape) < 0.02
    inputs[bad] = rng.choice([np.nan, np.inf, -np.inf, 1e300], size=inputs.shape)[bad]
    return inputs
