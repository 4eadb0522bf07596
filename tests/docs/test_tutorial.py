"""The tutorial: every block is executed, in its order, and shows what the page says it shows."""

from __future__ import annotations

import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "tutorial.md"
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)


def blocks() -> list[tuple[str, str]]:
    return BLOCK.findall(PAGE.read_text(encoding="utf-8"))


def shown(command: str, folder: Path) -> str:
    """Both outputs of a command line of the page."""
    words = shlex.split(command)
    if words[0] == "lostmotion":
        words = [sys.executable, "-m", *words]
    elif words[0] == "python":
        words = [sys.executable, str(ROOT / words[1]), *words[2:]]
    else:
        assert words[0] == "head", command
        return "\n".join((folder / words[2]).read_text().splitlines()[: -int(words[1])])
    run = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    assert run.returncode in (0, 1), f"{command}: {run.stderr}"
    return run.stdout + run.stderr


def write_toml(text: str, folder: Path) -> None:
    """A TOML, or a line that replaces that of the same key: the block's first line says which."""
    head, body = text.split("\n", 1)
    name = re.match(r"# (\S+?\.toml)", head)
    assert name is not None, head
    target = folder / name[1]
    key = re.search(r": replace (\S+)", head)
    if key is None:
        target.write_text(body)
    else:
        lines = [
            body.strip() if line.startswith(key[1]) else line for line in target.read_text().splitlines()
        ]
        assert body.strip() in lines
        target.write_text("\n".join(lines) + "\n")


def contains(output: str, line: str) -> bool:
    """Whether a line of the output has these words, one after the other, and its numbers within 2 %."""
    wanted = line.split()
    for other in output.splitlines():
        words = other.split()
        for start in range(len(words) - len(wanted) + 1):
            if all(map(alike, wanted, words[start : start + len(wanted)])):
                return True
    return False


def alike(wanted: str, word: str) -> bool:
    try:
        return abs(float(word) - float(wanted)) <= 0.02 * abs(float(wanted))
    except ValueError:
        return wanted == word


def test_every_block_runs_and_shows_what_the_page_says(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    output, kinds = "", set()
    for kind, text in blocks():
        kinds.add(kind)
        if kind == "sh":
            output = "\n".join(shown(line, tmp_path) for line in text.splitlines())
        elif kind == "text":
            for line in filter(str.strip, text.splitlines()):
                assert contains(output, line), f"{line!r} is not in\n{output}"
        elif kind == "toml":
            write_toml(text, tmp_path)
        elif kind == "python":
            exec(compile(text, PAGE.name, "exec"), {})
        else:
            assert kind == "c"
            compile_with_the_law(text, tmp_path)
    assert kinds == {"sh", "text", "toml", "python", "c"}


def compile_with_the_law(text: str, folder: Path) -> None:
    """The target's code, with a loop around it that must stay within the torque limit."""
    compiler = shutil.which("cc")
    if compiler is None:
        return
    main = "\nint main(void) { drive_law_init(&state); double t = 0.0;\n"
    main += (
        "for (int i = 0; i < 1000; i++) t = torque_for(10.0, 0.0); return t > 0.0 && t <= 0.3 ? 0 : 1; }\n"
    )
    (folder / "target.c").write_text(text + main)
    law = folder / "result" / "c"
    subprocess.run(
        [compiler, "-std=c99", f"-I{law}", "-o", "target", "target.c", str(law / "drive_law.c")],
        cwd=folder, check=True,
    )  # fmt: skip
    assert subprocess.run([folder / "target"], check=False).returncode == 0


def test_the_log_comes_from_no_simulator_of_the_package() -> None:
    text = (ROOT / "examples" / "servo_log.py").read_text()
    assert not re.search(r"^\s*(import|from) (lostmotion|numpy|scipy)", text, re.MULTILINE)
