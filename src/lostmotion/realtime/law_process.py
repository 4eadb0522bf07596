"""The law's process: it steps the law once for each number, and answers again where it is asked again."""

from __future__ import annotations

import os
import socket
import sys
from pathlib import Path

from ..io import load_law
from .datagrams import LONGEST, Wire
from .law_steps import Step, exported_step, own_step

#: The rig's address: this machine, and no other reaches it.
HOST = "127.0.0.1"
#: After so long without a datagram the process looks whether its parent is still there, s (option).
LOOK_ROUND = 0.2


def serve(rig: socket.socket, wire: Wire, step: Step, parent: int) -> None:
    """Answer until the rig says that this is the end, or the parent is gone."""
    rig.settimeout(LOOK_ROUND)
    last, reply = -1, wire.ready()
    rig.send(reply)
    while True:
        try:
            datagram = rig.recv(LONGEST)
        except TimeoutError:
            if os.getppid() != parent:
                return
            if last < 0:
                rig.send(reply)  # the first word may have been lost
            continue
        except ConnectionError:  # the rig no longer listens at its port
            return
        if wire.is_end(datagram):
            return
        request = wire.read_request(datagram)
        if request is None or request[0] < last:
            continue
        number, inputs = request
        if number > last:
            last, reply = number, wire.reply(number, *step(inputs))
        rig.send(reply)


def run(port: str, session: str, law_file: str, library: str = "") -> None:
    """What the process does: serve the rig at that port with a law, or with its exported C in that library.

    Its last words, if it cannot, are on standard output.
    """
    parent = os.getppid()
    try:
        law = load_law(law_file)
        step = exported_step(Path(library), law) if library else own_step(law)
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as rig:
            rig.connect((HOST, int(port)))
            serve(rig, Wire(int(session), len(law.inputs), len(law.outputs)), step, parent)
    except Exception as error:
        print(f"{type(error).__name__}: {error}", flush=True)
        sys.exit(1)
