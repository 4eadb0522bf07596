"""certificate.json and the script that checks it."""

from __future__ import annotations

from pathlib import Path

from ...certificates import ObserverError, RunningProof, stability, verify_certificate
from ...certificates.observer import verify_observer
from .json_files import save_json
from .whole_files import write_bytes


def save_certificate(proof: RunningProof, path: str | Path, verifier: str | Path) -> None:
    """Write the certificate with its statement in words, and beside it the verifier; ``claim`` is null if nothing is
    proved."""
    certificate = proof.certificate or {"claim": None}
    save_json(path, "certificate", {**certificate, "statement": stability(proof)})
    write_bytes(verifier, Path(verify_certificate.__file__).read_bytes())


def save_observer_certificate(proof: ObserverError, path: str | Path, verifier: str | Path) -> None:
    """The same for the bound of an observer's error."""
    save_json(path, "certificate", proof.certificate or {"claim": None})
    write_bytes(verifier, Path(verify_observer.__file__).read_bytes())
