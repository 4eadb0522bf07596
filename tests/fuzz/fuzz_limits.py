"""What a reader may take: seconds and memory, and what it may raise."""

from __future__ import annotations

import resource
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import FrameType

from lostmotion.errors import InputProblems, LostMotionError, Problem

#: What a damaged file may take: s of the processor, bytes; and s by the clock, on a machine with other work (chosen).
SECONDS, MEMORY, BY_THE_CLOCK = 5.0, 1e9, 60.0
#: Longest message, characters: a screen (chosen). What a file holds is quoted in part, never whole.
LONGEST = 4000


class TooSlow(BaseException):
    """Not an Exception: a reader that swallows those still ends."""


def _too_slow(number: int, frame: FrameType | None) -> None:
    raise TooSlow


@contextmanager
def bounded(seconds: float = SECONDS, memory: float = MEMORY) -> Iterator[None]:
    """Raises TooSlow after so many seconds of work, MemoryError beyond so many bytes more than now."""
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    before = {number: signal.signal(number, _too_slow) for number in (signal.SIGPROF, signal.SIGALRM)}
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + int(memory), hard))
    signal.setitimer(signal.ITIMER_PROF, seconds)
    signal.setitimer(signal.ITIMER_REAL, BY_THE_CLOCK)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))
        for number, handler in before.items():
            signal.signal(number, handler)


def _unclear(problems: tuple[Problem, ...]) -> str:
    """What is wrong with messages: none, parts that are empty, too long."""
    if not problems:
        return "an error without a problem"
    for problem in problems:
        if not all(text.strip() for text in (problem.got, problem.expected, problem.remedy)):
            return "a message with an empty part"
        if len(str(problem)) > LONGEST:
            return f"a message of more than {LONGEST} characters"
    return ""


def fault(read: Callable[[], object], seconds: float = SECONDS) -> str:
    """Empty if the call returns, or raises an error of the package; else what it did."""
    try:
        with bounded(seconds):
            read()
    except TooSlow:
        return f"takes more than {seconds:g} s"
    except MemoryError:
        return "takes more than 1 GB"
    except InputProblems as error:
        return _unclear(error.problems)
    except LostMotionError as error:
        problem = getattr(error, "problem", None)
        return _unclear(() if problem is None else (problem,))
    except Exception as error:
        place = error.__traceback__
        own = None
        while place is not None:
            if "lostmotion" in place.tb_frame.f_code.co_filename:
                own = place
            place = place.tb_next
        where = "" if own is None else f" at {Path(own.tb_frame.f_code.co_filename).name}:{own.tb_lineno}"
        return f"{type(error).__name__}{where}"
    return ""
