"""lostmotion excite: the torque for a test, within limits, and the intervals to expect of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .. import plot
from ..io import save_json
from ..stages.excitation_design import design_excitation
from ..stages.material import RIG_NAMEPLATE
from ..stages.parameters import two_mass
from .recordings import drivetrain_of, outputs, save_picture


def excitation_file(
    file: Path | None,
    out: Path,
    *,
    kind: str,
    duration: float,
    dt: float,
    torque_limit: float,
    speed_limit: float,
    angle_limit: float = np.inf,
    encoder_bits: int = 20,
    seed: int = 1,
) -> dict[str, Any]:
    """Design and write OUT.csv, OUT.json and OUT.png; returns what the JSON holds."""
    csv_file, json_file, picture = outputs(out, ".csv", ".json", ".png")
    design = design_excitation(
        two_mass(RIG_NAMEPLATE) if file is None else drivetrain_of(file),
        kind=kind,
        duration=duration,
        dt=dt,
        torque_limit=torque_limit,
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
    design.save_csv(csv_file)
    save_json(json_file, "excitation", result)
    figure = plot.recording_overview(design.predicted, title=f"Excitation: {kind} (response simulated)")
    save_picture(figure, picture)
    return result
