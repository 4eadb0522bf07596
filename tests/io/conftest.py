"""Shared by the tests of io: real data, small files, and the problems of a failed reading."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from lostmotion.errors import InputProblems, Problem

_DEFAULT = Path(__file__).parents[2] / ".." / "shared" / "data"


@pytest.fixture
def real_data() -> Callable[[str], Path]:
    """Path of a measured file; the test is skipped where it is missing."""
    folder = Path(os.environ.get("LOSTMOTION_DATA", _DEFAULT))

    def find(name: str) -> Path:
        if not (folder / name).is_file():
            pytest.skip(f"no measured data: {folder / name} is missing (set LOSTMOTION_DATA)")
        return folder / name

    return find


@pytest.fixture
def problems_of() -> Callable[[Callable[[], object]], tuple[Problem, ...]]:
    """The problems that a call raises as InputProblems."""

    def caught(call: Callable[[], object]) -> tuple[Problem, ...]:
        with pytest.raises(InputProblems) as error:
            call()
        return error.value.problems

    return caught
