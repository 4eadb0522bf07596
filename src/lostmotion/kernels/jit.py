"""numba's ``njit`` for kernels: what is compiled stays on disk until its source, or that of a kernel it calls, changes.

numba itself looks at a kernel's own file only. Here the stamp of what it keeps is a hash over a kernel's module and all
kernels that this one imports, see ``fresh_cache``. Where the files lie is numba's choice: in NUMBA_CACHE_DIR, else
beside the sources, else, where these cannot be written, in the user's own cache. The first and the last take what the
build compiled and the installation put beside the sources.
"""

from __future__ import annotations

import contextlib
import os
import shutil
from pathlib import Path
from typing import Any

from .fresh_cache import source_hashes
from .quick_start import load_without_tables, without_collection

with without_collection():
    from numba import cfunc, njit
    from numba.core import caching
    from numba.core.options import DefaultOptions

__all__ = ["BORROWED", "cfunc", "keep_fresh", "njit"]

#: For a kernel that makes no array, called by one that keeps the arrays. Otherwise numba counts each of these as used
#: and unused again in every call, with the memory locked: that took 45 % of a pass of the contact-switching filter
#: (Intel Xeon, 2026-11-27). The option is numba's own; without it kernels are slower, not wrong.
BORROWED: dict[str, Any] = {"_nrt": False} if hasattr(DefaultOptions, "_nrt") else {}


def keep_fresh(folder: Path) -> None:
    """All kernels below a folder that are decorated from now on are compiled anew when what they call has changed."""
    stamps = source_hashes(folder)
    prefix = f"{folder}{os.sep}"

    class Fresh:
        """One of numba's choices of a place, for kernels below the folder alone."""

        _py_file: str

        @classmethod
        def from_function(cls, py_func: Any, py_file: str) -> Any:
            if not py_file.startswith(prefix):
                return None
            found = super().from_function(py_func, py_file)  # type: ignore[misc]
            if found is not None:
                _take_installed(Path(py_file), py_func.__qualname__, Path(found.get_cache_path()))
            return found

        def get_source_stamp(self) -> str:
            return stamps[Path(self._py_file).relative_to(folder).with_suffix("").as_posix()]

    load_without_tables(Fresh)
    places = (caching.UserProvidedCacheLocator, caching.InTreeCacheLocator, caching.UserWideCacheLocator)
    own: list[Any] = [type(f"Fresh{place.__name__}", (Fresh, place), {}) for place in places]
    caching.CacheImpl._locator_classes = [*own, *caching.CacheImpl._locator_classes]


def _take_installed(source: Path, kernel: str, cache: Path) -> None:
    """Copies a kernel's compiled files from beside its source to another cache that has none, or older ones."""
    beside = source.parent / "__pycache__"
    if cache == beside:
        return
    # The index last: without it, numba looks for no other file.
    for file in sorted(beside.glob(f"{source.stem}.{kernel}-*.nb[ci]")):
        target = cache / file.name
        if not target.exists() or target.stat().st_mtime < file.stat().st_mtime:
            with contextlib.suppress(OSError):
                part = target.with_suffix(f".{os.getpid()}")
                shutil.copyfile(file, part)
                part.replace(target)


keep_fresh(Path(__file__).parent)
