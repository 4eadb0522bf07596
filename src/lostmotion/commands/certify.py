"""lostmotion certify: from which load speed on a drivetrain and its law are proved stable, and the certificate."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ..certificates import (
    RunningProof,
    count_variants,
    margins,
    prove_running,
    prove_with_load,
    stability,
    worst_case,
)
from ..certificates.robustness.contact_margins import SPEED, margin_data
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io import load_law
from ..io.storage.certificate_files import save_certificate
from ..stages.target_law import default_poles, target_law
from ..systems import DiscreteSystem
from .outputs import outputs
from .recordings import DriveFile, read_drive

#: Sample time of a law that is designed for a TOML without one, s (option).
SAMPLE_TIME = 1e-4


def certify_file(
    drivetrain: Path,
    out: Path,
    law: Path | None = None,
    delay: int = 0,
    torque_load: tuple[float, float] | None = None,
    fastest: float = 1000.0,
    progress: Callable[[float, str], None] | None = None,
    force: bool = False,
    simulate: int = 0,
) -> dict[str, Any]:
    """Prove what can be proved, write OUT.json and OUT_verify.py; returns the section "Stability".

    Parameters
    ----------
    drivetrain : Path
        drivetrain.toml, as a run writes it, with law.json beside it or given; or a TOML of the main job, whose
        nameplate's own law is designed.
    torque_load : (float, float), Nm, optional
        See ``prove_running``; default: none, or if nothing is proved then, one that resists the motion.
    simulate : int
        Variants of the drivetrain to simulate beside the proof, and then a search for the worst start; 0: neither.
    """
    drive = read_drive(drivetrain)
    plant, law = drive.drivetrain, law_beside(drive, law)
    read = drive.reads if law is None else (*drive.reads, law)
    with outputs(out, ".json", "_verify.py", sources=read, force=force) as (file, script):
        system = law_of(drive, law)
        options: dict[str, Any] = {"delay": delay, "fastest": fastest, "progress": progress}
        if torque_load is None:
            proof = prove_with_load(plant, system, **options)
        else:
            proof = prove_running(plant, system, torque_load=torque_load, **options)
        save_certificate(proof, file, script)
        result = {**stability(proof), "margins": margins_of(plant, system, proof)}
        return {**result, "simulated": simulated_beside(plant, system, proof, simulate) if simulate else []}


def margins_of(plant: Drivetrain, law: DiscreteSystem, proof: RunningProof) -> dict[str, dict[str, Any]]:
    """Margins at the load and at a speed of the proof; none where the loop does not rest there."""
    load = proof.torque_load[0]
    speed = max(proof.speed or 0.0, SPEED)
    try:
        return margin_data(margins(plant, law, delay=proof.delay, speed=speed, torque_load=load))
    except InvalidInput:
        return {}


def simulated_beside(plant: Drivetrain, law: DiscreteSystem, proof: RunningProof, count: int) -> list[str]:
    """What simulations say beside the proof, a sentence each."""
    speed = max(proof.reference or 0.0, SPEED)
    found = count_variants(
        plant, law, reference=speed, count=count, torque_load=proof.torque_load[0], delay=proof.delay
    )
    worst = worst_case(plant, law, proof)
    return [str(found), *([] if worst is None else [str(worst)])]


def law_beside(drive: DriveFile, law: Path | None) -> Path | None:
    """The law that is given, or the law.json of the same run."""
    beside = drive.path.with_name("law.json")
    if law is None and beside.is_file() and drive.configuration is None:
        return beside
    return law


def law_of(drive: DriveFile, law: Path | None) -> DiscreteSystem:
    """The law of a file, or the one that the main job would design for a TOML's nameplate."""
    if law is not None:
        loaded = load_law(law)
        if isinstance(loaded, DiscreteSystem):
            return loaded
        raise InvalidInput(
            str(law), f"a {loaded.estimator} filter", "a law of matrices and curves (DiscreteSystem)",
            "Certify one of the fixed-gain observers with its controller.",
        )  # fmt: skip
    if drive.configuration is None:
        raise InvalidInput(str(drive.path), "no law.json beside it", "a law", "Give it with --law.")
    plant, settings = drive.drivetrain, drive.configuration.law
    dt = settings.sample_time or SAMPLE_TIME
    poles = settings.poles or default_poles(plant, dt, False).values
    limit = math.inf if settings.torque_limit is None else settings.torque_limit
    return target_law(plant, poles, limit, dt, False)
