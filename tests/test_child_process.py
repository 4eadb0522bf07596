"""A second Python process, and what is said where there can be none."""

from __future__ import annotations

import os
import subprocess
import sys
from typing import Any

import pytest

from lostmotion.child_process import end_python, start_python
from lostmotion.errors import InvalidInput
from lostmotion.precompile import PARTS, compile_missing


def test_a_function_is_called_with_its_arguments_and_one_thread_for_blas() -> None:
    child = start_python("builtins", "print", "a", "b", stdin=subprocess.DEVNULL)
    assert child.communicate()[0] == b"a b\n"
    child = start_python(
        "builtins", "exec", "import os; print(os.environ['OPENBLAS_NUM_THREADS'])", stdin=subprocess.DEVNULL
    )
    assert child.communicate()[0] == b"1\n"
    end_python(child)


@pytest.mark.parametrize("given, used", [({}, "1"), ({"OPENBLAS_NUM_THREADS": "3"}, "3")])
def test_the_command_has_one_thread_for_blas_unless_the_user_says_otherwise(given: Any, used: str) -> None:
    code = """
import os, sys
from lostmotion.__main__ import main
assert "numpy" not in sys.modules and "lostmotion.cli" not in sys.modules

class Watch:
    def find_spec(self, name, path=None, target=None):
        assert name != "lostmotion.cli" or "OPENBLAS_NUM_THREADS" in os.environ, "too late"

sys.meta_path.insert(0, Watch())
sys.argv = ["lostmotion", "--version"]
try:
    main()
except SystemExit:
    print(os.environ["OPENBLAS_NUM_THREADS"])
"""
    clean = {name: value for name, value in os.environ.items() if "NUM_THREADS" not in name}
    answer = subprocess.run(
        [sys.executable, "-c", code], env={**clean, **given}, capture_output=True, text=True, check=True
    )
    assert answer.stdout.split()[-1] == used


@pytest.mark.parametrize("executable", [None, "", "/nowhere/python"])
def test_a_python_that_cannot_be_started_is_told_with_a_remedy(monkeypatch: Any, executable: Any) -> None:
    monkeypatch.setattr(sys, "executable", executable)
    with pytest.raises(InvalidInput, match=r"sys\.executable") as told:
        start_python("builtins", "print", stdin=subprocess.DEVNULL)
    assert "sys.executable" in told.value.problem.remedy
    monkeypatch.setattr("lostmotion.precompile.is_compiled", lambda part: False)
    compile_missing(tuple(PARTS), lambda done, count: None)  # kernels are compiled as they are called
