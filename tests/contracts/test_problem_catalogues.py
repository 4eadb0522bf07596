"""What the package tells its users is written once, and a room of the identification has it in one file."""

from __future__ import annotations

import ast
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import lostmotion

SOURCES = Path(lostmotion.__file__).parent
MAKERS = ("Problem", "Problem.error", "Problem.warning")


def problems(folder: Path) -> Iterator[tuple[Path, ast.Call, tuple[str, ...]]]:
    """Every call that makes a ``Problem`` below a folder, and the expressions that it gets.

    A local name counts as what was assigned to it: ``remedy = "…"`` above the call.
    """
    for path in sorted(folder.rglob("*.py")):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
        owner = {id(node): function for function in functions for node in ast.walk(function)}
        for node in ast.walk(tree):
            if isinstance(node, ast.Call) and ast.unparse(node.func) in MAKERS:
                function = owner.get(id(node))
                yield path, node, tuple(expression(argument, function) for argument in node.args)


def expression(argument: ast.expr, function: ast.FunctionDef | None) -> str:
    """An argument's text; for a local name that of its last assignment above."""
    if isinstance(argument, ast.Name) and function is not None:
        assigned = {
            node.lineno: node.value
            for node in ast.walk(function)
            if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == argument.id
        }
        above = [line for line in assigned if line < argument.lineno]
        if above:
            return ast.unparse(assigned[max(above)])
    return ast.unparse(argument)


def test_no_text_is_written_twice() -> None:
    places = defaultdict(list)
    for path, call, arguments in problems(SOURCES):
        *_, expected, remedy = arguments or ("", "")
        if max(len(expected), len(remedy)) > 30:
            places[expected, remedy].append(f"{path.relative_to(SOURCES)}:{call.lineno}")
    assert len(places) > 40
    assert {text: where for text, where in places.items() if len(where) > 1} == {}


def test_a_room_of_the_identification_has_its_messages_in_one_file() -> None:
    found = [path for path, *_ in problems(SOURCES / "identification")]
    assert len(found) > 30 and {path.name for path in found} == {"problems.py"}
