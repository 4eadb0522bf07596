"""A discrete law run twice more, to compare the kernel with: in plain Python floats, and in compiled C."""

from __future__ import annotations

import ctypes
import shutil
import subprocess
from functools import reduce
from operator import add
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lostmotion import export
from lostmotion.systems import DiscreteSystem, InputCheck

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

    return law_run(law.tables(), law.init(), inputs)


def python_run(
    law: DiscreteSystem, inputs: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """The four equations, written down once more from the matrices themselves."""

    def sparse(*blocks: NDArray[np.float64]) -> list[list[tuple[int, float]]]:
        return [[(int(j), float(row[j])) for j in np.flatnonzero(row)] for row in np.hstack(blocks)]

    def total(row: list[tuple[int, float]], v: list[float]) -> float:
        products = [coefficient * v[j] for j, coefficient in row]
        return reduce(add, products) if products else 0.0

    z_rows, y_rows = sparse(law.F, law.G, law.H), sparse(law.C, law.D, law.J)
    x_rows, p_rows = sparse(law.A, law.B, law.E), sparse(law.P, law.Q, law.R)
    curves = [(c.points, c.slopes) for c in law.curves]
    x, u = law.initial_state.tolist(), [0.0] * len(law.inputs)
    checks = {
        law.inputs.index(c.input): (c, row, Memory(c)) for c, row in zip(law.checks, p_rows, strict=True)
    }
    early = max((j - len(x) - len(u) + 1 for _, row, _ in checks.values() for j, _ in row), default=0)
    outputs, faults = [], []

    def curve(v: list[float], i: int) -> float:
        points, slopes = curves[i]
        z = total(z_rows[i], v)
        segment = sum(z >= point[0] for point in points)
        z_anchor, w_anchor = points[max(segment - 1, 0)]
        return w_anchor + slopes[segment] * (z - z_anchor) if slopes[segment] else w_anchor

    for sample in inputs.tolist():
        good = [abs(value) <= 1e30 for value in sample]
        fault = 0
        for i in range(len(u)):
            if i not in checks:
                u[i] = sample[i] if good[i] else u[i]
                fault |= (not good[i]) << i
        w: list[float] = []
        for i in range(max(early, 0)):
            w.append(curve(x + u + w, i))
        for i, (_, row, memory) in checks.items():
            predicted = total(row, x + u + w)
            u[i], bad = memory.checked(sample[i], predicted, u[i])
            fault |= bad << i
        for i in range(len(w), len(curves)):
            w.append(curve(x + u + w, i))
        v = x + u + w
        outputs.append([total(row, v) for row in y_rows])
        x = [total(row, v) for row in x_rows]
        faults.append(fault)
    return np.array(outputs).reshape(len(inputs), len(law.outputs)), np.array(faults)


class Memory:
    """What a check remembers, and its rule once more."""

    def __init__(self, check: InputCheck) -> None:
        self.check = check
        self.last: float | None = None
        self.times = 0
        self.first = 0.0
        self.after_jump = False
        self.doubt = 2 * check.hold
        self.largest_error = self.largest_step = 0.0

    def checked(self, given: float, predicted: float, kept: float) -> tuple[float, bool]:
        missing, lost = not abs(given) <= 1e30, not abs(predicted) <= 1e30
        replacement = kept if self.check.keep or lost else predicted
        if missing:
            self.last, self.after_jump = None, False
            self._bad()
            return replacement, True
        if lost:
            self.last, self.after_jump = None, False
            return given, False
        error, armed = abs(given - predicted), self.doubt < self.check.hold
        limit = 0.5 * self.check.limit if self.after_jump else self.check.limit
        bound = max(limit, 1.5 * self.largest_error)
        jump, frozen, step = error > bound, False, 0.0
        self.after_jump = False
        if self.last is not None and given == self.last:
            self.times += 1
            moved = min(abs(predicted - self.first), error)
            frozen = self.times >= 5 and 0.0 < 0.75 * self.largest_step < moved
        else:
            if self.last is not None and self.times == 1:
                step = abs(given - self.last)
            self.last, self.times, self.first = given, 1, predicted
        capped = min(error, 8.0 * bound)
        if jump and armed:
            self.last, self.after_jump = None, True
            if self.doubt == 0:
                self.largest_error += 0.125 * (capped - self.largest_error)
        else:
            self.largest_error = max(capped, self.check.forget * self.largest_error)
            if step > 0.0:
                self.largest_step = max(min(step, bound), self.check.forget * self.largest_step)
        if armed and (jump or frozen):
            self._bad()
            return replacement, True
        if armed:
            self.doubt = 0
        elif jump:
            self.doubt = 2 * self.check.hold
        elif not frozen:
            self.doubt = self.doubt - 1 if self.doubt > self.check.hold + 1 else 0
        return given, frozen

    def _bad(self) -> None:
        if self.doubt < self.check.hold:
            self.doubt = self.doubt + 1 if self.doubt + 1 < self.check.hold else 2 * self.check.hold


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
    """Steps with noise, some of them frozen, and one value in fifty NaN, infinite or absurd."""
    rng = np.random.default_rng(seed)
    inputs = np.repeat(3.0 * rng.normal(size=(n // 20 + 1, len(law.inputs))), 20, axis=0)[:n]
    moving = np.repeat(rng.random((n // 20 + 1, len(law.inputs))) < 0.8, 20, axis=0)[:n]
    inputs += 0.3 * rng.normal(size=inputs.shape) * moving
    bad = rng.random(inputs.shape) < 0.02
    inputs[bad] = rng.choice([np.nan, np.inf, -np.inf, 1e300], size=inputs.shape)[bad]
    return inputs
