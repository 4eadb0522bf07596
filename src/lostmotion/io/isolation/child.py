"""The child process: reads one file after the other, each in a process forked for it where the system can fork.

A request is a pickle (format, memory in bytes, seconds, content) on standard input. The answer on standard output is a
status and a pickle whose large arrays follow apart, so that none is copied on the way.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import struct
import sys
from pathlib import Path
from typing import Any, BinaryIO

from .formats import READERS, TooLarge

#: Status of an answer, and what follows: what was read; the reader's error as text; bytes that it would take, or None
#: where that is not known; nothing.
READ, REFUSED, TOO_LARGE, CRASHED, LATE = range(5)

#: Only Linux keeps a process within its memory, and forks safely whatever libraries are loaded.
CAN_FORK = sys.platform == "linux"


def serve() -> None:
    """Answer requests until standard input ends."""
    source, target = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr  # a reader that prints must not end up in the answer
    preload()
    while True:
        try:
            name, memory, seconds, content = pickle.load(source)
        except EOFError:
            return
        if not CAN_FORK:
            _answer(target, name, content, memory)
            return  # a damaged file may have damaged this process
        process = os.fork()
        if process == 0:
            try:
                _limit(memory, seconds)
                _answer(target, name, content, memory)
            except BaseException:
                os._exit(1)
            os._exit(0)
        del content
        _, ended = os.waitpid(process, 0)
        if ended:
            alarm = os.waitstatus_to_exitcode(ended) == -signal.SIGALRM
            _write(target, LATE if alarm else CRASHED, _parts(None))


def preload() -> None:
    """Imports what the readers need, once for all that is forked."""
    for reader in READERS.values():
        with contextlib.suppress(Exception):
            reader(b"", 0.0)


def _limit(memory: float, seconds: float) -> None:
    """Ends this process after so many seconds; beyond so much memory its allocations fail."""
    import resource

    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + int(memory),) * 2)
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))


def _answer(target: BinaryIO, name: str, content: bytes, memory: float) -> None:
    try:
        status, parts = READ, _parts(READERS[name](content, memory))
    except TooLarge as error:
        status, parts = TOO_LARGE, _parts(error.needed)
    except MemoryError:
        status, parts = TOO_LARGE, _parts(None)
    except Exception as error:  # readers raise many kinds on a damaged file
        status, parts = REFUSED, _parts(f"{type(error).__name__}: {error}"[:1000])
    _write(target, status, parts)


def _parts(found: Any) -> list[memoryview]:
    """A pickle, and apart from it the contents of its large arrays."""
    buffers: list[pickle.PickleBuffer] = []
    body = pickle.dumps(found, protocol=5, buffer_callback=buffers.append)
    return [memoryview(body), *(buffer.raw() for buffer in buffers)]


def _write(target: BinaryIO, status: int, parts: list[memoryview]) -> None:
    target.write(struct.pack(f"<{2 + len(parts)}Q", status, len(parts), *(part.nbytes for part in parts)))
    for part in parts:
        target.write(part)
    target.flush()
