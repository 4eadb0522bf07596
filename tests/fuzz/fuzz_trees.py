"""Another structure in JSON and TOML: other types and shapes, huge numbers, doubled and missing keys, deep nesting."""

from __future__ import annotations

import datetime
import json
import random
from typing import Any

#: What may stand in the place of any value; none of it is random, so that a finding is named by its seed alone.
_VALUES: tuple[Any, ...] = (
    None, True, False, 0, -1, 1, 3, 2**31, 2**63, -(2**64), 10**30, 10**400, 0.0, -0.5, 1e-300, 1e30, 1e308,
    float("nan"), float("inf"), "", "x", "1", "1e300", "1_000", "٣", "\0", "a\nb", "\ud800", "ä" * 300, "n" * 5000,
    "../../x", "~x/y", "${LOSTMOTION_NO_SUCH}", [], [[]], {}, [0], [1.0, "x"], ["a", "a"], {"a": 1}, {"column": 0},
    [None], [[1, 2], [3]], [1e300] * 40, list(range(3000)), datetime.date(1979, 5, 27), "1 rpm", "5 Nm", "1e-12 s", [1],
    [2, 1], {"sample_time": 5},
)  # fmt: skip


class Doubled(dict[str, Any]):
    """A mapping that is written with its first key twice."""


def _deep(kind: str) -> Any:
    value: Any = 1
    for _ in range(60):  # what JSON's and TOML's writers here can still write; deeper in ``fuzz_bytes``
        value = [value] if kind == "list" else {"a": value}
    return value


def _paths(tree: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    """Every place in the tree; of long lists the first three and the last."""
    found = [path]
    if isinstance(tree, dict):
        for key, value in tree.items():
            found += _paths(value, (*path, key))
    elif isinstance(tree, list):
        for i in sorted({*range(min(3, len(tree))), len(tree) - 1} - {-1}):
            found += _paths(tree[i], (*path, i))
    return found


def _with(tree: Any, path: tuple[Any, ...], change: Any) -> Any:
    """The tree with the value at the path changed by a function; a copy of the way there."""
    if not path:
        return change(tree)
    copy = tree.copy()
    copy[path[0]] = _with(tree[path[0]], path[1:], change)
    return copy


def _changed_mapping(value: dict[str, Any], rng: random.Random) -> Any:
    key = rng.choice(list(value)) if value else ""
    which = rng.randrange(5)
    if which == 0:
        return {k: v for k, v in value.items() if k != key}
    if which == 1:
        return {(k + rng.choice(("s", "_", " ")) if k == key else k): v for k, v in value.items()}
    if which == 2:
        return {**value, rng.choice(("x", "scale", "A", "", "__array__", "unit")): rng.choice(_VALUES)}
    if which == 3:
        return Doubled(value)
    return list(value.values())


def _changed_list(value: list[Any], rng: random.Random) -> Any:
    at = rng.randrange(len(value)) if value else 0
    which = rng.randrange(6)
    if which == 0:
        return value[:at] + value[at + 1 :]
    if which == 1:
        return value[:at] + value[at : at + 1] + value[at:]
    if which == 2:
        return [value]
    if which == 3:
        return value[::-1]
    if which == 4:
        return value * 2
    return value[0] if value else {}


def changed(tree: Any, rng: random.Random) -> Any:
    """The tree with one to three changes; the upper levels, where types decide, are changed more often."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        paths = _paths(tree)
        shallow = [path for path in paths if len(path) <= 2]
        path = rng.choice(shallow if rng.random() < 0.5 else paths)

        def change(value: Any) -> Any:
            if rng.random() < 0.5:
                if isinstance(value, dict):
                    return _changed_mapping(value, rng)
                if isinstance(value, list):
                    return _changed_list(value, rng)
            return _deep(rng.choice(("list", "dict"))) if rng.random() < 0.03 else rng.choice(_VALUES)

        tree = _with(tree, path, change)
    return tree


def json_text(tree: Any) -> bytes:
    """JSON of a tree, with doubled keys, NaN and lone surrogates; dates as text."""
    return _json(tree).encode("utf-8", errors="backslashreplace")


def _json(value: Any) -> str:
    if isinstance(value, dict):
        entries = [f"{json.dumps(key)}: {_json(entry)}" for key, entry in value.items()]
        return "{" + ", ".join(entries[:1] * isinstance(value, Doubled) + entries) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_json, value)) + "]"
    return json.dumps(value, default=str)


def toml_text(tree: dict[str, Any]) -> bytes:
    """TOML of a tree: tables and arrays of tables with their own headings, all below them inline."""
    if not isinstance(tree, dict):
        return f"value = {_toml(tree)}\n".encode("utf-8", errors="replace")
    lines = [f"{_key(key)} = {_toml(value)}" for key, value in tree.items() if not _is_table(value)]
    lines += lines[:1] * isinstance(tree, Doubled)
    for key, value in tree.items():
        for table in value if isinstance(value, list) else [value]:
            if _is_table(value):
                lines.append(f"[[{_key(key)}]]" if isinstance(value, list) else f"[{_key(key)}]")
                entries = [f"{_key(name)} = {_toml(entry)}" for name, entry in table.items()]
                lines += entries[:1] * isinstance(table, Doubled) + entries
    return ("\n".join(lines) + "\n").encode("utf-8", errors="replace")


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and all(isinstance(entry, dict) for entry in value)
    )


def _key(key: str) -> str:
    bare = key.isascii() and key.replace("_", "").replace("-", "").isalnum()
    return key if bare else json.dumps(key).replace("\\ud800", "")


def _toml(value: Any) -> str:
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{_key(key)} = {_toml(entry)}" for key, entry in value.items()) + " }"
    if isinstance(value, list):
        return "[" + ", ".join(map(_toml, value)) + "]"
    if isinstance(value, str):
        return json.dumps(value).replace("\\ud800", "\\uFFFD")
    if value is None:
        return '""'
    if isinstance(value, bool):
        return str(value).lower()
    return str(value)  # TOML spells nan, inf and dates as Python does
