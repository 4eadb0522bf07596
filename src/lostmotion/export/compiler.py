"""The system's C compiler: which one, with which options, and how it is run."""

from __future__ import annotations

import os
import shutil
import subprocess

#: Options under which the code compiles without a warning, and gives the same bits as the Python law.
C_FLAGS = (
    "-std=c99",
    "-O2",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Werror",
    "-ffp-contract=off",
)
#: What is said where there is none.
NO_COMPILER = "no C compiler (cc, gcc, clang) found"


def find_compiler() -> str | None:
    """Its path: the environment variable CC is respected, else cc, gcc and clang are tried."""
    names = (os.environ.get("CC") or "cc", "cc", "gcc", "clang")
    return next((path for path in map(shutil.which, names) if path), None)


def run(command: list[str]) -> subprocess.CompletedProcess[str]:
    """A command that has two minutes; what keeps it from running becomes its message."""
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=120.0, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        return subprocess.CompletedProcess(command, 1, "", str(error))
