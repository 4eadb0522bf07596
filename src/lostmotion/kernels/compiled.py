"""Whether the kernels have been compiled here for this processor; loads neither numba nor a kernel."""

from __future__ import annotations

import contextlib
import importlib.metadata
import os
import sys
from functools import cache
from pathlib import Path

from .fresh_cache import combined_hash

#: The folder of the kernels, beside which numba keeps what it compiled.
_HERE = Path(__file__).parent
_BESIDE = _HERE / "__pycache__"


@cache
def _key() -> str:
    """A hash of what compiled kernels depend on: sources, Python, numba, processor."""
    from llvmlite import binding

    sources = {path.relative_to(_HERE).as_posix(): path.read_bytes() for path in _HERE.rglob("*.py")}
    processor = os.environ.get("NUMBA_CPU_NAME") or binding.get_host_cpu_name()
    features = os.environ.get("NUMBA_CPU_FEATURES")
    if features is None:
        features = binding.get_host_cpu_features().flatten()
    platform = (sys.version, importlib.metadata.version("numba"), processor, features)
    return combined_hash({**sources, **{f"platform {k}": v.encode() for k, v in enumerate(platform)}})


def _places() -> list[Path]:
    """Folders in which a mark may stand, the best to write first."""
    own = os.environ.get("NUMBA_CACHE_DIR")
    cache_home = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return [*([Path(own)] if own else []), _BESIDE, Path(cache_home) / "lostmotion"]


def is_compiled(part: str) -> bool:
    """Whether a part of the kernels (see ``precompile``) has been compiled for this processor by these sources."""
    for place in _places():
        with contextlib.suppress(OSError):
            if (place / _mark(part)).read_text() == _key():
                return True
    return False


def mark_compiled(part: str) -> None:
    """Remember that a part has been compiled; where nothing can be written, it is not remembered."""
    for place in _places():
        with contextlib.suppress(OSError):
            place.mkdir(parents=True, exist_ok=True)
            (place / _mark(part)).write_text(_key())
            return


def _mark(part: str) -> str:
    return f"compiled-{part}.{sys.implementation.cache_tag}"
