"""simulate_batch: thousands of variants on all cores, as summaries; resumable, and a failing variant ends nothing."""

from __future__ import annotations

import hashlib
import os
import pickle
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput, LostMotionError
from ..recording import Recording
from .simulate import simulate

Array = NDArray[np.float64]
Progress = Callable[[int, int, float], None]

EVENT_KINDS = ("impact", "separation", "stick", "slip")
#: Times at which a signal is kept for its quantiles (chosen: a picture's width).
_TIMES = 200


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


def simulate_batch(
    drivetrains: Sequence[Drivetrain],
    *,
    dt: float,
    signals: Sequence[str] = ("speed_motor", "speed_load", "twist", "torque_shaft"),
    quantiles: Sequence[str] = (),
    folder: str | Path | None = None,
    trajectories: bool = False,
    workers: int | None = None,
    chunk: int = 50,
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
        what stands: so an interruption (Ctrl-C) loses at most the chunks that were being worked on.
    trajectories : bool
        Keep whole recordings too: one file for each chunk in `folder`, see ``read_trajectories``.
    workers : int, optional
        Processes; default: one for each core. The numbers do not depend on it.
    chunk : int
        Variants in a chunk (chosen: some seconds of work).
    progress : function of (variants done, all variants, remaining seconds), optional
        Called after every chunk.
    **arguments
        Of ``simulate``: torques, law, sensors, seed, state, delay, …

    Raises
    ------
    InvalidInput
        If there is no drivetrain, or trajectories are wanted without a folder. What a single variant raises is
        reported under its index in ``failures``.
    """
    drivetrains = tuple(drivetrains)
    if not drivetrains:
        raise InvalidInput("simulate_batch.drivetrains", "none", "at least one", "Give some variants.")
    if trajectories and folder is None:
        raise InvalidInput(
            "simulate_batch.trajectories", "True without a folder", "a folder", "Say where to keep them."
        )
    work = _Work(dt, tuple(signals), tuple(quantiles), trajectories, dict(arguments))
    starts = range(0, len(drivetrains), chunk)
    parts = {start: drivetrains[start : start + chunk] for start in starts}
    store = None if folder is None else _Store(Path(folder), work, chunk)
    finished = (
        {} if store is None else {start: rows for start in parts if (rows := store.read(start, parts[start]))}
    )
    todo = {start: part for start, part in parts.items() if start not in finished}
    began = time.monotonic()
    before = sum(len(finished_rows) for finished_rows in finished.values())

    def note(start: int, rows: list[dict[str, Any]]) -> None:
        finished[start] = rows
        if progress is not None:
            done = sum(len(rows) for rows in finished.values())
            each = (time.monotonic() - began) / max(1, done - before)
            progress(done, len(drivetrains), each * (len(drivetrains) - done))

    _run_all(work, todo, store, min(workers or os.cpu_count() or 1, max(1, len(todo))), note)
    rows = [row for start in starts for row in finished[start]]
    return _gather(rows, work)


@dataclass(frozen=True, eq=False)
class _Work:
    """What is the same for all variants."""

    dt: float
    signals: tuple[str, ...]
    quantiles: tuple[str, ...]
    trajectories: bool
    arguments: dict[str, Any]

    def run(self, part: Sequence[Drivetrain], first: int, file: Path | None) -> list[dict[str, Any]]:
        """Summaries of a chunk; a variant that fails leaves its message."""
        rows: list[dict[str, Any]] = []
        kept: dict[str, Any] = {}
        for index, drivetrain in enumerate(part, first):
            try:
                recording = simulate(drivetrain, dt=self.dt, **self.arguments)
            except LostMotionError as error:
                rows.append({"failure": str(error)})
                continue
            rows.append(self._summary(recording))
            if file is not None and self.trajectories:
                kept |= {f"{index}/{name}": recording[name] for name in recording}
        if kept and file is not None:
            _write_whole(file.with_suffix(".npz"), lambda stream: np.savez_compressed(stream, **kept))
        return rows

    def _summary(self, recording: Recording) -> dict[str, Any]:
        names = recording.final_state["names"]
        state = recording.final_state["state"]
        kinds = [event.kind for event in recording.events]
        step = -(-len(recording) // _TIMES)
        return {
            "final_state": [v for n, v in zip(names, state, strict=True) if n.startswith(("twist", "speed"))],
            "peak": {n: float(np.max(np.abs(recording[n]))) for n in self.signals if n in recording},
            "rms": {n: float(np.sqrt(np.mean(recording[n] ** 2))) for n in self.signals if n in recording},
            "events": {kind: kinds.count(kind) for kind in EVENT_KINDS},
            "time": recording.time[::step],
            "samples": {n: recording[n][::step].copy() for n in self.quantiles if n in recording},
        }


def _run_all(
    work: _Work,
    todo: Mapping[int, Sequence[Drivetrain]],
    store: _Store | None,
    workers: int,
    note: Callable[[int, list[dict[str, Any]]], None],
) -> None:
    """Works off all chunks, and stores each as it is finished."""

    def finish(start: int, rows: list[dict[str, Any]]) -> None:
        if store is not None:
            store.write(start, todo[start], rows)
        note(start, rows)

    def file(start: int) -> Path | None:
        return None if store is None else store.file(start)

    if workers == 1:
        for start, part in todo.items():
            finish(start, work.run(part, start, file(start)))
        return
    with ProcessPoolExecutor(workers) as pool:
        running: dict[Future[list[dict[str, Any]]], int] = {
            pool.submit(work.run, part, start, file(start)): start for start, part in todo.items()
        }
        try:
            while running:
                for ended in wait(running, return_when=FIRST_COMPLETED).done:
                    finish(running.pop(ended), ended.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


class _Store:
    """Finished chunks in a folder; one that was made from anything else is worked out again."""

    def __init__(self, folder: Path, work: _Work, chunk: int) -> None:
        folder.mkdir(parents=True, exist_ok=True)
        self.folder = folder
        self.key = pickle.dumps(
            (work.dt, work.signals, work.quantiles, work.trajectories, work.arguments, chunk)
        )

    def file(self, start: int) -> Path:
        return self.folder / f"variants-{start:06d}"

    def _mark(self, part: Sequence[Drivetrain]) -> str:
        return hashlib.sha256(self.key + repr(part).encode()).hexdigest()

    def read(self, start: int, part: Sequence[Drivetrain]) -> list[dict[str, Any]] | None:
        try:
            with np.load(self.file(start).with_suffix(".summary.npz"), allow_pickle=False) as data:
                if str(data["mark"]) != self._mark(part):
                    return None
                return [_unpacked(data, i) for i in range(len(part))]
        except (OSError, KeyError, ValueError):
            return None

    def write(self, start: int, part: Sequence[Drivetrain], rows: list[dict[str, Any]]) -> None:
        arrays: dict[str, Any] = {"mark": self._mark(part)}
        for i, row in enumerate(rows):
            for name, value in row.items():
                if isinstance(value, dict):
                    arrays |= {f"{i}/{name}/{key}": v for key, v in value.items()}
                else:
                    arrays[f"{i}/{name}"] = value
        _write_whole(self.file(start).with_suffix(".summary.npz"), lambda stream: np.savez(stream, **arrays))


def _unpacked(data: Any, index: int) -> dict[str, Any]:
    row: dict[str, Any] = {"peak": {}, "rms": {}, "events": {}, "samples": {}}
    for name in data.files:
        where, *rest = name.split("/")
        if where != str(index):
            continue
        value = data[name]
        if len(rest) == 2:
            row[rest[0]][rest[1]] = value if value.ndim else float(value)
        else:
            row[rest[0]] = str(value) if rest[0] == "failure" else value
    return row


def _write_whole(file: Path, write: Callable[[Any], None]) -> None:
    part = file.with_suffix(f".part{os.getpid()}")
    with part.open("wb") as stream:
        write(stream)
    part.replace(file)


def read_trajectories(folder: str | Path, index: int) -> dict[str, Array]:
    """All signals of one variant that ``simulate_batch(…, trajectories=True)`` kept, by name, (n,) each."""
    for file in sorted(Path(folder).glob("variants-*.npz")):
        if file.name.endswith(".summary.npz"):
            continue
        with np.load(file) as data:
            found = {name.split("/", 1)[1]: data[name] for name in data.files if name.startswith(f"{index}/")}
        if found:
            return found
    raise InvalidInput(
        "read_trajectories", f"variant {index}", f"one that is kept in {folder}", "Check the number."
    )


def _gather(rows: list[dict[str, Any]], work: _Work) -> BatchResult:
    done = np.array(["failure" not in row for row in rows])
    width = max((len(row["final_state"]) for row in rows if "final_state" in row), default=0)
    final = np.full((len(rows), width), np.nan)
    for i, row in enumerate(rows):
        if done[i]:
            final[i, : len(row["final_state"])] = row["final_state"]
    times = next((row["time"] for row in rows if "time" in row), np.empty(0))

    def column(kind: str, name: str) -> Array:
        return np.array([row[kind].get(name, np.nan) if "failure" not in row else np.nan for row in rows])

    samples = {}
    for name in work.quantiles:
        samples[name] = np.full((len(rows), times.size), np.nan)
        for i, row in enumerate(rows):
            if done[i] and name in row["samples"]:
                samples[name][i] = row["samples"][name]
    return BatchResult(
        done=done,
        failures={i: row["failure"] for i, row in enumerate(rows) if "failure" in row},
        final_state=final,
        peak={name: column("peak", name) for name in work.signals},
        rms={name: column("rms", name) for name in work.signals},
        events={kind: column("events", kind) for kind in EVENT_KINDS},
        quantile_time=times,
        samples=samples,
    )
