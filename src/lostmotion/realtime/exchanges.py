"""One sample's exchange with the law: in lock-step, or at the tick of the clock."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import numpy as np

from ..errors import InvalidInput
from .datagrams import LONGEST
from .partner import Partner
from .timing import Timing

#: A request is sent again after so long without an answer, s; so long without any the law is given up, s (option).
RESEND, GIVE_UP = 0.05, 5.0
#: The first tick comes so long after the start, s (option).
LEAD = 0.01

Progress = Callable[[float], None]


class _Exchange:
    """What both have: the number of the sample, its outputs, the counts."""

    def __init__(self, law: Partner, samples: int, progress: Progress | None) -> None:
        self.law, self.samples, self._progress = law, samples, progress
        self.number, self.resent, self.ignored = -1, 0, 0
        self.round_trip: list[float] = []
        self.wake_up: list[float] = []
        self.heard = time.perf_counter()
        self.answer = 0, bytes(8 * law.wire.outputs)

    def __call__(self, inputs: bytes) -> tuple[int, bytes]:
        """Inputs of a sample → faults and outputs that act."""
        self.number += 1
        self._exchange(self.law.wire.request(self.number, inputs))
        if self._progress is not None and self.number % max(self.samples // 100, 1) == 0:
            self._progress(self.number / self.samples)
        return self.answer

    def _exchange(self, request: bytes) -> None:
        raise NotImplementedError

    def _receive(self, until: float) -> bool:
        """Whether this sample's answer came until then."""
        while (left := until - time.perf_counter()) > 0.0:
            self.law.socket.settimeout(left)
            try:
                reply = self.law.wire.read_reply(self.law.socket.recv(LONGEST))
            except (TimeoutError, BlockingIOError, ConnectionError):
                return False
            if reply is not None and reply[0] == self.number:
                self.heard, self.answer = time.perf_counter(), reply[1:]
                return True
            self.ignored += 1
        return False

    def _check_partner(self) -> None:
        """Raises ``InvalidInput`` where the law's process has ended, or has been silent for too long."""
        self.law.check_alive()
        if (silent := time.perf_counter() - self.heard) > GIVE_UP and not self._last_word():
            raise InvalidInput(
                "the law's process", f"no answer in {silent:.1f} s", "one for every request",
                "Look whether the process is stopped or the machine overloaded, then start the run again.",
            )  # fmt: skip

    def _last_word(self) -> bool:
        """Whether any datagram is there after all: this process itself may have been the one that was stopped."""
        self.law.socket.settimeout(RESEND)
        try:
            self.law.socket.recv(LONGEST)
        except OSError:
            return False
        self.heard = time.perf_counter()
        return True

    def timing(self, period: float) -> Timing:
        return Timing(
            period, bool(self.wake_up), np.array(self.round_trip), np.array(self.wake_up), self.resent, self.ignored
        )  # fmt: skip


class LockStep(_Exchange):
    """The rig waits for the answer, however long it takes; a lost datagram is sent again."""

    def _exchange(self, request: bytes) -> None:
        self.heard = sent = time.perf_counter()
        self.law.socket.send(request)
        while not self._receive(time.perf_counter() + RESEND):
            self._check_partner()
            self.resent += 1
            with suppress(ConnectionError):  # of an ended process; the check tells of it
                self.law.socket.send(request)
        self.round_trip.append(self.heard - sent)


class Paced(_Exchange):
    """The rig sends at each tick; where the answer is not there at the next tick, the outputs before are held.

    A tick that the rig sleeps through is lost for the law, as for a drive: the plant moves on under the held outputs.
    """

    def __init__(self, law: Partner, samples: int, progress: Progress | None, period: float) -> None:
        super().__init__(law, samples, progress)
        self.period = period
        self.start = 0.0

    def _exchange(self, request: bytes) -> None:
        if self.number == 0:  # not before: the simulation takes its time to begin
            self.start = time.perf_counter() + LEAD
        tick = self.start + self.number * self.period
        if (left := tick - time.perf_counter()) > 0.0:
            time.sleep(left)
        woke, deadline = time.perf_counter(), tick + self.period
        self.wake_up.append(woke - tick)
        before, answered = self.answer, False
        if woke < deadline:
            with suppress(ConnectionError):  # of an ended process; the check tells of it
                self.law.socket.send(request)
            answered = self._receive(deadline) and self.heard <= deadline
        if answered:
            self.round_trip.append(self.heard - woke)
        else:
            self.answer = before
            self.round_trip.append(np.nan)
            self._check_partner()


@contextmanager
def short_timer_slack() -> Iterator[None]:
    """Linux lets a process sleep up to 50 µs too long to save power, unless it says that it minds (proc(5))."""
    slack, before = Path("/proc/self/timerslack_ns"), None
    with suppress(OSError):
        before = slack.read_text()
        slack.write_text("1")
    try:
        yield
    finally:
        if before is not None:
            with suppress(OSError):
                slack.write_text(before)
