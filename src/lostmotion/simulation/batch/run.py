"""simulate_batch: thousands of variants on all cores, as summaries; resumable, and a failing variant ends nothing."""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import (
    FIRST_COMPLETED,
    Executor,
    Future,
    ProcessPoolExecutor,
    ThreadPoolExecutor,
    wait,
)
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...events import KINDS
from .chunk import Chunk, Work
from .store import Store

Array = NDArray[np.float64]
Progress = Callable[[int, int, float], None]


@dataclass(frozen=True, eq=False)
class BatchResult:
    """Summaries of V variants; a failed or missing variant's numbers are NaN.

    Parameters
    ----------
    done : (V,) bool
    failures : mapping of variant → message
    final_state : (V, 2 n − 1)
        Twists, then speeds, after the last torque; shorter chains are filled up with NaN.
    peak, rms : mapping of signal → (V,)
        Largest absolute value, and root of the mean square.
    events : mapping of kind → (V,)
        How many there were.
    quantile_time : (t,), s
    samples : mapping of signal → (V, t)
        The signals that quantiles were asked for, at `quantile_time`.
    """

    done: NDArray[np.bool_]
    failures: Mapping[int, str]
    final_state: Array
    peak: Mapping[str, Array]
    rms: Mapping[str, Array]
    events: Mapping[str, Array]
    quantile_time: Array
    samples: Mapping[str, Array]

    def quantiles(self, signal: str, levels: Sequence[float] = (0.05, 0.5, 0.95)) -> Array:
        """(levels, t): the signal's quantiles over the finished variants at each of `quantile_time`."""
        if signal not in self.samples:
            raise InvalidInput(
                "BatchResult.quantiles",
                repr(signal),
                f"one of {sorted(self.samples)}",
                "Name it in `quantiles`.",
            )
        return np.asarray(np.nanquantile(self.samples[signal], levels, axis=0))


@checks_arguments
def simulate_batch(
    drivetrains: Sequence[Drivetrain],
    *,
    dt: float,
    signals: Sequence[str] = ("speed_motor", "speed_load", "twist", "torque_shaft"),
    quantiles: Sequence[str] = (),
    folder: str | Path | None = None,
    trajectories: bool = False,
    workers: int | None = None,
    chunk: int = 100,
    progress: Progress | None = None,
    **arguments: Any,
) -> BatchResult:
    """Simulate many drivetrains under the same torques or law; returns summaries, not trajectories.

    Parameters
    ----------
    drivetrains : sequence of V Drivetrain
    dt : float, s
    signals : sequence of str
        Signals of which peak and RMS are taken, where a variant has them.
    quantiles : sequence of str
        Signals kept at up to 200 times for ``BatchResult.quantiles``.
    folder : path, optional
        Finished chunks are stored here, each whole or not at all. A later call with the same arguments goes on after
        what stands: so an interruption (Ctrl-C) loses at most the chunks that were being worked on. Chunks of other
        arguments are refused; those made by another version of the package are worked out again.
    trajectories : bool
        Keep whole recordings too: one file for each chunk in `folder`, see ``read_trajectories``.
    workers : int, optional
        Default: one for each core. The numbers do not depend on it. Under torques alone whole variants run in compiled
        code on threads; with a law, or where trajectories are kept, by ``simulate`` in processes.
    chunk : int
        Variants in a chunk (chosen: little to lose, little to hand over).
    progress : function of (variants done, all variants, remaining seconds), optional
        Called after every chunk.
    **arguments
        Of ``simulate``: torques, law, sensors, seed, state, delay, …

    Raises
    ------
    InvalidInput
        If there is no drivetrain, `workers` or `chunk` is below one, trajectories are wanted without a folder, the
        folder holds chunks of another batch, or the torques are no finite signals of one length. What a single variant
        raises is reported under its index in ``failures``.
    """
    drivetrains = tuple(drivetrains)
    if not drivetrains:
        raise InvalidInput("simulate_batch.drivetrains", "none", "at least one", "Give some variants.")
    if trajectories and folder is None:
        raise InvalidInput(
            "simulate_batch.trajectories", "True without a folder", "a folder", "Say where to keep them."
        )
    _check_count("chunk", chunk)
    if workers is not None:
        _check_count("workers", workers)
    work = Work(dt, tuple(signals), tuple(quantiles), trajectories, dict(arguments))
    parts = {start: drivetrains[start : start + chunk] for start in range(0, len(drivetrains), chunk)}
    store = None if folder is None else Store(Path(folder), work, chunk, parts)
    finished = {} if store is None else store.finished
    todo = {start: part for start, part in parts.items() if start not in finished}
    before = done = sum(len(parts[start]) for start in finished)
    began = time.monotonic()

    def note(start: int, made: Chunk) -> None:
        nonlocal done
        finished[start] = made
        done += len(parts[start])
        if progress is not None:
            each = (time.monotonic() - began) / (done - before)
            progress(done, len(drivetrains), each * (len(drivetrains) - done))

    _run_all(work, todo, store, min(workers or os.cpu_count() or 1, max(1, len(todo))), note)
    return _gather([finished[start] for start in parts], work, chunk)


def _check_count(name: str, value: int) -> None:
    if isinstance(value, bool) or not isinstance(value, (int, np.integer)) or value < 1:
        raise InvalidInput(
            f"simulate_batch.{name}",
            repr(value),
            "a whole number from 1 on",
            "Leave it out for the usual one.",
        )


def _run_all(
    work: Work,
    todo: Mapping[int, Sequence[Drivetrain]],
    store: Store | None,
    workers: int,
    note: Callable[[int, Chunk], None],
) -> None:
    """Works off all chunks, and stores each as it is finished."""

    def finish(start: int, made: Chunk) -> None:
        if store is not None:
            store.write(start, todo[start], made)
        note(start, made)

    def file(start: int) -> Path | None:
        return None if store is None else store.file(start)

    if workers == 1:
        for start, part in todo.items():
            finish(start, work.run(part, start, file(start)))
        return
    pool: Executor = ThreadPoolExecutor(workers) if work.compiled else ProcessPoolExecutor(workers)
    with pool:
        running: dict[Future[Chunk], int] = {
            pool.submit(work.run, part, start, file(start)): start for start, part in todo.items()
        }
        try:
            while running:
                for ended in wait(running, return_when=FIRST_COMPLETED).done:
                    finish(running.pop(ended), ended.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def read_trajectories(folder: str | Path, index: int) -> dict[str, Array]:
    """All signals of one variant that ``simulate_batch(…, trajectories=True)`` kept, by name, (n,) each."""
    for file in sorted(Path(folder).glob("variants-*.npz")):
        if file.name.endswith(".summary.npz"):
            continue
        try:
            with np.load(file, allow_pickle=False) as data:
                names = [name for name in data.files if name.startswith(f"{index}/")]
                found = {name.split("/", 1)[1]: data[name] for name in names}
        except Exception:  # zipfile and numpy raise many kinds on a damaged file
            raise InvalidInput(
                str(file), "a damaged file", "trajectories of a batch", "Delete it and run the batch again."
            ) from None
        if found:
            return found
    raise InvalidInput(
        "read_trajectories", f"variant {index}", f"one that is kept in {folder}", "Check the number."
    )


def _gather(chunks: Sequence[Chunk], work: Work, size: int) -> BatchResult:
    width = max(chunk.final_state.shape[1] for chunk in chunks)
    final = [
        np.pad(c.final_state, ((0, 0), (0, width - c.final_state.shape[1])), constant_values=np.nan)
        for c in chunks
    ]
    failures = {
        size * k + i: text for k, chunk in enumerate(chunks) for i, text in sorted(chunk.failures.items())
    }
    count = sum(len(chunk.final_state) for chunk in chunks)
    done = np.ones(count, dtype=bool)
    done[list(failures)] = False

    def columns(rows: Sequence[Array], names: Sequence[str]) -> dict[str, Array]:
        return dict(zip(names, np.concatenate(rows, axis=1), strict=True))

    peak = columns([chunk.peak for chunk in chunks], work.signals)
    samples = columns([chunk.samples for chunk in chunks], work.quantiles)
    unknown = [name for name, rows in (*peak.items(), *samples.items()) if np.all(np.isnan(rows[done]))]
    if done.any() and unknown:
        raise InvalidInput(
            "simulate_batch.signals, quantiles",
            str(unknown),
            "signals that a variant has",
            "Check the names.",
        )
    return BatchResult(
        done=done,
        failures=failures,
        final_state=np.concatenate(final),
        peak=peak,
        rms=columns([chunk.rms for chunk in chunks], work.signals),
        events=columns([chunk.events for chunk in chunks], KINDS),
        quantile_time=work.time,
        samples=samples,
    )
