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

#: C that runs an exported law over all rows of its inputs.
_DRIVER = Path(__file__).parents[1] / "fixtures" / "law_driver.c"


def numba_run(
    law: DiscreteSystem, inputs: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    from lostmotion.kernels.law.step import law_run

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
            if memory.check.missing_only:
                unsure = any(fault >> (k - len(x)) & 1 for k, _ in row if len(x) <= k < len(x) + len(u))
                u[i], bad = memory.filled(sample[i], predicted, unsure)
            else:
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
        self.count, self.bad = 0, False
        self.error = self.before = self.good = 0.0
        self.doubt = 2 * check.hold
        self.largest_error = self.largest_change = self.longest_run = 0.0

    def filled(self, given: float, predicted: float, unsure: bool) -> tuple[float, bool]:
        if abs(given) <= 1e30:
            self.good = given
            return given, False
        return (self.good if self.check.keep or unsure or not abs(predicted) <= 1e30 else predicted), True

    def checked(self, given: float, predicted: float, kept: float) -> tuple[float, bool]:
        missing, lost, armed = (
            not abs(given) <= 1e30,
            not abs(predicted) <= 1e30,
            0 <= self.doubt < self.check.hold,
        )
        replacement = kept if self.check.keep or lost else predicted
        if missing or lost:
            self.last = None
            if missing and armed:
                self._doubted()
            return (replacement, True) if missing else (given, False)
        jump, frozen = self._judged(given, given - predicted, armed)
        if armed and (jump or frozen):
            self._doubted(frozen)
            return replacement, True
        if self.doubt < 0 and frozen:
            self.doubt = self.doubt - 1 if 1 - self.doubt <= 3 * self.check.hold else 2 * self.check.hold
            return replacement, True
        if armed:
            self.doubt = 0
        elif jump or self.doubt < 0:
            self.doubt = 2 * self.check.hold
        elif not frozen:
            self.doubt = self.doubt - 1 if self.doubt > self.check.hold + 1 else 0
        return given, frozen

    def _judged(self, given: float, error: float, armed: bool) -> tuple[bool, bool]:
        size, follows, same = abs(error), self.last is not None and not self.bad, given == self.last
        back = self.last is not None and self.bad and self.count < 5 and armed
        bound = max((0.5 if back else 1.0) * self.check.limit, 1.5 * self.largest_error)
        sudden = max(0.25 * self.check.limit, 3.0 * self.largest_change)
        change = abs(error - self.error) if follows and not same else 0.0
        jump = size > bound or (change > sudden and size > abs(self.error))
        if back and self.last is not None:
            jump = jump or size >= abs(given - self.last)
        frozen = self._frozen(given, error) if same else False
        if not same:
            self.before = self.error if follows else error
            if follows:
                run = float(min(self.count, self.check.hold))
                self.longest_run = max(run, self.check.forget * self.longest_run)
            self.last, self.count = given, 1
        self.bad = frozen or (jump and armed)
        if jump and armed:
            if self.doubt == 0 and size > bound:
                self.largest_error += 0.125 * (min(size, 8.0 * bound) - self.largest_error)
            elif self.doubt == 0:
                self.largest_change += 0.125 * (min(change, 8.0 * sudden) - self.largest_change)
        elif follows and not frozen:
            self.largest_error = max(min(size, 8.0 * bound), self.check.forget * self.largest_error)
            if not same:
                self.largest_change = max(min(change, 8.0 * sudden), self.check.forget * self.largest_change)
        self.error = error
        return jump, frozen

    def _frozen(self, given: float, error: float) -> bool:
        self.count += 1
        usual = max(8.0, self.longest_run)
        needed = 0.75 * self.largest_change * (usual if self.count > usual else 3.0 * usual)
        moved = min(abs(error - self.before), abs(error)) * min(max(self.count, usual), 10.0 * usual)
        often = self.check.alone and given != 0.0 and self.count > max(5.0, 3.0 * self.longest_run)
        return self.bad or often or (self.count >= 5 and 0.0 < needed < moved)

    def _doubted(self, frozen: bool = False) -> None:
        over = -1 if frozen else 2 * self.check.hold
        self.doubt = self.doubt + 1 if self.doubt + 1 < self.check.hold else over


def c_run(
    law: DiscreteSystem, inputs: NDArray[np.float64], folder: Path, real: str = "double"
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    export.c(law, folder, name="law", real=real, vectors=2)
    number = np.float64 if real == "double" else np.float32
    (folder / "driver.c").write_bytes(_DRIVER.read_bytes())
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
