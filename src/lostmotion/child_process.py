"""A Python process of the package's own beside the user's: for what may crash, or for the second core."""

from __future__ import annotations

import contextlib
import json
import os
import signal
import subprocess
import sys
from typing import IO

#: One thread each: the processes share the cores.
_ONE_THREAD = {f"{library}_NUM_THREADS": "1" for library in ("OPENBLAS", "OMP", "MKL")}
_CODE = (
    "import json, sys; from importlib import import_module; sys.path[:] = json.loads(sys.argv[1]); "
    "getattr(import_module(sys.argv[2]), sys.argv[3])(*sys.argv[4:])"
)


def start_python(
    module: str, function: str, *arguments: str, stdin: IO[bytes] | int
) -> subprocess.Popen[bytes]:
    """Call a module's function there, on this process's search path; its standard output is a pipe.

    Ctrl-C is for the user's process, which ends the other one with ``end_python``.
    """
    return subprocess.Popen(
        [
            sys.executable,
            "-I",
            "-W",
            "ignore",
            "-c",
            _CODE,
            json.dumps(sys.path),
            module,
            function,
            *arguments,
        ],
        stdin=stdin,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        env={**os.environ, **_ONE_THREAD},
        start_new_session=os.name == "posix",
    )


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
