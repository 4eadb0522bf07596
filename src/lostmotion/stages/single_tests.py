"""Tests of one thing, each on the recording that was made for it: friction, backlash, a shaft."""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .. import identification
from ..errors import InvalidInput, Problem
from ..identification import Estimates
from ..recording import Recording
from .material import Material


@dataclass(frozen=True, eq=False)
class SingleTest:
    """What a test found of a recording; nothing where that was refused, then why."""

    method: str
    recording: str
    found: Estimates | None
    refusal: str = ""

    @property
    def title(self) -> str:
        return f"{self.method.replace('_', ' ')}, {self.recording.replace('_', ' ')}"

    @property
    def problems(self) -> tuple[Problem, ...]:
        return () if self.found is None else self.found.problems

    def fit(self) -> dict[str, Any]:
        """For the results: each quantity with its interval, or why there is none."""
        if self.found is None:
            return {"skipped": self.refusal}
        made: dict[str, Any] = {}
        for name, entry in self.found.table().items():
            source = entry.pop("source")
            made[name.replace("_", " ")] = {"skipped": source} if entry["value"] is None else entry
        error = getattr(self.found, "relative_error", None)
        return made | ({} if error is None else {"relative error": float(error)})

    def as_dict(self) -> dict[str, Any]:
        found = {"skipped": self.refusal} if self.found is None else self.found.as_dict()
        return {"method": self.method, "recording": self.recording, **found}


def single_tests(material: Material, method: str | None = None) -> list[SingleTest]:
    """Every recording that is for a test, by that test.

    ``method``: that one alone; where no recording is for it, on the one to identify from.
    """
    chosen = [
        (name, use)
        for name, use in material.uses.items()
        if use not in ("identify", "validate") and method in (None, use)
    ]
    if not chosen and method is not None and material.identify is not None:
        return [one_test(method, "the recording", material.identify, {}, material.seed)]
    return [
        one_test(use, name, material.recordings[name], material.options.get(name, {}), material.seed)
        for name, use in chosen
    ]


def one_test(
    method: str, name: str, recording: Recording, options: Mapping[str, Any], seed: int
) -> SingleTest:
    """A test of one recording; what it refuses is a result."""
    function = getattr(identification, method)
    given = {"seed": seed} if "seed" in inspect.signature(function).parameters else {}
    try:
        return SingleTest(method, name, function(recording, **given | dict(options)))
    except InvalidInput as error:
        return SingleTest(method, name, None, str(error))
