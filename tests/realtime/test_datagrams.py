"""The format: what was packed is unpacked to the last bit, and what is not of this session is none."""

from __future__ import annotations

import struct

import pytest

from lostmotion.realtime.datagrams import Wire

WIRE = Wire(session=2**64 - 7, inputs=3, outputs=2)
INPUTS = struct.pack("=3d", -0.0, float("nan"), 1e-310)
OUTPUTS = struct.pack("=2d", 1.0, float("inf"))


def test_numbers_keep_their_bits() -> None:
    assert WIRE.read_request(WIRE.request(2**40, INPUTS)) == (2**40, INPUTS)
    assert WIRE.read_reply(WIRE.reply(5, -3, OUTPUTS)) == (5, -3, OUTPUTS)


@pytest.mark.parametrize(
    "datagram",
    [
        b"",
        b"hello",
        WIRE.request(1, INPUTS)[:-1],
        WIRE.request(1, INPUTS + b"x"),
        Wire(1, 3, 2).request(1, INPUTS),
        WIRE.ready(),
    ],
)
def test_what_is_no_request_of_this_session_is_none(datagram: bytes) -> None:
    assert WIRE.read_request(datagram) is None
    assert WIRE.read_reply(datagram) is None


def test_a_request_is_no_reply_where_both_are_equally_long() -> None:
    wire = Wire(1, inputs=2, outputs=1)
    assert wire.read_reply(wire.request(0, bytes(16))) is None
    assert wire.read_request(wire.reply(0, 0, bytes(8))) is None


def test_beginning_and_end_belong_to_a_session() -> None:
    other = Wire(1, 3, 2)
    assert WIRE.is_ready(WIRE.ready()) and not WIRE.is_ready(other.ready())
    assert WIRE.is_end(WIRE.end()) and not WIRE.is_end(other.end()) and not WIRE.is_end(WIRE.ready())
