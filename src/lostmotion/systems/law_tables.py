"""The numbers and the shape of a discrete law in the form that the kernels run."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..curves import PiecewiseLinear
from .input_check import InputCheck

if TYPE_CHECKING:
    from ..kernels.law.step import LawTables


def law_tables(
    rows: NDArray[np.float64],
    sizes: tuple[int, int, int],
    curves: Sequence[PiecewiseLinear],
    early_curves: int,
    checks: Sequence[tuple[int, InputCheck]],
) -> LawTables:
    """The law in the form that the kernels run; the first one of a shape compiles its code (some ten ms).

    Parameters
    ----------
    rows : (curves + outputs + states + checks, states + inputs + curves) array
        The matrices of ``DiscreteSystem`` one below the other: z, y, x⁺, p by x, u, w.
    sizes : numbers of states, inputs and outputs
    early_curves : int
        How many curves are evaluated before the inputs are checked.
    checks : pairs of an input's number and its check
    """
    from ..kernels.law.machine_code import FLAT, ONE, STEEP, LawShape, step_code
    from ..kernels.law.step import LawTables

    n_states, n_inputs, n_outputs = sizes
    shape = LawShape(
        n_states=n_states,
        n_inputs=n_inputs,
        n_curves=len(curves),
        n_outputs=n_outputs,
        n_early=early_curves,
        rows=tuple(tuple(np.flatnonzero(row).tolist()) for row in rows),
        slopes=tuple(tuple({0.0: FLAT, 1.0: ONE}.get(slope, STEEP) for slope in c.slopes) for c in curves),
        checks=tuple((i, c.keep, c.alone, c.missing_only) for i, c in checks),
    )
    points = [point for c in curves for point in c.points]
    numbers = [
        *(z for z, _ in points), *(w for _, w in points), *(slope for c in curves for slope in c.slopes),
        *(number for _, c in checks for number in (c.limit, float(c.hold), c.forget)),
    ]  # fmt: skip
    return LawTables(
        n_states=n_states,
        n_inputs=n_inputs,
        n_outputs=n_outputs,
        code=step_code(shape).address,
        numbers=np.concatenate([rows[rows != 0.0], numbers]),
    )
