"""lostmotion excite: the torque for a test, within limits, and the intervals to expect of it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from .. import plot
from ..errors import InvalidInput
from ..experiment.design import design_excitation
from ..io import save_json
from ..stages.material import RIG_NAMEPLATE
from ..stages.parameters import two_mass
from .cost import Announce, Cost, silent
from .outputs import outputs, save_picture
from .recordings import DriveFile, read_drive
from .simulate import check_times

#: Largest torque of a test on the virtual rig, Nm (option).
TORQUE_LIMIT = 40.0
#: Bytes of memory and seconds that a sample takes: three plants are recorded and identified (calibrated with 20 000 and
#: 60 000 samples on an Intel Xeon: 1200 bytes and 65 µs of processor time).
MEMORY, SECONDS = 1500.0, 1e-4


def excitation_file(
    file: Path | None,
    out: Path,
    *,
    kind: str,
    duration: float,
    dt: float,
    torque_limit: float | None,
    speed_limit: float,
    angle_limit: float = np.inf,
    encoder_bits: int = 20,
    seed: int = 1,
    force: bool = False,
    announce: Announce = silent,
) -> dict[str, Any]:
    """Design and write OUT.csv, OUT.json and OUT.png; returns what the JSON holds.

    Without a ``torque_limit`` (Nm) that of the TOML or of the drivetrain holds; a user's drive needs one. ``announce``
    is called with what a long test will cost.
    """
    drive = None if file is None else read_drive(file)
    read = () if drive is None else drive.reads
    with outputs(out, ".csv", ".json", ".png", sources=read, force=force) as (table, json_file, picture):
        check_times(duration, dt)
        Cost(duration / dt, MEMORY, SECONDS).check(f"{duration:g} s at {dt:g} s", announce)
        design = design_excitation(
            two_mass(RIG_NAMEPLATE) if drive is None else drive.drivetrain,
            kind=kind,
            duration=duration,
            dt=dt,
            torque_limit=_torque_limit(drive) if torque_limit is None else torque_limit,
            speed_limit=speed_limit,
            angle_limit=angle_limit,
            encoder_bits=encoder_bits,
            seed=seed,
        )
        result: dict[str, Any] = {
            "kind": kind,
            "seed": seed,
            "limits": dict(design.limits),
            "peaks": dict(design.peaks),
            "half_widths": dict(design.half_widths),
            "not_excited": list(design.not_excited),
            "problems": [p.as_dict() for p in design.problems],
        }
        design.save_csv(table)
        save_json(json_file, "excitation", result)
        title = f"Excitation: {kind} (response simulated)"
        save_picture(plot.recording_overview(design.predicted, title=title), picture)
    return result


def _torque_limit(drive: DriveFile | None) -> float:
    if drive is None:
        return TORQUE_LIMIT
    stated = None if drive.configuration is None else drive.configuration.law.torque_limit
    limit = stated or drive.drivetrain.actuator.torque_limit
    if math.isinf(limit):
        raise InvalidInput(
            str(drive.path), "no torque limit", "the largest torque that the test may ask for, Nm",
            "Give --torque-limit, or torque_limit in [law] of the TOML.",
        )  # fmt: skip
    return limit
