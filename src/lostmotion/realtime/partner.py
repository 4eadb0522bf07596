"""The law's process as the rig sees it: started, heard, ended."""

from __future__ import annotations

import errno
import secrets
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ..child_process import end_python, start_python
from ..errors import InvalidInput
from ..export import shared_library
from ..io import save_law
from ..systems import DiscreteSystem, Stepper
from . import law_process
from .datagrams import LONGEST, Wire
from .law_process import HOST

Law = DiscreteSystem | Stepper

#: So long the law's process may take to start, and to end when it is asked to, s (option: a first compilation of a
#: stepper takes most of a minute).
START, STOP = 120.0, 2.0


@dataclass(frozen=True, eq=False)
class Partner:
    """A law's process and the socket to it."""

    process: subprocess.Popen[bytes]
    socket: socket.socket
    wire: Wire

    def check_alive(self) -> None:
        """Raises ``InvalidInput`` with its last words where it has ended."""
        if (code := self.process.poll()) is not None:
            said = self.process.stdout.read().decode(errors="replace").strip() if self.process.stdout else ""
            raise InvalidInput(
                "the law's process", f"ended with exit code {code}: {said or 'no message'}",
                "a process that answers until the end", "Run the law alone, with law.run(recording), to see why.",
            )  # fmt: skip


@contextmanager
def partner(law: Law, *, exported: bool, port: int) -> Iterator[Partner]:
    """A process that steps the law, heard once; it ends with the block, whatever happens in it."""
    with tempfile.TemporaryDirectory() as folder, _bound(port) as rig:
        save_law(law, Path(folder) / "law.json")
        files = [str(Path(folder) / "law.json")]
        if exported and isinstance(law, DiscreteSystem):
            files.append(str(shared_library(law, Path(folder) / "c")))
        wire = Wire(secrets.randbits(64), len(law.inputs), len(law.outputs))
        place = str(rig.getsockname()[1]), str(wire.session)
        process = start_python(law_process.__name__, "run", *place, *files, stdin=subprocess.DEVNULL)
        found = Partner(process, rig, wire)
        try:
            _hear(found)
            yield found
        finally:
            _end(found)


@contextmanager
def _bound(port: int) -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as rig:
        try:
            rig.bind((HOST, port))
        except (OSError, OverflowError) as error:
            taken = getattr(error, "errno", None) == errno.EADDRINUSE
            raise InvalidInput(
                "realtime: port", f"{port}, {'which another program uses' if taken else error}", "a free UDP port",
                "Leave it out: the system then gives a free one.",
            ) from None  # fmt: skip
        yield rig


def _hear(law: Partner) -> None:
    """Wait until the law's process is ready, and talk to it alone from then on."""
    law.socket.settimeout(0.2)
    until = time.monotonic() + START
    while time.monotonic() < until:
        law.check_alive()
        with suppress(TimeoutError):
            datagram, address = law.socket.recvfrom(LONGEST)
            if law.wire.is_ready(datagram):
                law.socket.connect(address)
                return
    raise InvalidInput(
        "the law's process", f"no word in {START:g} s", "that it is ready", "Try it again on a machine with less load."
    )  # fmt: skip


def _end(law: Partner) -> None:
    """Tell it to end; what does not listen is killed."""
    with suppress(OSError):
        law.socket.send(law.wire.end())
    try:
        law.process.wait(STOP)
    except subprocess.TimeoutExpired:
        pass
    finally:  # a second Ctrl-C must leave no process either
        end_python(law.process)
