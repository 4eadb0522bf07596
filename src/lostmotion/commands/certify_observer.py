"""lostmotion certify --observer: how wrong an observer with these sensors can be, and the certificate."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from ..certificates import ObserverError, observer_error
from ..io.storage.certificate_files import save_observer_certificate
from .outputs import outputs
from .recordings import read_drive


def certify_observer(
    drivetrain: Path, out: Path, measured: Sequence[str], force: bool = False
) -> ObserverError:
    """Prove the bound of the Kalman observer's error, write OUT.json and OUT_verify.py.

    ``drivetrain`` as for ``certify_file``; ``measured`` as for ``certificates.observer_error``. A torque lag is left
    out: the observer knows its torque, so the lag adds no error that stays.
    """
    drive = read_drive(drivetrain)
    with outputs(out, ".json", "_verify.py", sources=drive.reads, force=force) as (file, script):
        proof = observer_error(drive.drivetrain.with_parameters(lag=0.0), measured)
        save_observer_certificate(proof, file, script)
    return proof
