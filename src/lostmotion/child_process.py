"""A Python process of the package's own beside the user's: for what may crash, or for the second core."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from typing import IO

from .errors import InvalidInput

#: One thread of BLAS for each process. Ours are small matrices: with two threads on two cores that have other work,
#: scipy's exponential of a 4 by 4 matrix took 10 ms instead of 10 µs.
_ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "OMP", "MKL")}
_CODE = (
    "import json, sys; from importlib import import_module; sys.path[:] = json.loads(sys.argv[1]); "
    "getattr(import_module(sys.argv[2]), sys.argv[3])(*sys.argv[4:])"
)


def use_one_blas_thread() -> None:
    """For this process, before numpy is imported, and those that it starts; what the user has set stays."""
    for name, count in _ONE_THREAD.items():
        os.environ.setdefault(name, count)


def start_python(
    module: str, function: str, *arguments: str, stdin: IO[bytes] | int
) -> subprocess.Popen[bytes]:
    """Call a module's function there, on this process's search path; its standard output is a pipe.

    Ctrl-C is for the user's process, which ends the other one with ``end_python``.

    Raises
    ------
    InvalidInput
        If no Python can be started, as where another program has it built in.
    """
    options = ("-I", "-W", "ignore", "-c", _CODE, json.dumps(sys.path))
    try:
        return subprocess.Popen(
            [sys.executable or "", *options, module, function, *arguments],
            stdin=stdin,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, **_ONE_THREAD},
            start_new_session=os.name == "posix",
        )
    except OSError as error:
        raise InvalidInput(
            "sys.executable",
            f"{sys.executable!r} ({error.strerror})",
            "a Python that can be started as a process",
            "Run this in a plain Python, or set sys.executable to one that has the same packages.",
        ) from None


def end_python(child: subprocess.Popen[bytes]) -> None:
    """End the process, and what it forked, at once."""
    kill_python(child)
    child.wait()
    for stream in (child.stdin, child.stdout):
        with contextlib.suppress(OSError):
            if stream is not None:
                stream.close()


def kill_python(child: subprocess.Popen[bytes]) -> None:
    """The same from another thread, which waits for nothing."""
    with contextlib.suppress(OSError):
        if os.name == "posix":
            os.killpg(child.pid, signal.SIGKILL)
        else:
            child.kill()
