"""numba's tables of types and functions, loaded in 0.15 instead of 0.4 s."""

from __future__ import annotations

import contextlib
import gc
from collections.abc import Iterator
from typing import Any


def load_numba() -> None:
    """Load what a kernel's first call would load."""
    with _without_collection():
        from numba.core.registry import cpu_target

        with _blas_later():
            cpu_target.typing_context.refresh()
            cpu_target.target_context.refresh()


@contextlib.contextmanager
def _without_collection() -> Iterator[None]:
    """Python searches for garbage while numba makes its hundred thousand objects: 0.1 s for nothing."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


@contextlib.contextmanager
def _blas_later() -> Iterator[None]:
    """numba imports scipy.linalg, 0.13 s, only to ask whether there is a BLAS; it asks again before it uses it."""
    from numba.np import linalg

    asks: Any = getattr(linalg, "ensure_blas", None)
    linalg.ensure_blas = lambda: None
    try:
        yield
    finally:
        linalg.ensure_blas = asks
