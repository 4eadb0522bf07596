"""What the package tells its users is written once, and a room of the identification has it in one file."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import lostmotion

SOURCES = Path(lostmotion.__file__).parent


def problems(folder: Path) -> Iterator[tuple[Path, ast.Call]]:
    """Every call of ``Problem`` below a folder."""
    for path in sorted(folder.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "Problem":
                yield path, node


def test_no_text_is_written_twice() -> None:
    places = defaultdict(list)
    for path, call in problems(SOURCES):
        *_, expected, remedy = [ast.unparse(argument) for argument in call.args] or ["", ""]
        if max(len(expected), len(remedy)) > 30:
            places[expected, remedy].append(f"{path.relative_to(SOURCES)}:{call.lineno}")
    assert len(places) > 40
    assert {text: where for text, where in places.items() if len(where) > 1} == {}


def test_a_room_of_the_identification_has_its_messages_in_one_file() -> None:
    found = [path for path, _ in problems(SOURCES / "identification")]
    assert len(found) > 30 and {path.name for path in found} == {"problems.py"}
