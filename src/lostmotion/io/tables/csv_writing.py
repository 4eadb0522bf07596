"""Signals of a recording as a CSV file that a drive, a spreadsheet and this package can read."""

from __future__ import annotations

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ...errors import InvalidInput
from ...recording import Recording, unit_of
from ..storage.whole_files import write_bytes

#: Significant digits: finer than any converter of a drive (chosen).
DIGITS = 9


def write_csv(path: str | Path, recording: Recording, *, names: Sequence[str] | None = None) -> None:
    """Write time and signals, comma separated, decimal point, one header row such as ``torque_motor [Nm]``.

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
    text = io.StringIO()
    np.savetxt(
        text, columns, fmt=f"%.{DIGITS}g", delimiter=",", header=",".join(["time [s]", *titles]), comments=""
    )
    write_bytes(Path(path), text.getvalue().encode("utf-8"))
