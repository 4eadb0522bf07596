"""Damage to the bytes of a file, as a bad copy, a full disk or a careless editor makes it."""

from __future__ import annotations

import random
import re
from collections.abc import Callable

#: Lengths and counts that readers of binary files trip over, little-endian.
_WORDS = tuple(
    value.to_bytes(4, "little")
    for value in (0, 1, 0x7F, 0xFF, 0x7FFF, 0xFFFF, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF)
)
#: What may stand where a number was.
_NUMBERS = (
    b"1e308", b"-1e308", b"1e400", b"1e-400", b"nan", b"inf", b"-inf", b"0", b"-0", b"1_000", b"0x10", b"1,5", b"--1",
    "٣".encode(), "½".encode(), b"9" * 400, b"0." + b"1" * 400, b"true", b'"text"', b"", b"1e", b"1d5", b"1979-05-27",
)  # fmt: skip
#: Marks that bear meaning in one of the formats.
_MARKS = (
    b"\0", b"\xff\xfe", b"\xef\xbb\xbf", b"\xff\xfe\0\0", b'"', b"'", b"[", b"]", b"{", b"}", b",", b";", b"\t", b"\n",
    b"\r", b"#", b"=", b"\\", b"\\u0000", b"\\ud800", "\u2028".encode(), b"[" * 5000, b'{"a":' * 2000,
)  # fmt: skip

Damage = Callable[[bytearray, random.Random], bytes]


#: Headers and sizes stand in the first bytes of most binary files: half of the damage is done there.
_HEAD = 300


def _place(data: bytearray, rng: random.Random) -> int:
    return rng.randrange((min(_HEAD, len(data)) if rng.random() < 0.5 else len(data)) + 1)


def _flip(data: bytearray, rng: random.Random) -> bytes:
    for _ in range(rng.choice((1, 1, 2, 8))):
        data[min(_place(data, rng), len(data) - 1)] ^= 1 << rng.randrange(8)
    return data


def _overwrite(data: bytearray, rng: random.Random) -> bytes:
    at = min(_place(data, rng), len(data) - 1)
    word = rng.choice(_WORDS) if rng.random() < 0.7 else rng.randbytes(rng.choice((1, 2, 4, 8, 64)))
    data[at : at + len(word)] = word
    return data


def _insert(data: bytearray, rng: random.Random) -> bytes:
    at = _place(data, rng)
    data[at:at] = rng.choice(_MARKS)
    return data


def _delete(data: bytearray, rng: random.Random) -> bytes:
    at = _place(data, rng)
    del data[at : at + rng.choice((1, 2, 8, 100, len(data) // 2))]
    return data


def _repeat(data: bytearray, rng: random.Random) -> bytes:
    first, last = sorted((_place(data, rng), _place(data, rng)))
    data[last:last] = data[first : min(last, first + 4000)]
    return data


def _cut_off(data: bytearray, rng: random.Random) -> bytes:
    return data[: _place(data, rng)]


def _lose_the_beginning(data: bytearray, rng: random.Random) -> bytes:
    return data[_place(data, rng) :]


def _zeros(data: bytearray, rng: random.Random) -> bytes:
    """A block that was never written."""
    at = _place(data, rng)
    size = min(len(data) - at, rng.choice((16, 512, 4096)))
    data[at : at + size] = bytes(size)
    return data


def _number(data: bytearray, rng: random.Random) -> bytes:
    """Another number in a text; in a file without any, an overwritten word."""
    found = [match.span() for match in re.finditer(rb"[-+]?\d[\d.]*(?:e[-+]?\d+)?", data)]
    if not found:
        return _overwrite(data, rng)
    first, last = rng.choice(found)
    data[first:last] = rng.choice(_NUMBERS)
    return data


_DAMAGES: tuple[Damage, ...] = (
    _flip, _overwrite, _insert, _delete, _repeat, _cut_off, _lose_the_beginning, _zeros, _number, _number,
)  # fmt: skip


def damaged(data: bytes, rng: random.Random) -> bytes:
    """The bytes with one to three damages."""
    changed = bytes(data)
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        if changed:
            changed = bytes(rng.choice(_DAMAGES)(bytearray(changed), rng))
    return changed
