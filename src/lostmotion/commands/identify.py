"""lostmotion identify: the parameters alone, as JSON and picture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import plot
from ..io import save_json
from ..stages.parameters import find_parameters
from .outputs import outputs, save_picture
from .recordings import toml_or_rig


def identify_file(
    file: Path | None,
    out: Path,
    seed: int | None = None,
    progress: Callable[[float, str], None] | None = None,
    force: bool = False,
) -> dict[str, Any]:
    """Identify and write OUT.json and OUT.png; returns what the JSON holds."""
    source = toml_or_rig(file)
    with outputs(out, ".json", ".png", sources=source.reads, force=force) as (json_file, picture):
        material = source.material(seed)
        found = find_parameters(material, progress)
        problems = (*material.problems, *found.problems)
        result: dict[str, Any] = {
            "parameters": {name: dict(entry) for name, entry in found.table.items()},
            "fits": dict(found.fits)
            | ({"prediction error": {"skipped": found.skipped}} if found.skipped else {}),
            "problems": [p.as_dict() for p in problems],
            "inputs": dict(material.inputs),
        }
        save_json(json_file, "identification", result)
        save_picture(plot.identified_parameters(found.table), picture)
    return result
