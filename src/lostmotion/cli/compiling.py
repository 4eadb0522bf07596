"""Kernels are compiled before a command begins, so that its user sees how far this is."""

from __future__ import annotations

from ..kernels.compiled import is_compiled
from .messages import interruptible


def compile_kernels(*parts: str, shown: bool = True) -> None:
    """Compile the parts of the kernels (keys of ``precompile.PARTS``) that this processor has not yet."""
    if all(is_compiled(part) for part in parts):
        return
    from ..precompile import compile_missing
    from ..terminal import Countdown

    with interruptible(), Countdown("compiling kernels, once", shown) as bar:
        compile_missing(parts, bar)
