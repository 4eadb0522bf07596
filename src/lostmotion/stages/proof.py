"""Stage 6, prove: from which load speed on the exported law is stable with the identified drivetrain."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..certificates import prove_with_load, stability
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io.storage.certificate_files import save_certificate
from .design import Design

#: Computing delay of a drive in samples; the law is designed for it (``design.target_law``) (option).
DELAY = 1


def prove(
    laws: Design, drivetrain: Drivetrain | None, folder: Path, progress: Callable[[float, str], None]
) -> dict[str, Any]:
    """Write certificate.json and its verifier into the folder; returns the part of ``results.json``."""
    if laws.law is None or drivetrain is None:
        return {"skipped": laws.skipped}
    try:
        proof = prove_with_load(drivetrain, laws.law, delay=DELAY, progress=progress)
    except InvalidInput as error:
        return {"skipped": str(error)}
    save_certificate(proof, folder / "certificate.json", folder / "certificate_verify.py")
    return stability(proof)
