"""A discrete law, sample by sample: any number of kernels call the machine code of ``machine_code.step_code``.

No fastmath, no contraction, no BLAS: this code, plain Python and the exported C do the very same operations in the same
order, so their results agree bit for bit.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np
from llvmlite import ir
from numba import types
from numpy.typing import NDArray

from ..jit import njit
from ..numerics.vectors import address, intrinsic

#: Layout.
_LONG = ir.IntType(64)
_POINTER = ir.IntType(8).as_pointer()
_STEP = ir.FunctionType(_LONG, [_POINTER] * 4)


class LawTables(NamedTuple):
    """A discrete law as code and numbers; v = (x, u, w) is the vector of states, checked inputs and curve values.

    Rows come in the order z (one for each curve), y, x⁺, p (the prediction of each checked input). ``numbers`` holds
    their coefficients that are not zero, by row and column; then all curves' points, z and w; the slopes of their
    segments (one more than points); then limit, hold and forgetting factor of each check.
    """

    n_states: int
    n_inputs: int
    n_outputs: int
    code: int  # address of the step, see ``machine_code.step_code``
    numbers: NDArray[np.float64]


@intrinsic
def step_at(typing: Any, code: Any, numbers: Any, state: Any, inputs: Any, outputs: Any) -> Any:
    """One step by addresses: of the code, and of the arrays that ``law_step`` takes; returns the bit mask."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        function = builder.inttoptr(args[0], _STEP.as_pointer())
        return builder.call(function, [builder.inttoptr(a, _POINTER) for a in args[1:]])

    return types.int64(*[types.int64] * 5), generate


@njit(cache=True, inline="always")
def law_step(tables, state, inputs, outputs):
    """One step; returns a bit mask of the inputs that were bad (bit i for input i), 0 if all were good.

    Parameters
    ----------
    tables : LawTables
    state : array, changed in place
        x, then the last good inputs (0 at the start), then what each check remembers: ``DiscreteSystem.start``.
    inputs : (n_inputs,) array
        Raw inputs of this sample.
    outputs : (n_outputs,) array, written
    """
    return step_at(tables.code, address(tables.numbers), address(state), address(inputs), address(outputs))


@njit(cache=True, nogil=True)
def law_run(tables, state, inputs):
    """All rows of ``inputs`` (n, n_inputs) in turn; ``state`` (layout of ``law_step``) ends as the final one.

    Returns the outputs (n, n_outputs) and the fault masks (n,).
    """
    n = inputs.shape[0]
    outputs = np.empty((n, tables.n_outputs))
    faults = np.zeros(n, dtype=np.int64)
    code, numbers, x = tables.code, address(tables.numbers), address(state)
    u, y = address(inputs), address(outputs)
    for k in range(n):
        faults[k] = step_at(code, numbers, x, u + 8 * tables.n_inputs * k, y + 8 * tables.n_outputs * k)
    return outputs, faults
