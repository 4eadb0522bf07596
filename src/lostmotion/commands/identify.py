"""lostmotion identify: the parameters alone, or one test, as JSON and picture."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .. import plot
from ..errors import InvalidInput
from ..io import save_json
from ..stages.parameters import find_parameters
from ..stages.single_tests import SingleTest, single_tests
from .outputs import outputs, save_picture
from .recordings import toml_or_rig, toml_recording_or_rig


def identify_file(
    file: Path | None,
    out: Path,
    seed: int | None = None,
    progress: Callable[[float, str], None] | None = None,
    force: bool = False,
    method: str | None = None,
) -> dict[str, Any]:
    """Identify and write OUT.json and OUT.png; returns what the JSON holds.

    ``method``: that test alone, on the recordings that are for it, else on the one to identify from. Without it: the
    identification, and every test that a recording is for.
    """
    source = toml_recording_or_rig(file) if method else toml_or_rig(file)
    with outputs(out, ".json", ".png", sources=source.reads, force=force) as (json_file, picture):
        material = source.material(seed)
        made = single_tests(material, method)
        alone = bool(made) and (method is not None or material.identify is None)
        if method is not None and not made:
            raise InvalidInput(
                str(file),
                f"no recording for {method}",
                f'use = "{method}"',
                "Say so of one of them in the TOML.",
            )
        found = None if alone else find_parameters(material, progress)
        table = _table(made) if found is None else found.table
        problems = (*material.problems, *(() if found is None else found.problems))
        problems += tuple(p for test in made for p in test.problems)
        fits = {} if found is None else dict(found.fits)
        if found is not None and found.skipped:
            fits["prediction error"] = {"skipped": found.skipped}
        result: dict[str, Any] = {
            "parameters": {name: dict(entry) for name, entry in table.items()},
            "fits": fits | {test.title: test.fit() for test in made},
            "tests": [test.as_dict() for test in made],
            "problems": [p.as_dict() for p in problems],
            "inputs": dict(material.inputs),
        }
        save_json(json_file, "identification", result)
        save_picture(plot.identified_parameters(table), picture)
    return result


def _table(made: Sequence[SingleTest]) -> dict[str, Any]:
    """The values of all tests; with the number of its recording where there are several."""
    several = len(made) > 1
    table = {
        f"{name} ({test.title})" if several else name: entry
        for test in made
        if test.found is not None
        for name, entry in test.found.table().items()
    }
    if not table:
        reasons = "; ".join(f"{test.title}: {test.refusal}" for test in made)
        raise InvalidInput("identify", "no test with a result", "at least one", reasons)
    return table
