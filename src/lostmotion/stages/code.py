"""Stage 5, export: the law as C99, compiled and run against its test vectors where there is a compiler."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .. import export
from ..drivetrain import Drivetrain
from ..errors import Problem
from ..io import save_law
from .design import Design

NAME = "drive_law"


def write_code(
    laws: Design, folder: Path, drivetrain: Drivetrain | None
) -> tuple[dict[str, Any], tuple[Problem, ...]]:
    """Write law.json and c/ for a drivetrain; returns the part of ``results.json`` and warnings."""
    if laws.law is None:
        return {"skipped": laws.skipped}, ()
    save_law(laws.law, folder / "law.json")
    export.c(laws.law, folder / "c", name=NAME, drivetrain=drivetrain)
    check = export.compile_and_check(folder / "c", name=NAME)
    result = {"max_difference": check.max_difference, "compiler": check.compiler}
    if check.passed:
        return result, ()
    remedy = (
        "Install a C compiler, or compile c/ with the compiler of your target."
        if check.skipped
        else "Look into c/README.md."
    )
    expected = "a compiled law equal to the designed one, bit for bit"
    return {**result, "message": check.message}, (
        Problem("warning", "export", check.message, expected, remedy),
    )
