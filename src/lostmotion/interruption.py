"""Ctrl-C and SIGTERM in a command that has begun something: it puts it away. Before, ``__main__`` ends it at once."""

from __future__ import annotations

import contextlib
import os
import signal
import threading
from collections.abc import Callable, Iterator
from types import FrameType
from typing import Any

#: Exit codes: 128 + the signal's number, as shells have it.
INTERRUPTED = 128 + signal.SIGINT
#: Signals that ask a program to end; Windows knows no hang-up of the terminal.
_ENDS = (signal.SIGTERM, *([signal.SIGHUP] if hasattr(signal, "SIGHUP") else []))

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

    An error that another package makes of them (numba, where a compilation is interrupted) becomes that again.
    """
    ended = _Ended()
    with contextlib.ExitStack() as stack:
        for number in (signal.SIGINT, *_ENDS):
            stack.enter_context(_handled(number, ended))
        try:
            yield
        except Exception as error:
            if ended.raised is None:
                raise
            raise ended.raised from error


class _Ended:
    """Handler of the signals; remembers what it raised."""

    def __init__(self) -> None:
        self.raised: BaseException | None = None

    def __call__(self, number: int, frame: FrameType | None) -> None:
        if number == signal.SIGINT:
            self.raised = KeyboardInterrupt()
        else:
            signal.signal(number, signal.SIG_IGN)  # a second one must not disturb the tidying up
            self.raised = SystemExit(128 + number)
        raise self.raised


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
