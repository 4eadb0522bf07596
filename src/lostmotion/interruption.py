"""Ctrl-C and SIGTERM in a command that has begun something: it puts it away. Before, ``__main__`` ends it at once."""

from __future__ import annotations

import contextlib
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

#: Exit codes: 128 + the signal's number, as shells have it.
INTERRUPTED = 128 + signal.SIGINT
#: Signals that ask a program to end; Windows knows no hang-up of the terminal.
_ENDS = (signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else []))

#: Files that no exception may leave: packages swallow it where they import; LLVM's memory would be freed twice.
_CLOSED = ("<frozen importlib._bootstrap>", f"llvmlite{os.sep}binding")
#: Seconds after which a signal that came there comes again (numerics: too short to be seen).
_AGAIN = 0.05

Handler = Callable[[int, FrameType | None], Any]


def _of_a_worker() -> None:
    """A forked worker has nothing to put away: it ends at once when its pool ends it."""
    for number in _ENDS:
        if isinstance(signal.getsignal(number), _Ended):
            signal.signal(number, signal.SIG_DFL)


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_of_a_worker)


@contextlib.contextmanager
def as_exceptions() -> Iterator[None]:
    """In the block Ctrl-C is a KeyboardInterrupt, and SIGTERM a SystemExit: what was begun is put away.

    An error that another package makes of them (numba, where a compilation is interrupted) becomes that again. What no
    exception may leave is done first. What is swallowed all the same is raised at the block's end.
    """
    ended = _Ended(_closed(sys._getframe()))
    with contextlib.ExitStack() as stack:
        for number in (signal.SIGINT, *_ENDS):
            stack.enter_context(_handled(number, ended))
        stack.callback(ended.cancel)
        try:
            yield
        except Exception as error:
            if ended.number is None:
                raise
            raise ended.exception() from error
        if ended.number is not None:
            raise ended.exception()


class _Ended:
    """Handler of the signals; remembers which came. ``closed``: frames of `_CLOSED` where the block begins."""

    def __init__(self, closed: int) -> None:
        self.closed = closed
        self.number: int | None = None
        self.again = threading.Timer(_AGAIN, _send)

    def __call__(self, number: int, frame: FrameType | None) -> None:
        self.number = number
        if _closed(frame) > self.closed:
            self.again = threading.Timer(_AGAIN, _send, (number,))
            self.again.daemon = True
            self.again.start()
            return
        if number != signal.SIGINT:
            signal.signal(number, signal.SIG_IGN)  # a second one must not disturb the tidying up
        raise self.exception()

    def exception(self) -> BaseException:
        return KeyboardInterrupt() if self.number == signal.SIGINT else SystemExit(128 + (self.number or 0))

    def cancel(self) -> None:
        self.again.cancel()


def _closed(frame: FrameType | None) -> int:
    """How many frames, from this one on, are of what no exception may leave."""
    count = 0
    while frame is not None:
        count += any(part in frame.f_code.co_filename for part in _CLOSED)
        frame = frame.f_back
    return count


def _send(number: int) -> None:
    """The signal to the main thread, so that it ends a wait there."""
    if hasattr(signal, "pthread_kill"):
        signal.pthread_kill(threading.main_thread().ident or 0, number)
    else:
        signal.raise_signal(number)


@contextlib.contextmanager
def _handled(number: int, handler: Handler) -> Iterator[None]:
    """A signal handler for the block; what the caller lets be ignored stays ignored."""
    before = signal.getsignal(number)
    if threading.current_thread() is not threading.main_thread() or before in (None, signal.SIG_IGN):
        yield
        return
    signal.signal(number, handler)
    try:
        yield
    finally:
        signal.signal(number, before)
