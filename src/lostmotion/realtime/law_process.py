"""The law's process: ``python -m lostmotion.realtime.law_process PORT SESSION LAW [LIBRARY]``.

It answers every request of the rig once more if it is asked once more, and steps the law once for each number.
"""

from __future__ import annotations

import os
import signal
import socket
import sys
from pathlib import Path

from ..io import load_law
from ..systems import DiscreteSystem
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
        except ConnectionError:  # nobody listens at the rig's port any more
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


def main() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C goes to the rig's process, which ends this one
    parent = os.getppid()
    port, session, path, *library = sys.argv[1:]
    law = load_law(path)
    if library and isinstance(law, DiscreteSystem):
        step = exported_step(Path(library[0]), law)
    else:
        step = own_step(law)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as rig:
        rig.connect((HOST, int(port)))
        serve(rig, Wire(int(session), len(law.inputs), len(law.outputs)), step, parent)


if __name__ == "__main__":
    main()
