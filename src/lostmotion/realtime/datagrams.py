"""The datagrams between rig and law: numbered requests with inputs, replies with outputs, and the end.

Both processes run on one machine, so numbers are in its own format: eight bytes each, no bit changed.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

#: Kind, session, number of the sample (layout).
_HEADER = struct.Struct("=4sQQ")
_REQUEST, _REPLY, _READY, _END = b"LMrq", b"LMrp", b"LMok", b"LMnd"
_FAULTS = struct.Struct("=q")
#: Longest datagram, bytes: a law has at most 62 inputs; more outputs than this are no law (numerics).
LONGEST = 65_000


@dataclass(frozen=True)
class Wire:
    """One session's format: datagrams of another session, or of another length, are none.

    Parameters
    ----------
    session : int
        Random, 64 bit.
    inputs, outputs : int
        How many numbers a request and a reply have.
    """

    session: int
    inputs: int
    outputs: int

    def request(self, number: int, inputs: bytes) -> bytes:
        return _HEADER.pack(_REQUEST, self.session, number) + inputs

    def reply(self, number: int, faults: int, outputs: bytes) -> bytes:
        return _HEADER.pack(_REPLY, self.session, number) + _FAULTS.pack(faults) + outputs

    def ready(self) -> bytes:
        return _HEADER.pack(_READY, self.session, 0)

    def end(self) -> bytes:
        return _HEADER.pack(_END, self.session, 0)

    def read_request(self, datagram: bytes) -> tuple[int, bytes] | None:
        """Number and inputs; None for anything else."""
        return self._body(datagram, _REQUEST, 8 * self.inputs)

    def read_reply(self, datagram: bytes) -> tuple[int, int, bytes] | None:
        """Number, faults and outputs; None for anything else."""
        found = self._body(datagram, _REPLY, _FAULTS.size + 8 * self.outputs)
        if found is None:
            return None
        number, body = found
        return number, _FAULTS.unpack_from(body)[0], body[_FAULTS.size :]

    def is_ready(self, datagram: bytes) -> bool:
        return datagram == self.ready()

    def is_end(self, datagram: bytes) -> bool:
        return datagram == self.end()

    def _body(self, datagram: bytes, kind: bytes, size: int) -> tuple[int, bytes] | None:
        if len(datagram) != _HEADER.size + size:
            return None
        found, session, number = _HEADER.unpack_from(datagram)
        return (number, datagram[_HEADER.size :]) if (found, session) == (kind, self.session) else None
