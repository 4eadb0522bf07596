"""When a compiled kernel is stale: the hash of its source and of all kernels that it imports."""

from __future__ import annotations

import hashlib
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
