"""Jobs of a comparison: one case on one rig for some observers, here or in processes."""

from __future__ import annotations

import signal
from collections.abc import Generator, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from multiprocessing import active_children
from multiprocessing.process import BaseProcess

from .cases import CASES
from .contestants import CONTESTANTS
from .scores import Score

#: Case, seed, duration (s), observers.
Job = tuple[str, int, float, tuple[str, ...]]
#: Length of a first run that is not timed, s (option: some samples at the longest sample time).
COMPILING = 0.02

Result = tuple[str, int, dict[str, Score]]


def run_jobs(jobs: Sequence[Job], workers: int) -> Generator[Result, None, None]:
    """Results as they come. Leaving early, by Ctrl-C too, ends the jobs that still run."""
    if workers == 1 or len(jobs) < 2:
        yield from map(run_job, jobs)
        return
    others = set(active_children())
    with ProcessPoolExecutor(min(workers, len(jobs)), initializer=_leave_interrupts_to_the_parent) as pool:
        processes: set[BaseProcess] = set()
        try:
            with _interrupts_wait():
                futures = [pool.submit(run_job, job) for job in jobs]
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


def run_job(job: Job) -> Result:
    """One case on one rig for the named observers."""
    from .experiment import experiment
    from .scores import score

    name, seed, duration, names = job
    case = next(c for c in CASES if c.name == name)
    data = experiment(case, seed, duration)
    entries = {entry.name: entry for entry in CONTESTANTS}
    found = {}
    for observer in names:
        made = entries[observer].make(data.drivetrain, data.sensing)
        made.run(data.recording.only(*made.inputs).window(0.0, COMPILING))  # compiles: it must not be timed
        found[observer] = score(made, data)
    return name, seed, found
