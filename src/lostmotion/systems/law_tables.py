"""A DiscreteSystem in the form that the kernels run: its shape, which becomes code, and its numbers."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..kernels.law import LawTables
    from .discrete_system import DiscreteSystem


def law_tables(law: DiscreteSystem) -> LawTables:
    """The law in the form that the kernels run; the first one of a shape compiles its code (some ten ms)."""
    from ..kernels.law import LawTables
    from ..kernels.law_code import FLAT, ONE, STEEP, LawShape, step_code

    rows = np.vstack([
        np.hstack([law.F, law.G, law.H]),
        np.hstack([law.C, law.D, law.J]),
        np.hstack([law.A, law.B, law.E]),
        np.hstack([law.P, law.Q, law.R]),
    ])  # fmt: skip
    shape = LawShape(
        n_states=len(law.states),
        n_inputs=len(law.inputs),
        n_curves=len(law.curves),
        n_outputs=len(law.outputs),
        n_early=law.early_curves,
        rows=tuple(tuple(np.flatnonzero(row).tolist()) for row in rows),
        slopes=tuple(
            tuple({0.0: FLAT, 1.0: ONE}.get(slope, STEEP) for slope in c.slopes) for c in law.curves
        ),
        checks=tuple((law.inputs.index(c.input), c.keep, c.alone, c.missing_only) for c in law.checks),
    )
    points = [point for c in law.curves for point in c.points]
    numbers = [
        *(z for z, _ in points), *(w for _, w in points), *(slope for c in law.curves for slope in c.slopes),
        *(number for c in law.checks for number in (c.limit, float(c.hold), c.forget)),
    ]  # fmt: skip
    return LawTables(
        n_states=shape.n_states,
        n_inputs=shape.n_inputs,
        n_outputs=shape.n_outputs,
        code=step_code(shape).address,
        numbers=np.concatenate([rows[rows != 0.0], numbers]),
    )
