"""Reading a foreign format in the child process; a crash there is an error message here."""

from __future__ import annotations

import atexit
import os
import pickle
import struct
import subprocess
import threading
from typing import IO, Any

from ...child_process import end_python, kill_python, start_python
from ...errors import InvalidInput
from ...memory import memory_limit, size_text, too_much
from .child import CAN_FORK, CRASHED, LATE, READ, REFUSED, TOO_LARGE, serve

#: Time to read a file, s, for each MB of it more (option: scipy unpacks 100 MB/s), and to start a process.
SECONDS, SECONDS_PER_MB, START = 4.0, 0.1, 60.0

_lock = threading.Lock()
_children: dict[
    int, subprocess.Popen[bytes]
] = {}  # by the process that started it: a fork must not share one


def read_isolated(format_name: str, raw: bytes, where: str, expected: str, remedy: str) -> Any:
    """What the reader of a foreign format makes of the bytes of a file.

    Parameters
    ----------
    format_name : one of ``formats.READERS``
    raw : bytes
    where, expected, remedy : str
        For the errors.

    Raises
    ------
    InvalidInput
        If the reader refuses the file, crashes on it, takes too long, or more than the memory limit.
    """
    memory = memory_limit()
    seconds = SECONDS + SECONDS_PER_MB * len(raw) / 1e6
    with _lock:
        status, found = _asked(pickle.dumps((format_name, memory, seconds, raw), protocol=5), seconds)
    if status == READ:
        return found
    if status == TOO_LARGE:
        size = size_text(found or memory)
        got = f"numbers for which {'' if found else 'more than '}{size} of memory are needed"
        raise too_much(where, got, found or 2.0 * memory, "Save fewer variables, or a part of the recording.")
    got = {
        REFUSED: f"what is no readable file ({found})",
        CRASHED: "a damaged file, which crashes its reader",
        LATE: f"a file that is not read within {seconds:.0f} s",
    }[status]
    raise InvalidInput(where, got, expected, remedy)


def _asked(request: bytes, seconds: float) -> tuple[int, Any]:
    """Status and content of the child's answer; a child that ended, or had to be ended, is not asked again."""
    child = _child()
    assert child.stdin is not None and child.stdout is not None
    late = threading.Event()

    def end() -> None:
        late.set()
        kill_python(child)

    timer = threading.Timer(START + 2.0 * seconds, end)
    timer.start()
    try:
        child.stdin.write(request)
        child.stdin.flush()
        status, found = _read(child.stdout)
    except Exception:  # no answer, or what is none
        _drop(child)
        return (LATE if late.is_set() else CRASHED), None
    except BaseException:  # Ctrl-C
        _drop(child)
        raise
    finally:
        timer.cancel()
    if not CAN_FORK:
        _drop(child)
    return status, found


def _read(source: IO[bytes]) -> tuple[int, Any]:
    status, count = struct.unpack("<2Q", _exactly(source, 16))
    sizes = struct.unpack(f"<{count}Q", _exactly(source, 8 * count))
    body, *buffers = [_exactly(source, size) for size in sizes]
    return status, pickle.loads(body, buffers=buffers)


def _exactly(source: IO[bytes], size: int) -> bytearray:
    content = bytearray(size)
    view, at = memoryview(content), 0
    while at < size:
        got = source.readinto(view[at:])  # type: ignore[attr-defined]
        if not got:
            raise EOFError
        at += got
    return content


def _child() -> subprocess.Popen[bytes]:
    """The child of this process, started where there is none."""
    child = _children.get(os.getpid())
    if child is None or child.poll() is not None:
        child = start_python(serve.__module__, serve.__name__, stdin=subprocess.PIPE)
        _children[os.getpid()] = child
    return child


def _drop(child: subprocess.Popen[bytes]) -> None:
    """Ends the child for good."""
    if _children.get(os.getpid()) is child:
        del _children[os.getpid()]
        end_python(child)


@atexit.register
def _drop_own() -> None:
    if child := _children.get(os.getpid()):
        _drop(child)
