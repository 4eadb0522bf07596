"""From continuous to discrete time, and the delay of one sample."""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .checks import matrix_of
from .discrete_system import DiscreteSystem, Matrix


@checks_arguments
def zero_order_hold(A: ArrayLike, B: ArrayLike, dt: float) -> tuple[Matrix, Matrix]:
    """Φ = exp(A·dt) and Γ = ∫exp(A·s)ds·B: the exact step of ẋ = Ax + Bu with u held over dt (s).

    A is (n, n), B is (n, m). Raises InvalidInput of other shapes, NaN, or a dt that is not a positive number.
    """
    if not (math.isfinite(dt) and dt > 0.0):
        raise InvalidInput("dt", repr(dt), "a positive sample time in s", "Check the unit.")
    b = np.asarray(B, dtype=float)
    if b.ndim != 2 or b.size == 0:
        raise InvalidInput("zero_order_hold.B", f"shape {b.shape}", "(states, inputs)", "Give a matrix.")
    n, m = b.shape
    a, b = matrix_of("zero_order_hold.A", A, (n, n)), matrix_of("zero_order_hold.B", b, (n, m))
    block = np.zeros((n + m, n + m))
    block[:n, :n], block[:n, n:] = a, b
    step = np.frombuffer(_exponential((block * dt).tobytes(), n + m)).reshape(n + m, n + m)
    return step[:n, :n].copy(), step[:n, n:].copy()


@lru_cache(maxsize=64)
def _exponential(matrix: bytes, size: int) -> bytes:
    """The exponential of a square matrix; cached, since a design is often repeated with other poles or weights."""
    from scipy.linalg import expm

    return bytes(expm(np.frombuffer(matrix).reshape(size, size)).tobytes())


@checks_arguments
def one_sample_delay(name: str, dt: float, delayed: str | None = None, start: float = 0.0) -> DiscreteSystem:
    """The signal ``name`` one sample later, as ``delayed`` (default: ``name`` + "_delayed"); breaks a loop.

    ``start`` is the first output value, in the signal's unit.
    """
    delayed = f"{name}_delayed" if delayed is None else delayed
    one = np.ones((1, 1))
    return DiscreteSystem(
        inputs=(name,), outputs=(delayed,), states=(delayed,), dt=dt, B=one, C=one,
        initial_state=np.array([start]), name=f"delay of {name}",
    )  # fmt: skip
