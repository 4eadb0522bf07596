"""What is compiled is kept while it is fresh, wherever the kernels are installed."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import lostmotion.kernels

CALLED = "from lostmotion.kernels.jit import njit\n\n@njit(cache=True)\ndef value():\n    return {}\n"
CALLER = """from lostmotion.kernels.jit import njit
from .called import value

@njit(cache=True)
def twice():
    return 2 * value()
"""
ALONE = "from lostmotion.kernels.jit import njit\n\n@njit(cache=True)\ndef one():\n    return 1\n"
INIT = """from pathlib import Path
from lostmotion.kernels.jit import keep_fresh
keep_fresh(Path(__file__).parent)
"""
#: Prints the result, then how many of the two kernels were compiled.
CODE = """from toy.caller import twice
from toy.alone import one
one()
print(twice(), *(sum(f.stats.cache_misses.values()) for f in (twice, one)))
"""


@pytest.fixture
def toy(tmp_path: Path) -> Path:
    folder = tmp_path / "place" / "toy"
    folder.mkdir(parents=True)
    for name, text in {
        "called": CALLED.format(1),
        "caller": CALLER,
        "alone": ALONE,
        "__init__": INIT,
    }.items():
        (folder / f"{name}.py").write_text(text)
    return folder


#: The folder of the kernels cannot be written; said here, since the super-user may write everywhere.
READ_ONLY = """from numba.core import caching
def refused(self):
    raise PermissionError
caching.InTreeCacheLocator.ensure_cache_path = refused
"""


def run(toy: Path, before: str = "", **environment: str) -> list[int]:
    done = subprocess.run(
        [sys.executable, "-c", before + CODE], cwd=toy.parent, env={**os.environ, **environment},
        capture_output=True, text=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    return [int(word) for word in done.stdout.split()]


def test_a_changed_callee_is_noticed_and_nothing_else_is_compiled(toy):
    assert run(toy) == [2, 1, 1]
    assert run(toy) == [2, 0, 0]
    (toy / "called.py").write_text(CALLED.format(5))
    assert run(toy) == [10, 1, 0]


@pytest.mark.parametrize(("variable", "before"), [("NUMBA_CACHE_DIR", ""), ("XDG_CACHE_HOME", READ_ONLY)])
def test_another_cache_takes_what_was_installed(toy, tmp_path, variable, before):
    assert run(toy) == [2, 1, 1]
    elsewhere = {variable: str(tmp_path / "cache")}
    assert run(toy, before, **elsewhere) == [2, 0, 0]
    assert list((tmp_path / "cache").rglob("caller.twice-*.nbi"))
    (toy / "called.py").write_text(CALLED.format(5))
    assert run(toy, before, **elsewhere) == [10, 1, 0]
    assert run(toy, before, **elsewhere) == [10, 0, 0]


def test_who_watches_is_told_that_kernels_are_compiled_and_only_then(toy):
    watched = "import sys\nsys.modules['ipykernel'] = sys\nsys.stderr = sys.stdout\n" + CODE
    said = [
        subprocess.run([sys.executable, "-c", watched], cwd=toy.parent, capture_output=True, text=True).stdout
        for _ in range(2)
    ]
    assert [text.count("compiles its kernels") for text in said] == [1, 0]


def test_every_kernel_takes_njit_from_here():
    folder = Path(lostmotion.kernels.__file__).parent
    for file in folder.rglob("*.py"):
        taken = re.findall(r"^from numba import .*\b(njit|cfunc)\b", file.read_text(), re.MULTILINE)
        assert not taken or file.name == "jit.py", file
