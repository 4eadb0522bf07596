"""Signals of a recording as a CSV file that a drive, a spreadsheet and this package can read."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...recording import Recording, unit_of
from ..storage.whole_files import whole_file

#: Rows that are text at a time (numerics: 10 MB of it).
BLOCK = 50_000


@checks_arguments
def write_csv(path: str | Path, recording: Recording, *, names: Sequence[str] | None = None) -> None:
    """Write time and signals, comma separated, decimal point, one header row such as ``torque_motor [Nm]``.

    Numbers are written in full: ``read_recording`` gives equal ones.

    Parameters
    ----------
    path : path
        Replaced if it exists; written whole or not at all.
    recording : Recording
    names : sequence of str, optional
        Signals to write, in this order. Default: all.

    Raises
    ------
    InvalidInput
        If a value is not finite, a signal is missing, or the file cannot be written.
    """
    names = recording.names if names is None else tuple(names)
    columns = np.column_stack([recording.time, *(recording[name] for name in names)])
    if not np.all(np.isfinite(columns)):
        row = int(np.flatnonzero(~np.isfinite(columns).all(axis=1))[0])
        raise InvalidInput(
            "write_csv", f"NaN or infinity in row {row}", "finite numbers", "Repair the signal."
        )
    units = [unit_of(name) for name in names]
    titles = [f"{name} [{unit}]" if unit else name for name, unit in zip(names, units, strict=True)]
    with whole_file(path) as temporary, temporary.open("w", encoding="utf-8", newline="") as stream:
        stream.write(",".join(["time [s]", *titles]) + "\n")
        for start in range(0, len(columns), BLOCK):
            rows = columns[start : start + BLOCK].tolist()
            stream.writelines(",".join(map(repr, row)) + "\n" for row in rows)
