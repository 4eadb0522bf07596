"""Jobs of a comparison: one case on one rig for some entries, here or in processes."""

from __future__ import annotations

import signal
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import active_children
from multiprocessing.process import BaseProcess

from .scores import Score

#: Case, seed, duration (s; None: the case's own), entries.
Job = tuple[str, int, float | None, tuple[str, ...]]
Result = tuple[str, int, dict[str, Score]]


def run_jobs(
    work: Callable[[Job], Result], jobs: Sequence[Job], workers: int
) -> Generator[Result, None, None]:
    """Results as they come. Leaving early, by Ctrl-C too, ends the jobs that still run."""
    if workers == 1 or len(jobs) < 2:
        yield from map(work, jobs)
        return
    others = set(active_children())
    with ProcessPoolExecutor(min(workers, len(jobs)), initializer=_leave_interrupts_to_the_parent) as pool:
        processes: set[BaseProcess] = set()
        try:
            with _interrupts_wait():
                futures = [pool.submit(work, job) for job in jobs]
                processes = set(active_children()) - others
            for future in as_completed(futures):
                yield future.result()
        except BaseException:
            # The pool itself would wait for the running jobs, and for those that it has already handed out.
            for process in processes:
                process.terminate()
            raise


@contextmanager
def _interrupts_wait() -> Iterator[None]:
    """Delays Ctrl-C to the end of the block: within a fork Python's own hooks would swallow it."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _leave_interrupts_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
