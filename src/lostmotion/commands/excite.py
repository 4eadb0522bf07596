"""lostmotion excite: the torque for a test, within limits, and the intervals to expect of it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from .. import plot
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io import load_drivetrain, read_configuration, save_json
from ..stages.excitation_design import design_excitation
from ..stages.material import RIG_NAMEPLATE
from ..stages.parameters import two_mass
from .recordings import outputs, save_picture


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
        nameplate_of(file),
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


def nameplate_of(file: Path | None) -> Drivetrain:
    """The nameplate of a TOML of the main job, or a drivetrain.toml; without a file the virtual rig's."""
    if file is None:
        return two_mass(RIG_NAMEPLATE)
    try:
        return load_drivetrain(file)
    except InvalidInput as error:
        nameplate = read_configuration(file).nameplate
        missing = [n for n in ("inertia_motor", "inertia_load", "stiffness") if n not in nameplate]
        if missing:
            raise InvalidInput(
                str(file), f"no {', '.join(missing)} in [nameplate]", "rough values of these", "Add them."
            ) from error
        return two_mass(nameplate)
