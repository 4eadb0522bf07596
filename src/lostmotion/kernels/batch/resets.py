"""What a variant's numbers change in the tables of its elements."""

from __future__ import annotations

from typing import Any

from ..jit import njit
from ..plant.equations import ANGLE, ELEMENT, GAP, SHAFT_NUMBERS

_INNER: Any = {
    "cache": True, "fastmath": {"contract"}, "error_model": "numpy", "nogil": True, "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
}  # fmt: skip


@njit(**_INNER)
def set_resets(chain, p, reset_row):
    """The shaft angle on entering a contact is the twist beyond half the backlash (physical law)."""
    n, states = chain.inertias.shape[0] - 1, chain.states
    for i in range(n - 1):
        if chain.shafts[i, ANGLE] >= 0:
            half = p[2 + n + SHAFT_NUMBERS * i + 2]
            for digit in range(3):
                reset_row[chain.shafts[i, ELEMENT], digit, states] = -(digit - GAP) * half
