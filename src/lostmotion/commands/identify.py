"""lostmotion identify: the parameters alone, as JSON and picture."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import plot
from ..io import save_json
from ..stages.parameters import find_parameters
from .recordings import material_of, outputs, save_picture


def identify_file(
    file: Path | None,
    out: Path,
    seed: int | None = None,
    progress: Callable[[float, str], None] | None = None,
) -> dict[str, Any]:
    """Identify and write OUT.json and OUT.png; returns what the JSON holds."""
    json_file, picture = outputs(out, ".json", ".png", source=file)
    material = material_of(file, seed)
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
    figure = plot.identified_parameters(found.table)
    save_picture(figure, picture)
    return result
