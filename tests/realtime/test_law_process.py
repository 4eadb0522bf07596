"""The law's side: one step for each number, an answer for each request, and an end when nobody is there any more."""

from __future__ import annotations

import os
import socket
import struct
import threading
from collections.abc import Iterator

import pytest

from lostmotion.realtime import law_process
from lostmotion.realtime.datagrams import LONGEST, Wire
from lostmotion.realtime.law_process import HOST, serve

WIRE = Wire(session=5, inputs=1, outputs=1)


class Counter:
    """A law that counts its steps."""

    steps = 0

    def __call__(self, inputs: bytes) -> tuple[int, bytes]:
        self.steps += 1
        return 0, struct.pack("=d", self.steps)


@pytest.fixture
def rig(monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[socket.socket, Counter, threading.Thread]]:
    """A rig's socket, the law that it talks to, and the thread that serves it."""
    monkeypatch.setattr(law_process, "LOOK_ROUND", 0.05)
    counter = Counter()
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as rig,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as law,
    ):
        rig.bind((HOST, 0))
        rig.settimeout(5.0)
        law.connect(rig.getsockname())
        thread = threading.Thread(target=serve, args=(law, WIRE, counter, os.getppid()))
        thread.start()
        ready, address = rig.recvfrom(LONGEST)
        assert WIRE.is_ready(ready)
        rig.connect(address)
        yield rig, counter, thread
        rig.send(WIRE.end())
        thread.join(5.0)
        assert not thread.is_alive()


def asked(rig: socket.socket, number: int) -> tuple[int, float]:
    """The next answer after a request: its number and its output."""
    rig.send(WIRE.request(number, bytes(8)))
    while (reply := WIRE.read_reply(rig.recv(LONGEST))) is None:
        pass
    return reply[0], struct.unpack("=d", reply[2])[0]


def test_a_request_that_comes_twice_is_answered_twice_and_stepped_once(rig) -> None:
    talk, counter, _ = rig
    assert asked(talk, 0) == (0, 1.0)
    assert asked(talk, 0) == (0, 1.0)
    assert asked(talk, 1) == (1, 2.0)
    assert counter.steps == 2


def test_an_old_request_and_a_foreign_one_are_ignored(rig) -> None:
    talk, counter, _ = rig
    assert asked(talk, 3) == (3, 1.0)  # a lost sample is not made up for
    for datagram in (WIRE.request(2, bytes(8)), b"noise", Wire(6, 1, 1).request(9, bytes(8))):
        talk.send(datagram)
    assert asked(talk, 4) == (4, 2.0)
    assert counter.steps == 2


def test_it_ends_when_its_parent_is_gone(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(law_process, "LOOK_ROUND", 0.05)
    with (
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as rig,
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as law,
    ):
        rig.bind((HOST, 0))
        law.connect(rig.getsockname())
        thread = threading.Thread(target=serve, args=(law, WIRE, Counter(), os.getppid() + 1), daemon=True)
        thread.start()
        thread.join(5.0)
        assert not thread.is_alive()
