"""A remedy names only keys and tables that the TOML has."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import lostmotion
from lostmotion.io.configuration.models import (
    ConfigurationModel,
    IdentifyModel,
    LawModel,
    NameplateModel,
    RecordingModel,
    RunModel,
)

SOURCES = Path(lostmotion.__file__).parent
MODELS = {
    "nameplate": NameplateModel, "recording": RecordingModel, "identify": IdentifyModel, "law": LawModel,
    "run": RunModel,
}  # fmt: skip
#: What the user of a run is told: stages, identification by prediction error.
ROOMS = (SOURCES / "stages", SOURCES / "identification" / "prediction_error" / "problems.py")
#: "poles = …", "kp and ki out of [law]", "coulomb_motor under [nameplate]".
NAMED = re.compile(r"((?:\w+(?: = \S+)?(?: and |, )?)+?)(?: longer| shorter| out)? (?:under|in|of) \[(\w+)\]")


def texts() -> Iterator[str]:
    """Every text in the rooms, with what is filled in as a blank."""
    for room in ROOMS:
        for path in sorted(room.rglob("*.py")) if room.is_dir() else [room]:
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Constant) and isinstance(node.value, str):
                    yield node.value
                elif isinstance(node, ast.JoinedStr):
                    yield "".join(v.value if isinstance(v, ast.Constant) else "…" for v in node.values)


def keys_named(text: str) -> Iterator[tuple[str, str]]:
    """(table, key) for each key that a text names in a table."""
    for table in re.findall(r"\[(\w+)\]", text):
        if table in MODELS or re.search(rf"(?:under|in|of) \[{table}\]", text):
            yield table, ""
    for words, table in NAMED.findall(text):
        for word in re.findall(r"[a-z]\w*(?= = )|\b[a-z]+_[a-z_]+\b|\b(?:kp|ki|poles|seed)\b", words):
            yield table, word


@pytest.mark.parametrize("text", sorted({t for t in texts() if re.search(r"(?:under|in|of) \[\w+\]", t)}))
def test_a_remedy_names_existing_keys(text: str) -> None:
    named = list(keys_named(text))
    assert named
    for table, key in named:
        assert table in ConfigurationModel.model_fields
        assert not key or key in MODELS[table].model_fields, f"{key} in [{table}]"


def test_no_remedy_speaks_python() -> None:
    """A run's user writes TOML: ``load_torque=True`` is no key of it."""
    spoken = [text for text in texts() if re.search(r"\b\w+=(?:True|False|\()", text) and " " in text.strip()]
    assert [text for text in spoken if not text.lstrip().startswith("use =")] == []


def test_the_search_finds_keys() -> None:
    assert ("law", "kp") in keys_named("Leave kp and ki out of [law]: it helps.")
    assert ("law", "ki") in keys_named("Leave kp and ki out of [law]: it helps.")
    assert ("nameplate", "coulomb_motor") in keys_named("give coulomb_motor under [nameplate]; then")
    assert ("identify", "load_torque") in keys_named("set load_torque = true under [identify]. The")
    assert ("law", "sample_time") in keys_named("Give a shorter sample_time under [law].")
