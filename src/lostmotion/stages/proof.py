"""Stage 6, prove: from which load speed on the exported law is stable with the identified drivetrain."""

from __future__ import annotations

from pathlib import Path
from threading import Event
from typing import Any

from ..certificates import prove_with_load, stability
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io.storage.certificate_files import save_certificate
from .design import Design

#: Computing delay of a drive in samples; the law is designed for it (``design.target_law``) (option).
DELAY = 1
#: Smallest load speeds that a run tries, rad/s (option: so that it need not wait; ``lostmotion certify`` tries all).
SPEEDS = (0.5, 2.0)


class Stopped(Exception):
    """The run that wanted the proof has ended."""


def prove(laws: Design, drivetrain: Drivetrain | None, folder: Path, stop: Event) -> dict[str, Any]:
    """Write certificate.json and its verifier into the folder; returns the part of ``results.json``.

    Raises ``Stopped`` within a second after ``stop`` is set.
    """

    def go_on(share: float, text: str) -> None:
        if stop.is_set():
            raise Stopped

    if laws.law is None or drivetrain is None:
        return {"skipped": laws.skipped}
    try:
        for speed in SPEEDS:
            proof = prove_with_load(drivetrain, laws.law, delay=DELAY, speeds=(speed,), progress=go_on)
            if proof.speed is not None:
                break
    except InvalidInput as error:
        return {"skipped": str(error)}
    save_certificate(proof, folder / "certificate.json", folder / "certificate_verify.py")
    return stability(proof)
