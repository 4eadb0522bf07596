"""The package is typed for its users: a type checker passes a user's script and catches the slips in it."""

from __future__ import annotations

import subprocess
import sys
import sysconfig
import venv
from pathlib import Path

import numpy
import pytest

import lostmotion

SCRIPT = Path(__file__).parents[1] / "fixtures" / "user_script.py"
SOURCES = Path(lostmotion.__file__).parents[1]


@pytest.fixture(scope="module")
def environment(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment in which the package is installed: a type checker then looks for ``py.typed``."""
    folder = tmp_path_factory.mktemp("environment")
    venv.create(folder, symlinks=True, with_pip=False)
    packages = sysconfig.get_path("purelib", vars={"base": str(folder), "platbase": str(folder)})
    (Path(packages) / "paths.pth").write_text(f"{SOURCES}\n{Path(numpy.__file__).parents[1]}\n")
    return folder


def check(environment: Path, script: Path) -> str:
    python = next((environment / "bin").glob("python"))
    command = [sys.executable, "-m", "mypy", "--strict", "--config-file=", "--python-executable", str(python)]
    command += ["--cache-dir", str(environment / "cache"), str(script)]
    done = subprocess.run(
        command, capture_output=True, text=True, cwd=script.parent, timeout=600, check=False
    )
    return done.stdout + done.stderr


def test_a_users_script_passes(environment: Path) -> None:
    assert check(environment, SCRIPT).startswith("Success")


@pytest.mark.parametrize(
    ("right", "slip", "message"),
    [
        ("lm.identify(", "lm.idenify(", 'Module has no attribute "idenify"'),
        ("import read_configuration,", "import read_konfiguration,", "has no attribute"),
        ("lm.simulation.variants(", "lm.simulation.variant(", "has no attribute"),
        ("speed_limit=45.0", "speed_limit='45'", "has incompatible type"),
        ("found.units[name]", "found.unit[name]", '"Estimates" has no attribute "unit"'),
        ("start=nameplate()", "start=None", "has incompatible type"),
    ],
)
def test_a_slip_is_caught(environment: Path, tmp_path: Path, right: str, slip: str, message: str) -> None:
    text = SCRIPT.read_text(encoding="utf-8")
    assert right in text
    wrong = tmp_path / "wrong.py"
    wrong.write_text(text.replace(right, slip), encoding="utf-8")
    assert message in check(environment, wrong)
