"""Every number that a module is given says what kind it is and where it comes from."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import lostmotion

SOURCE = Path(lostmotion.__file__).parent

#: Physics or numerics, a user's option, a calibration with its data, places in an array; or a cited source.
KIND = re.compile(r"\b(physics|numerics|options?|calibrat\w+|layout)\b", re.IGNORECASE)
CITED = re.compile(
    r"Fietzek|Table I|section [IVX]+\b|handbook|MATLAB|Welch|Tustin|DESIGN|et al\.|\b(?:19|20)\d\d\b"
)


def numeric(node: ast.AST) -> bool:
    """Numbers, and tuples, mappings and calls of numbers."""
    if isinstance(node, ast.Constant):
        return isinstance(node.value, int | float) and not isinstance(node.value, bool)
    parts = {
        ast.Tuple: lambda n: n.elts, ast.List: lambda n: n.elts, ast.Dict: lambda n: n.values,
        ast.UnaryOp: lambda n: [n.operand], ast.BinOp: lambda n: [n.left, n.right],
    }.get(type(node))  # fmt: skip
    if parts is not None:
        found = parts(node)
        return bool(found) and all(map(numeric, found))
    return isinstance(node, ast.Call) and any(map(numeric, node.args))


def enumeration(node: ast.AST) -> bool:
    """Names for 0, 1, 2, …: no number that anybody could have set otherwise."""
    if isinstance(node, ast.Call):
        return isinstance(node.func, ast.Name) and node.func.id == "range"
    values = [getattr(e, "value", None) for e in node.elts] if isinstance(node, ast.Tuple) else []
    return (
        bool(values)
        and all(isinstance(v, int) for v in values)
        and values == list(range(values[0], values[-1] + 1))
    )


def comment(lines: list[str], node: ast.stmt) -> str:
    """The comment above a statement, and those in its lines."""
    first = node.lineno - 1
    while first > 0 and lines[first - 1].lstrip().startswith("#"):
        first -= 1
    above = lines[first : node.lineno - 1]
    return " ".join(above + [line.partition("#")[2] for line in lines[node.lineno - 1 : node.end_lineno]])


def without_a_kind(text: str) -> list[str]:
    """Names of the module's numbers whose comment tells neither kind nor source."""
    lines, found = text.split("\n"), []
    for node in ast.parse(text).body:
        if not isinstance(node, ast.Assign | ast.AnnAssign) or node.value is None:
            continue
        target = node.targets[0] if isinstance(node, ast.Assign) else node.target
        names = [n.id for n in ast.walk(target) if isinstance(n, ast.Name)]
        if not names or not all(re.fullmatch(r"_?[A-Z][A-Z0-9_]*", name) for name in names):
            continue
        said = comment(lines, node)
        if (
            numeric(node.value)
            and not enumeration(node.value)
            and not KIND.search(said)
            and not CITED.search(said)
        ):
            found += names
    return found


def test_one_without_a_kind_is_found():
    assert without_a_kind("#: Rows that go into the fit (chosen).\nROWS = 20_000\n") == ["ROWS"]
    assert without_a_kind("#: Rows that go into the fit (numerics: a second).\nROWS = 20_000\n") == []
    assert without_a_kind("FIRST, SECOND = range(2)\nLEFT, RIGHT = 0, 1\n") == []


def test_every_number_tells_its_kind_and_source():
    found = {
        path.relative_to(SOURCE).as_posix(): names
        for path in sorted(SOURCE.rglob("*.py"))
        if (names := without_a_kind(path.read_text(encoding="utf-8")))
    }
    assert not found


def test_no_calibration_is_left_without_its_data():
    """ "Calibrated" goes with what it was calibrated on."""
    for path in sorted(SOURCE.rglob("*.py")):
        for line in re.findall(r"\(calibrated\)", path.read_text(encoding="utf-8")):
            raise AssertionError(f"{path.name}: {line}")
