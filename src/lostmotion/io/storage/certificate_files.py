"""certificate.json and the script that checks it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ...certificates import (
    BoxProof,
    ObserverError,
    RunningProof,
    box_stability,
    stability,
    verify_certificate,
)
from ...certificates.observer import verify_observer
from ...errors import InvalidInput
from .json_files import load_json, save_json
from .whole_files import write_bytes


def save_certificate(proof: RunningProof, path: str | Path, verifier: str | Path) -> None:
    """Write the certificate with its statement in words, and beside it the verifier; ``claim`` is null if nothing is
    proved."""
    certificate = proof.certificate or {"claim": None}
    save_json(path, "certificate", {**certificate, "statement": stability(proof)})
    write_bytes(verifier, Path(verify_certificate.__file__).read_bytes())


def save_box_certificate(proof: BoxProof, path: str | Path, verifier: str | Path) -> None:
    """The same for a box; one that is not finished is written too, for a later search to go on from."""
    save_json(path, "certificate", {**proof.certificate, "statement": box_stability(proof)})
    write_bytes(verifier, Path(verify_certificate.__file__).read_bytes())


def unfinished_box(path: str | Path) -> dict[str, Any] | None:
    """The certificate of a box with open cells that an interrupted search has left there; None for anything else."""
    if not Path(path).is_file():
        return None
    try:
        data = load_json(path, "certificate")
    except InvalidInput:
        return None
    return data if data.get("wanted") and data.get("cells") else None


def save_observer_certificate(proof: ObserverError, path: str | Path, verifier: str | Path) -> None:
    """The same for the bound of an observer's error."""
    save_json(path, "certificate", proof.certificate or {"claim": None})
    write_bytes(verifier, Path(verify_observer.__file__).read_bytes())
