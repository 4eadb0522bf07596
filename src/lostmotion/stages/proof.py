"""Stage 6, prove: from which load speed on the exported law is stable with the identified drivetrain."""

from __future__ import annotations

import pickle
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from ..certificates import prove_with_load, stability
from ..child_process import end_python, start_python
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io.storage.certificate_files import save_certificate
from ..systems import DiscreteSystem
from .design import Design

#: Computing delay of a drive in samples; the law is designed for it (``design.target_law``) (option).
DELAY = 1
#: Smallest load speeds that a run tries, rad/s (option: so that it need not wait; ``lostmotion certify`` tries all).
SPEEDS = (0.5, 2.0)


def prove(law: DiscreteSystem, drivetrain: Drivetrain, folder: Path) -> dict[str, Any]:
    """Write certificate.json and its verifier into the folder; returns the part of ``results.json``."""
    try:
        for speed in SPEEDS:
            proof = prove_with_load(drivetrain, law, delay=DELAY, speeds=(speed,))
            if proof.speed is not None:
                break
    except InvalidInput as error:
        return {"skipped": str(error)}
    save_certificate(proof, folder / "certificate.json", folder / "certificate_verify.py")
    return stability(proof)


class Prover:
    """A process that proves while this one goes on; it starts before there is anything to prove."""

    def __init__(self) -> None:
        #: None where no process can be started: then ``result`` does its work.
        self.child: subprocess.Popen[bytes] | None = None
        with suppress(InvalidInput):
            self.child = start_python(__name__, serve.__name__, stdin=subprocess.PIPE)
        self._job: tuple[DiscreteSystem, Drivetrain, Path] | None = None
        self._skipped = ""

    def begin(self, laws: Design, drivetrain: Drivetrain | None, folder: Path) -> None:
        """Hand over what the design has made."""
        if laws.law is None or drivetrain is None:
            self._skipped = laws.skipped
            return
        self._job = laws.law, drivetrain, folder
        if self.child is not None and self.child.stdin is not None:
            with suppress(OSError):  # it has ended: ``result`` does its work
                pickle.dump(self._job, self.child.stdin)
                self.child.stdin.close()

    def result(self) -> dict[str, Any]:
        """The part of ``results.json``, as soon as it is there."""
        if self._job is None:
            return {"skipped": self._skipped}
        if self.child is not None and self.child.stdout is not None:
            with suppress(EOFError, OSError, pickle.UnpicklingError):
                found: dict[str, Any] = pickle.load(self.child.stdout)
                return found
        return prove(*self._job)


@contextmanager
def prover() -> Iterator[Prover]:
    """A ``Prover`` that ends with the block."""
    at_work = Prover()
    try:
        yield at_work
    finally:
        if at_work.child is not None:
            end_python(at_work.child)


def serve() -> None:
    """One proof, from standard input to standard output."""
    import clarabel  # noqa: F401
    import scipy.linalg
    import scipy.sparse  # noqa: F401

    answer = sys.stdout.buffer
    sys.stdout = sys.stderr  # what a solver prints must not end up in the answer
    try:
        job = pickle.load(sys.stdin.buffer)
    except EOFError:  # the run has ended before
        return
    answer.write(pickle.dumps(prove(*job)))
