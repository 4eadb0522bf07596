"""A fresh process runs kernels that are compiled already after 0.2 instead of 0.5 s of numba's own start."""

from __future__ import annotations

import contextlib
import gc
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any


@contextlib.contextmanager
def without_collection() -> Iterator[None]:
    """Python searches for garbage while numba makes its hundred thousand objects: 0.1 s for nothing."""
    collecting = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collecting:
            gc.enable()


def load_without_tables(ours: type) -> None:
    """Load kernels that ``ours``, one of numba's cache locators, finds without the tables that only compiling needs.

    numba reads its tables of types and functions, 0.2 s, before it looks into its cache, and once more before it
    compiles. Of what it does there, a compiled kernel needs the runtime that counts its arrays alone.
    """
    from numba.core import caching
    from numba.core.runtime import rtsys

    numbas_own: Any = caching.Cache.load_overload

    def load_overload(self: Any, sig: Any, target_context: Any) -> Any:
        if not isinstance(self._impl.locator, ours):
            return numbas_own(self, sig, target_context)
        rtsys.initialize(target_context)
        with self._guard_against_spurious_io_errors():
            found = self._load_overload(sig, target_context)
        if found is None:
            _tell_of_compiling()
        return found

    caching.Cache.load_overload = load_overload  # type: ignore[method-assign]


@cache
def _tell_of_compiling() -> None:
    """Once: why the first call takes long. Commands compile beforehand, and show which step of how many."""
    # A program without a console has no standard error.
    if sys.stderr is not None and ("ipykernel" in sys.modules or sys.stderr.isatty()):
        print(
            "lostmotion compiles its kernels for this processor, once; that can take a minute.",
            file=sys.stderr,
        )
