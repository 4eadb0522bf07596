"""The package as a whole: fast to import, every public name there, layers of the source as documented."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

import lostmotion as lm

HEAVY = ("numba", "scipy", "matplotlib", "pydantic", "jinja2")


def test_every_public_name_is_there() -> None:
    for name in lm.__all__:
        assert getattr(lm, name) is not None, name


def test_the_version_is_that_of_the_project() -> None:
    project = Path(__file__).resolve().parents[1] / "pyproject.toml"
    assert lm.__version__ == tomllib.loads(project.read_text())["project"]["version"]


@pytest.mark.parametrize(
    ("imported", "unneeded"),
    [("lostmotion", HEAVY), ("lostmotion.commands.certify, lostmotion.controllers, lostmotion.observers", ("numba",))],
    ids=["package", "proof"],
)  # fmt: skip
def test_what_is_not_needed_is_not_loaded(imported: str, unneeded: tuple[str, ...]) -> None:
    """numba would be a twentieth of the time of ``certify``."""
    code = f"import sys, {imported}; print([m for m in {unneeded!r} if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys, lostmotion.cli as c\n"
        "sys.argv = ['lostmotion', '--help']\n"
        "try: c.main()\n"
        "except SystemExit: pass\n"
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"
