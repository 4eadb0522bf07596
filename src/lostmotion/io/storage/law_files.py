"""law.json: a law as JSON, equal to the last bit; a law that was changed since it was written is none."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...argument_checks import checks_arguments
from ...errors import InvalidInput, within
from .json_files import plain, read_json, save_json, unwrapped

if TYPE_CHECKING:
    from ...systems import DiscreteSystem, Stepper

#: What files of schema version 1 leave out that were written before there were checks, or all kinds of them.
_BEFORE_CHECKS: Mapping[str, Any] = {"checks": [], "P": [], "Q": [], "R": []}
_KINDS: Mapping[str, Any] = {"keep": False, "alone": False, "missing_only": False}


@checks_arguments
def save_law(system: DiscreteSystem | Stepper, path: str | Path) -> None:
    """Write a ``DiscreteSystem`` or a ``Stepper`` as JSON with a hash of its numbers; see ``load_law``."""
    content = plain(system.to_dict(), str(path))
    save_json(path, "law", {**content, "sha256": _hash(content)})


@checks_arguments
def load_law(path: str | Path) -> DiscreteSystem | Stepper:
    """The ``DiscreteSystem`` or ``Stepper`` that ``save_law`` wrote, equal to the last bit.

    Raises
    ------
    InvalidInput
        If the file cannot be read, is no law, lacks anything, or was changed: one digit more or less in a matrix is
        another law, and no eye sees it.
    """
    from ...systems import DiscreteSystem, Stepper

    where, raw = str(path), read_json(path, "law")
    content = unwrapped(raw, "law", where)
    if raw["schema_version"] == 1:
        content = _of_version_1(content)
    elif content.pop("sha256", None) != _hash(content):
        raise InvalidInput(
            where,
            "a law that was changed, or damaged, since it was written",
            "a law as save_law writes it",
            "Copy or write it again; to change a law, load it, change it in Python, and save it.",
        )
    with within(where):
        if {"estimator", "kernel"} & set(content):
            return Stepper.from_dict(content)
        return DiscreteSystem.from_dict(content)


def _of_version_1(content: dict[str, Any]) -> dict[str, Any]:
    """With what was not yet written then; what lacks a part of that is damaged, and stays as it is."""
    if {"estimator", "kernel"} & set(content):
        return content
    if not set(_BEFORE_CHECKS) & set(content):
        return {**content, **_BEFORE_CHECKS}
    checks = content.get("checks")
    if isinstance(checks, list) and all(isinstance(check, dict) for check in checks):
        return {**content, "checks": [{**_KINDS, **check} for check in checks]}
    return content


def _hash(content: Mapping[str, Any]) -> str:
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return hashlib.sha256(text.encode()).hexdigest()
