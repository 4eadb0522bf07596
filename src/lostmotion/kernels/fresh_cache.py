"""Drops compiled kernels whose sources changed: numba looks at a kernel's own file only, not at what it imports.

For every module below a folder a hash over its source and those of the kernels that it imports is kept in one file
beside numba's. Where it differs, that module's compiled files go. Processes that do this at the same time do no harm:
numba writes its files whole, and compiles again where one is missing.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import re
from collections.abc import Mapping
from pathlib import Path

_IMPORT = re.compile(r"^[ \t]*from[ \t]+(\.+)([\w.]*)[ \t]+import[ \t]+(\([^)]*\)|.+)$", re.MULTILINE)


def combined_hash(sources: Mapping[str, bytes]) -> str:
    """One hash over names and sources, in any order."""
    digest = hashlib.sha256()
    for name in sorted(sources):
        digest.update(name.encode() + b"\0" + sources[name] + b"\0")
    return digest.hexdigest()


def source_hashes(folder: Path) -> dict[str, str]:
    """Module ("plant/layout") → hash of its source and of all kernels that it imports, near and far."""
    sources = {
        path.relative_to(folder).with_suffix("").as_posix(): path.read_bytes()
        for path in sorted(folder.rglob("*.py"))
    }
    imports = {name: _imported(name, source.decode()) & set(sources) for name, source in sources.items()}
    hashes = {}
    for name in sources:
        reached, new = {name}, {name}
        while new:
            new = set().union(*(imports[n] for n in new)) - reached
            reached |= new
        hashes[name] = combined_hash({part: sources[part] for part in reached})
    return hashes


def _imported(module: str, source: str) -> set[str]:
    """What a module imports by relative paths; each imported name may be a module, too."""
    found = set()
    for dots, path, names in _IMPORT.findall(source):
        parts = module.split("/")[: -len(dots)] + [part for part in path.split(".") if part]
        found.add("/".join(parts))
        found |= {"/".join([*parts, name]) for name in re.findall(r"\w+", names)}
    return found


def drop_stale(folder: Path) -> list[str]:
    """Removes what numba compiled from other sources; returns the modules. Does nothing where it cannot write."""
    record = folder / "__pycache__" / "kernel-sources.json"
    hashes = source_hashes(folder)
    try:
        known = json.loads(record.read_text())
    except (OSError, ValueError):
        known = {}
    stale = [name for name, value in hashes.items() if known.get(name) != value]
    if not stale:
        return []
    with contextlib.suppress(OSError):
        record.parent.mkdir(exist_ok=True)
        for name in stale:
            module = folder / name
            cache = module.parent / "__pycache__"
            for compiled in (*cache.glob(f"{module.name}.*.nbi"), *cache.glob(f"{module.name}.*.nbc")):
                compiled.unlink(missing_ok=True)
        # Last, and whole: a process that ends before leaves the old record, and the next one starts over.
        part = record.with_suffix(f".{os.getpid()}")
        part.write_text(json.dumps(hashes))
        part.replace(record)
    return stale
