"""A chunk of a batch: what is simulated of every variant, and the summaries as columns."""

from __future__ import annotations

import os
import threading
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput, LostMotionError
from ...events import KINDS
from ...recording import Recording
from ..inputs import check_lengths, check_sample_time, check_signal
from ..simulate import simulate
from .family import TorqueRun, family_key
from .law_family import LawRun

Array = NDArray[np.float64]

#: Times at which a signal is kept for its quantiles (option: a picture's width).
TIMES = 200


@dataclass(frozen=True, eq=False)
class Chunk:
    """Summaries of c variants in a row; NaN where a variant failed or has no such signal.

    Parameters
    ----------
    failures : mapping of place in the chunk → message
    final_state : (c, w)
    peak, rms : (S, c)
    events : (4, c)
    samples : (Q, c, t)
    time : (t,), s
    """

    failures: dict[int, str]
    final_state: Array
    peak: Array
    rms: Array
    events: Array
    samples: Array
    time: Array

    @classmethod
    def empty(cls, work: Work, part: Sequence[Drivetrain]) -> Chunk:
        count = len(part)
        width = max(2 * len(drivetrain.inertias) - 1 for drivetrain in part)
        return cls(
            failures={},
            final_state=np.full((count, width), np.nan),
            peak=np.full((len(work.signals), count), np.nan),
            rms=np.full((len(work.signals), count), np.nan),
            events=np.full((len(KINDS), count), np.nan),
            samples=np.full((len(work.quantiles), count, work.time.size), np.nan),
            time=work.time,
        )


@dataclass(frozen=True, eq=False)
class Work:
    """What is the same for all variants; `arguments` are those of ``simulate``."""

    dt: float
    signals: tuple[str, ...]
    quantiles: tuple[str, ...]
    trajectories: bool
    arguments: dict[str, Any]
    torques: dict[str, Array] = field(init=False)
    time: Array = field(init=False)

    def __post_init__(self) -> None:
        check_sample_time(self.dt)
        others = ("law", "sensors", "seed", "delay", "energy", "state")
        given = {n: v for n, v in self.arguments.items() if n not in others and v is not None}
        checked = {name: check_signal(name, values) for name, values in given.items()}
        length = check_lengths(checked) if checked else 0
        object.__setattr__(self, "torques", checked)
        object.__setattr__(self, "time", np.arange(0, length, self.step, dtype=float) * self.dt)

    @property
    def step(self) -> int:
        """Samples from one that is kept for quantiles to the next."""
        length = len(next(iter(self.torques.values()), ()))
        return max(1, -(-length // TIMES))

    @cached_property
    def compiled(self) -> TorqueRun | LawRun | None:
        """How whole variants run in compiled code; None where ``simulate`` has to run them one by one."""
        others = {name: value for name, value in self.arguments.items() if name not in self.torques}
        if self.trajectories or others.get("energy") or not self.torques:
            return None
        state, law = others.get("state"), others.get("law")
        if law is not None:
            return LawRun(
                self.dt, law, self.torques, state, others.get("delay", 0), others.get("sensors") or {},
                others.get("seed", 0), self.signals, self.quantiles, self.step,
            )  # fmt: skip
        if any(others.get(name) for name in ("sensors", "seed", "delay")):
            return None
        if all(name.startswith("torque_") for name in self.torques):
            return TorqueRun(self.dt, self.torques, state, self.signals, self.quantiles, self.step)
        return None

    def run(self, part: Sequence[Drivetrain], first: int, file: Path | None) -> Chunk:
        """Summaries of a chunk whose first variant has the number `first`; one that fails leaves its message."""
        chunk = Chunk.empty(self, part)
        families: dict[Any, list[int]] = {}
        kept: dict[str, Any] = {}
        together = self.compiled
        for i, drivetrain in enumerate(part):
            if together is not None and together.knows(drivetrain):
                families.setdefault(family_key(drivetrain), []).append(i)
            elif (recording := self._alone(drivetrain, i, chunk)) is not None and file is not None:
                kept |= {f"{first + i}/{name}": recording[name] for name in recording}
        if together is not None:
            for members in families.values():
                self._family(together, part, members, chunk)
        if kept and self.trajectories and file is not None:
            write_whole(file.with_suffix(".npz"), kept, compressed=True)
        return chunk

    def _family(
        self, run: TorqueRun | LawRun, part: Sequence[Drivetrain], members: list[int], chunk: Chunk
    ) -> None:
        """Variants that differ in their numbers only."""
        from ...kernels.plant.event_loop import DONE

        try:
            names, wanted, summary = run.run([part[i] for i in members])
        except LostMotionError:
            for i in members:
                self._alone(part[i], i, chunk)
            return
        at = np.array(members)
        moved = [j for j, name in enumerate(names) if name.startswith(("twist", "speed"))]
        chunk.final_state[at, : len(moved)] = summary.final[:, moved]
        chunk.events[:, at] = summary.events.T
        for j, name in enumerate(wanted):
            if name in self.signals:
                chunk.peak[self.signals.index(name), at] = summary.peak[:, j]
                chunk.rms[self.signals.index(name), at] = np.sqrt(summary.square[:, j] / run.length)
        for j, name in enumerate([name for name in self.quantiles if name in wanted]):
            chunk.samples[self.quantiles.index(name), at] = summary.samples[:, j]
        for stopped in np.flatnonzero(summary.status != DONE).tolist():
            self._alone(part[members[stopped]], members[stopped], chunk)

    def _alone(self, drivetrain: Drivetrain, i: int, chunk: Chunk) -> Recording | None:
        """One variant by ``simulate``; its recording, or None if it failed."""
        try:
            recording = simulate(drivetrain, dt=self.dt, **self.arguments)
        except LostMotionError as error:
            chunk.failures[i] = str(error)
            for column in (
                chunk.final_state[i],
                chunk.peak[:, i],
                chunk.rms[:, i],
                chunk.events[:, i],
                chunk.samples[:, i],
            ):
                column[:] = np.nan
            return None
        state = recording.final_state
        moved = [
            v for n, v in zip(state["names"], state["state"], strict=True) if n.startswith(("twist", "speed"))
        ]
        chunk.final_state[i, : len(moved)] = moved
        chunk.events[:, i] = [recording.events.count_of(kind) for kind in KINDS]
        for j, name in enumerate(self.signals):
            if name in recording:
                chunk.peak[j, i] = np.max(np.abs(recording[name]))
                chunk.rms[j, i] = np.sqrt(np.mean(recording[name] ** 2))
        for j, name in enumerate(self.quantiles):
            if name in recording:
                chunk.samples[j, i] = recording[name][:: self.step]
        return recording


def write_whole(file: Path, arrays: Mapping[str, Any], compressed: bool = False) -> None:
    """Writes a .npz whole or not at all; raises ``InvalidInput`` where that fails."""
    part = file.with_suffix(f".part{os.getpid()}-{threading.get_ident()}")
    try:
        with part.open("wb") as stream:
            (np.savez_compressed if compressed else np.savez)(stream, **arrays)
        part.replace(file)
    except OSError as error:
        raise InvalidInput(
            str(file.parent),
            error.strerror or "an error",
            "a place that can be written, with room for the chunks",
            "Make room, then give the same again: the finished chunks stand.",
        ) from None
    finally:
        part.unlink(missing_ok=True)
