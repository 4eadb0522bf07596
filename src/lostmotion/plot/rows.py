"""Rows of numbers that a figure draws against each other: of one length, with an error that names the odd one."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InvalidInput


def rows_of_one_length(figure: str, **rows: ArrayLike | None) -> list[NDArray[Any]]:
    """The rows that are given, as arrays; raises ``InvalidInput`` where they are none or of different lengths."""
    arrays = {name: np.asarray(row) for name, row in rows.items() if row is not None}
    lengths = {row.shape for row in arrays.values()}
    if len(lengths) != 1 or any(row.ndim != 1 for row in arrays.values()):
        got = ", ".join(f"{name} of shape {row.shape}" for name, row in arrays.items())
        raise InvalidInput(f"plot.{figure}", got, "rows of one length", "Crop or resample them alike.")
    return list(arrays.values())
