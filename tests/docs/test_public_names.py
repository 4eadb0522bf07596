"""Every name that the documentation uses is importable from one documented place, and from nowhere deeper."""

from __future__ import annotations

import ast
import importlib
import inspect
import re
import textwrap
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest

import lostmotion as lm

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
SCRIPTS = [p for folder in ("docs", "examples", "benchmarks") for p in sorted((ROOT / folder).glob("*.py"))]
ROOMS = {name: getattr(lm, name) for name in lm.__all__ if isinstance(getattr(lm, name), ModuleType)}

FENCED = re.compile(r"^```\w*\n(.*?)^```", re.MULTILINE | re.DOTALL)
INDENTED = re.compile(r"(?:^ {4}.*\n)+", re.MULTILINE)
INLINE = re.compile(r"`([^`\n]+)`")
#: A call in the text that is MATLAB's.
FOREIGN = {"save"}
#: Endings of files, which look like attributes.
FILE = re.compile(r"\.(c|csv|html|json|mat|md|npz|py|toml)$")


def own(room: ModuleType) -> list[str]:
    """Public names of a room; a room of one file has those that it defines."""
    if hasattr(room, "__all__"):
        return list(room.__all__)
    return [
        n
        for n, v in vars(room).items()
        if n[0] != "_" and getattr(v, "__module__", room.__name__) == room.__name__
    ]


PUBLIC: dict[str, Any] = {n: getattr(room, n) for room in ROOMS.values() for n in own(room)}
PUBLIC |= {name: getattr(lm, name) for name in lm.__all__ if name not in ROOMS}


def resolve(dotted: str) -> Any:
    """What ``lm.a.b`` is; raises AttributeError if there is none, or the way there leads through a module that is no
    public room."""
    found: Any = lm
    for part in dotted.split(".")[1:]:
        found = getattr(found, part)
        if isinstance(found, ModuleType) and found not in ROOMS.values():
            raise AttributeError(f"{dotted}: {found.__name__} is no public room")
    return found


def code(text: str) -> list[str]:
    """Fenced blocks, and indented ones that import the package."""
    rest = FENCED.sub("\n", text)
    indented = [textwrap.dedent(block) for block in INDENTED.findall(rest)]
    return [b for b in (*FENCED.findall(text), *indented) if re.search(r"^(import|from) lostmotion", b, re.M)]


def imports(tree: ast.AST) -> list[tuple[str, str]]:
    """(module, name) of every import from the package."""
    return [
        (node.module, alias.name)
        for node in ast.walk(tree)
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "lostmotion"
        for alias in node.names
        if node.module is not None
    ]


def attributes(tree: ast.AST) -> set[str]:
    """The longest dotted names that begin with ``lm``."""
    found = {ast.unparse(n) for n in ast.walk(tree) if isinstance(n, ast.Attribute)}
    return {name for name in found if re.fullmatch(r"lm(\.\w+)+", name)}


def test_rooms_hold_what_they_list() -> None:
    assert {"identification", "io", "experiment", "observers", "simulation"} <= set(ROOMS)
    for name, room in ROOMS.items():
        assert room.__doc__, name
        for entry in own(room):
            assert getattr(room, entry) is not None, f"{name}.{entry}"


@pytest.mark.parametrize("room", [lm, lm.io, lm.simulation], ids=lambda r: r.__name__)
def test_what_is_loaded_late_is_listed_and_seen_by_type_checkers(room: ModuleType) -> None:
    source = Path(room.__file__ or "").read_text(encoding="utf-8")
    checked = next(n for n in ast.parse(source).body if isinstance(n, ast.If))
    assert ast.unparse(checked.test) == "TYPE_CHECKING"
    seen = {
        alias.name: node.module
        for node in ast.walk(checked)
        if isinstance(node, ast.ImportFrom) and node.module and node.level
        for alias in node.names
    }
    assert seen == room._HOME  # type: ignore[attr-defined]
    assert set(room._HOME) <= set(room.__all__)  # type: ignore[attr-defined]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_names_of_a_page_exist_in_public_rooms(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    for block in code(text):
        tree = ast.parse(block)
        for module, name in imports(tree):
            assert module.removeprefix("lostmotion").lstrip(".") in ("", *ROOMS), (
                f"{module} is no public room"
            )
            assert name in dir(importlib.import_module(module)), f"{module}.{name}"
        for dotted in attributes(tree):
            resolve(dotted)
    for span in INLINE.findall(FENCED.sub("", text)):
        match = re.match(r"(\w+)((?:\.\w+)+)", span)
        if match and not FILE.search(span):
            first, rest = match.groups()
            if first in ("lm", "lostmotion"):
                resolve(f"lm{rest}")
            elif first in ROOMS:
                resolve(f"lm.{first}{rest}")


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.stem)
def test_functions_that_a_page_calls_are_public(page: Path) -> None:
    """``name(…)`` in the text is a public function or class, or a method of a public class."""
    methods = {n for v in PUBLIC.values() if inspect.isclass(v) for n in dir(v)}
    for span in INLINE.findall(FENCED.sub("", page.read_text(encoding="utf-8"))):
        if match := re.match(r"([a-z]\w+)\(", span):
            assert match[1] in PUBLIC or match[1] in methods | FOREIGN, span


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda p: f"{p.parent.name}-{p.stem}")
def test_scripts_take_from_deeper_modules_only_what_has_no_public_place(script: Path) -> None:
    for module, name in imports(ast.parse(script.read_text(encoding="utf-8"))):
        if module.removeprefix("lostmotion").lstrip(".") not in ("", *ROOMS):
            deep = getattr(importlib.import_module(module), name, None)  # None: a module
            assert deep is None or deep is not PUBLIC.get(name), f"{module}.{name} is public elsewhere"
            assert script.parent.name != "examples", "an example uses public names alone"
