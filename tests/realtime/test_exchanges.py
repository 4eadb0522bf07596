"""One sample's exchange, on a clock that only the test moves."""

from __future__ import annotations

import struct
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from lostmotion.errors import InvalidInput
from lostmotion.realtime import exchanges
from lostmotion.realtime.datagrams import Wire
from lostmotion.realtime.exchanges import LockStep, Paced
from lostmotion.realtime.partner import Partner

WIRE = Wire(session=3, inputs=1, outputs=1)
INPUTS = bytes(8)


class Clock:
    """In place of the module ``time``."""

    now = 100.0

    def perf_counter(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(exchanges, "time", made)
    return made


class Law:
    """A socket with the answers of ``answer(number)``: seconds that ``recv`` takes for each, and the datagrams."""

    def __init__(self, clock: Clock, answer: Callable[[int], tuple[float, list[bytes]]]) -> None:
        self.clock, self.answer, self.sent, self.limit = clock, answer, 0, 0.0
        self.waiting: list[tuple[float, bytes]] = []

    def send(self, datagram: bytes) -> None:
        number = WIRE.read_request(datagram)[0]  # type: ignore[index]
        self.sent += 1
        seconds, replies = self.answer(number)
        self.waiting += [(seconds, reply) for reply in replies]

    def settimeout(self, seconds: float) -> None:
        self.limit = seconds

    def recv(self, _size: int) -> bytes:
        if not self.waiting:
            self.clock.sleep(self.limit)
            raise TimeoutError
        seconds, datagram = self.waiting.pop(0)
        self.clock.sleep(seconds)
        return datagram


def partner_with(law: Law) -> Partner:
    process: Any = SimpleNamespace(poll=lambda: None)
    socket: Any = law
    return Partner(process, socket, WIRE)


def reply(number: int, value: float) -> bytes:
    return WIRE.reply(number, number, struct.pack("=d", value))


def value_of(answer: tuple[int, bytes]) -> float:
    return float(struct.unpack("=d", answer[1])[0])


def test_lock_step_takes_the_answer_with_its_own_number_alone(clock: Clock) -> None:
    law = Law(clock, lambda n: (1e-3, [b"noise", reply(n + 1, -1.0), reply(n, 10.0 + n), reply(n, 10.0 + n)]))
    exchange = LockStep(partner_with(law), 3, None)
    assert [value_of(exchange(INPUTS)) for _ in range(3)] == [10.0, 11.0, 12.0]
    # Noise and the wrong number each time, and twice the doubled answer to the sample before.
    assert exchange.ignored == 3 * 2 + 2 and exchange.resent == 0
    assert exchange.answer[0] == 2  # faults come with the outputs
    np.testing.assert_allclose(exchange.round_trip, [3e-3, 4e-3, 4e-3])


def test_lock_step_asks_again_until_there_is_an_answer(clock: Clock) -> None:
    answers = iter([[], [], [reply(0, 7.0)]])
    law = Law(clock, lambda n: (0.0, next(answers)))
    exchange = LockStep(partner_with(law), 1, None)
    assert value_of(exchange(INPUTS)) == 7.0
    assert (law.sent, exchange.resent) == (3, 2)
    assert exchange.round_trip[0] == pytest.approx(2.0 * exchanges.RESEND)


def test_paced_an_answer_that_comes_too_late_does_not_act(clock: Clock) -> None:
    law = Law(clock, lambda n: (0.025 if n == 2 else 0.005, [reply(n, 1.0 + n)]))
    exchange = Paced(partner_with(law), 5, None, period=0.02)
    assert [value_of(exchange(INPUTS)) for _ in range(5)] == [1.0, 2.0, 2.0, 4.0, 5.0]
    timing = exchange.timing(0.02)
    np.testing.assert_allclose(timing.round_trip, [0.005, 0.005, np.nan, 0.005, 0.005])
    np.testing.assert_allclose(timing.wake_up, [0.0, 0.0, 0.0, 0.005, 0.0], atol=1e-12)
    assert timing.missed == 1
    summary: Any = timing.summary()
    assert summary["round_trip"]["largest"] == pytest.approx(0.005) == summary["wake_up"]["largest"]


def test_paced_a_tick_that_was_slept_through_is_not_sent(clock: Clock) -> None:
    law = Law(clock, lambda n: (0.0, [reply(n, 1.0)]))
    exchange = Paced(partner_with(law), 5, None, period=0.01)
    exchange(INPUTS)
    clock.sleep(0.035)
    for _ in range(4):
        exchange(INPUTS)
    assert law.sent == 3
    np.testing.assert_allclose(exchange.wake_up, [0.0, 0.025, 0.015, 0.005, 0.0], atol=1e-12)
    assert exchange.timing(0.01).missed == 2


def test_a_silent_law_is_given_up_and_one_that_was_heard_after_all_is_not(clock: Clock) -> None:
    """The rig's own process may have been stopped for longer than the law may be silent."""
    law = Law(clock, lambda n: (0.0, []))
    exchange = LockStep(partner_with(law), 2, None)
    before = clock.now
    with pytest.raises(InvalidInput, match=r"no answer in 5\.\d s"):
        exchange(INPUTS)
    assert clock.now - before < 1.1 * exchanges.GIVE_UP
    law.waiting = [(0.0, b"late")]
    exchange._check_partner()
    assert exchange.heard == clock.now
