"""A law without what none of its outputs reads."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .discrete_system import DiscreteSystem


@checks_arguments
def pruned(law: DiscreteSystem, outputs: Sequence[str] | None = None) -> DiscreteSystem:
    """The law with these outputs alone, and only the states and curves that they depend on.

    Inputs stay, also those that nothing reads any more; checks of inputs are left out (``without_checks``).

    Raises
    ------
    InvalidInput
        If a name is no output of the law.
    """
    wanted = law.outputs if outputs is None else tuple(outputs)
    unknown = sorted(set(wanted) - set(law.outputs))
    if unknown:
        raise InvalidInput(
            "pruned.outputs", ", ".join(unknown), f"names out of {law.outputs}", "Check the name."
        )
    rows = np.array([law.outputs.index(name) for name in wanted], dtype=int)
    states = np.any(law.C[rows] != 0.0, axis=0)
    curves = np.any(law.J[rows] != 0.0, axis=0)
    while True:
        read_by_states = law.A[states] != 0.0, law.E[states] != 0.0
        read_by_curves = law.F[curves] != 0.0, law.H[curves] != 0.0
        more_states = states | np.any(read_by_states[0], axis=0) | np.any(read_by_curves[0], axis=0)
        more_curves = curves | np.any(read_by_states[1], axis=0) | np.any(read_by_curves[1], axis=0)
        if np.array_equal(more_states, states) and np.array_equal(more_curves, curves):
            break
        states, curves = more_states, more_curves
    x, w = np.flatnonzero(states), np.flatnonzero(curves)
    return replace(
        law.without_checks(),
        outputs=wanted, states=tuple(law.states[i] for i in x), curves=tuple(law.curves[i] for i in w),
        initial_state=law.initial_state[x],
        A=law.A[np.ix_(x, x)], B=law.B[x], E=law.E[np.ix_(x, w)],
        F=law.F[np.ix_(w, x)], G=law.G[w], H=law.H[np.ix_(w, w)],
        C=law.C[np.ix_(rows, x)], D=law.D[rows], J=law.J[np.ix_(rows, w)],
    )  # fmt: skip
