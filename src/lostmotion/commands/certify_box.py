"""lostmotion certify --box: the proof for every drivetrain within a tolerance; an interrupted one goes on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from ..certificates import around, box_stability, prove_box, simulated
from ..io.storage.certificate_files import save_box_certificate, unfinished_box
from .certify import law_beside, law_of
from .outputs import outputs, stem
from .recordings import read_drive


def certify_box(
    drivetrain: Path,
    out: Path,
    percent: float,
    law: Path | None = None,
    delay: int = 0,
    torque_load: tuple[float, float] | None = None,
    fastest: float = 1000.0,
    speed: float = 1.0,
    parameters: Sequence[str] = ("inertia_load", "stiffness", "coulomb", "backlash"),
    progress: Callable[[float, str], None] | None = None,
    force: bool = False,
) -> dict[str, Any]:
    """Prove what can be proved of a box, write OUT.json and OUT_verify.py; returns the section "Stability".

    Ctrl-C ends the search, and the cells that are proved are written: the same command goes on from them.

    Parameters
    ----------
    percent : float
        Tolerance of each parameter.
    speed : float, rad/s
        Smallest load speed.
    parameters : sequence of str
        See ``certificates.prove_box``.
    drivetrain, out, law, delay, torque_load, fastest, progress, force
        See ``certify_file``; without ``torque_load`` there is none.
    """
    drive = read_drive(drivetrain)
    law = law_beside(drive, law)
    read = drive.reads if law is None else (*drive.reads, law)
    earlier = unfinished_box(Path(f"{stem(out)}.json"))
    with outputs(out, ".json", "_verify.py", sources=read, force=force) as (file, script):
        system = law_of(drive, law)
        proof = prove_box(
            drive.drivetrain, system, around(0.01 * percent, parameters), speed=speed, fastest=fastest, delay=delay,
            torque_load=torque_load or (0.0, 0.0), earlier=earlier, progress=progress,
        )  # fmt: skip
        save_box_certificate(proof, file, script)
    stop = simulated(drive.drivetrain, system, proof)
    return {**box_stability(proof), "simulated": None if stop is None else str(stop)}
