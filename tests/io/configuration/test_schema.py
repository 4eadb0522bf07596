"""The JSON schema of the TOML: as strict as the reading where a schema can be, and nowhere stricter."""

from __future__ import annotations

import json
import re
import tomllib
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest

from lostmotion import io
from lostmotion.errors import InputProblems
from lostmotion.recording import SIGNAL_UNITS

jsonschema = pytest.importorskip("jsonschema", reason="jsonschema belongs to the extra test")

ROOT = Path(__file__).parents[3]
MINIMAL = '[[recording]]\nfile = "rig.csv"\n'


def schema() -> dict[str, Any]:
    return io.configuration_schema()


def accepted(text: str) -> bool:
    return bool(jsonschema.Draft202012Validator(schema()).is_valid(tomllib.loads(text)))


def readable(text: str, folder: Path) -> bool:
    path = folder / "rig.toml"
    path.write_text(text, encoding="utf-8")
    try:
        io.read_configuration(path)
    except InputProblems:
        return False
    return True


def every_key() -> str:
    """The template with all its comments removed."""
    return re.sub(r"(?m)^# ([a-z_.]+ = )", r"\1", io.template())


def documented() -> list[str]:
    text = (ROOT / "docs" / "configuration.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    return [block if "[[recording]]" in block else MINIMAL + block for block in blocks]


def test_the_schema_is_one() -> None:
    jsonschema.Draft202012Validator.check_schema(schema())
    assert "null" not in json.dumps(schema())


def test_template_documentation_and_examples_are_valid(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("RIG_DATA", raising=False)
    examples = [path.read_text(encoding="utf-8") for path in sorted((ROOT / "examples").glob("*.toml"))]
    texts = [io.template(), every_key(), *documented(), *examples]
    assert len(texts) >= 6
    for text in texts:
        assert readable(text, tmp_path) and accepted(text)


@pytest.mark.parametrize(
    "text",
    [
        "[nameplate]\ninertia_lod = 1\n" + MINIMAL,
        "[nameplate]\nstiffness = -5\n" + MINIMAL,
        "[nameplate]\nstiffness = 0\n" + MINIMAL,
        "[nameplate]\nbacklash = 11.0\n" + MINIMAL,
        "[nameplate]\ncoulomb = true\n" + MINIMAL,
        MINIMAL + "use = 'train'",
        MINIMAL + "window = [3]",
        MINIMAL + "resample = -1",
        MINIMAL + "speed_from_counts = 1",
        MINIMAL + "time = { sample_time = 0 }",
        MINIMAL + "time = { sample_time = 1, unit = 's' }",
        MINIMAL + "channels = 3",
        MINIMAL + "channels.speed_motr = 1",
        MINIMAL + "channels.twist = { column = 1, sing = 1 }",
        MINIMAL + "channels.twist = { column = 1, sign = 2 }",
        MINIMAL + "channels.twist = { unit = 'rad' }",
        "[[recording]]\nfile = 3",
        "[[recording]]\nuse = 'identify'",
        "[recording]\nfile = 'a'",
        "recording = []",
        "",
        MINIMAL + "[law]\npoles = [-1, -2]",
        MINIMAL + "[law]\npoles = [-1, -2, 3]",
        MINIMAL + "[law]\ntorque_limit = 0",
        MINIMAL + "[law]\nkp = '3'\nki = 1",
        MINIMAL + "[law]\nkp = 0\nki = 1",
        MINIMAL + "[law]\nkp = 3\nki = -1",
        MINIMAL + "[run]\nseed = 1.5",
        MINIMAL + "[run]\nseed = -1",
        "bogus = 1\n" + MINIMAL,
    ],
)
def test_what_the_schema_refuses_is_refused_when_it_is_read(text: str, tmp_path: Path) -> None:
    assert not readable(text, tmp_path) and not accepted(text)


@pytest.mark.parametrize(
    "text",
    [
        MINIMAL,
        "[nameplate]\nbacklash = 0\nlag = '0.3 ms'\ncoulomb = 1\n" + MINIMAL,
        MINIMAL + "window = [2.0, '9 s']\nresample = true\ntime = 0",
        MINIMAL + "resample = '0.1 ms'\ntime = { sample_time = '0.1 ms' }\nspeed_from_counts = false",
        MINIMAL
        + "channels.torque_motor = 'Iq [A]'\nchannels.speed_motor = { column = 'n', scale = 2, sign = -1 }",
        MINIMAL + "[law]\nkp = 3\nki = 0\npoles = [-1, -2.5, -3]\ntorque_limit = '2 kNm'",
        MINIMAL + "[run]\nseed = 0",
    ],
)
def test_what_can_be_read_is_accepted(text: str, tmp_path: Path) -> None:
    assert readable(text, tmp_path) and accepted(text)


def test_every_key_is_explained() -> None:
    tables = schema()["$defs"]
    assert {"NameplateModel", "RecordingModel", "LawModel", "RunModel"} <= set(tables)
    for table in tables.values():
        assert table["additionalProperties"] is False
        for key, entry in table["properties"].items():
            assert len(entry["description"]) > 3, key
    channels = tables["RecordingModel"]["properties"]["channels"]["properties"]
    assert set(channels) == set(SIGNAL_UNITS)
    spelt_out = channels["twist"]["anyOf"][-1]["properties"]
    assert list(spelt_out) == [field.name for field in fields(io.Channel)]
