"""lostmotion frf: frequency response with coherence, and the two masses that fit it, as JSON and picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from ..identification import frequency_analysis
from ..identification.frequency.response import Method
from ..io import save_json
from ..plot import bode, source_of, words
from ..recording import unit_of
from .outputs import outputs, save_picture
from .recordings import toml_recording_or_rig

#: What zero and pole of a drive with a gap mean.
MOVING_GAP = (
    "With backlash, zero and pole are those of the gap as it moved here: below those of the closed gap."
)


def frequency_response_file(
    file: Path | None,
    out: Path,
    seed: int | None = None,
    input: str = "torque_motor",
    output: str = "speed_motor",
    method: Method = "H1",
    reference: str | None = None,
    band: tuple[float, float] = (1.0, 200.0),
    force: bool = False,
) -> dict[str, Any]:
    """Analyse the band (Hz) and write OUT.json and OUT.png; returns what the JSON holds."""
    given = toml_recording_or_rig(file)
    with outputs(out, ".json", ".png", sources=given.reads, force=force) as (json_file, picture):
        recording, warnings = given.recording(seed)
        analysis = frequency_analysis(recording, input, output, method, reference=reference, band=band)
        response, fit = analysis.response, analysis.fit
        result = (
            analysis.as_dict()
            | {"note": MOVING_GAP}
            | {"problems": [p.as_dict() for p in (*warnings, *analysis.problems)]}
        )
        save_json(json_file, "frequency_response", result)
        source = source_of(recording)
        curves: dict[str, Any] = {source: (response.frequency, response.response, response.margin)}
        marks = {}
        if fit is not None:
            masses = "rigid drive" if len(fit.drivetrain.inertias) == 1 else "two masses"
            curves[f"{masses}, fitted"] = (fit.frequency, fit.fitted)
            marks = {name: value for name in ("zero", "pole") if (value := fit.values[name]) is not None}
        figure = bode(
            curves,
            unit=f"{unit_of(output)}/({unit_of(input)})",
            title=f"{words(output).capitalize()} / {words(input)}",
            marks=marks,
            coherences={source: (response.frequency, response.coherence)},
            note=MOVING_GAP if marks else "",
        )
        save_picture(figure, picture)
    return result
