"""The inputs of a law: columns from a recording or from arrays, one sample of them, other names for them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InvalidInput
from ..recording import Recording

Matrix = NDArray[np.float64]

#: Largest relative difference between the sample times of a recording and a law (option).
DT_TOLERANCE = 1e-3


def input_columns(
    name: str, inputs: tuple[str, ...], dt: float, data: Recording | Mapping[str, ArrayLike]
) -> tuple[Matrix, Matrix]:
    """Time (n,) in s and inputs (n, n_inputs) of the law ``name`` with sample time ``dt`` (s).

    Raises InvalidInput where a signal is missing, lengths differ, or the recording's sample time is another.
    """
    missing = [signal for signal in inputs if signal not in data]
    if missing:
        raise InvalidInput(
            f"{name}.run", f"no {', '.join(missing)}", f"all of {', '.join(inputs)}", "Add the signal."
        )
    columns = [np.asarray(data[signal], dtype=np.float64) for signal in inputs]
    if len({c.shape for c in columns}) > 1 or any(c.ndim != 1 for c in columns):
        shapes = ", ".join(f"{n}: {c.shape}" for n, c in zip(inputs, columns, strict=True))
        raise InvalidInput(f"{name}.run", shapes, "(n,) arrays of one length", "Crop or resample them.")
    if isinstance(data, Recording):
        if abs(data.dt / dt - 1.0) > DT_TOLERANCE:
            raise InvalidInput(
                f"{name}.run", f"a recording with dt = {data.dt:g} s", f"the law's {dt:g} s",
                "Design the law for the recording's sample time, or resample the recording.",
            )  # fmt: skip
        return data.time, _side_by_side(columns, len(data))
    if not columns:
        raise InvalidInput(f"{name}.run", "a law without inputs", "a Recording", "Give its time axis.")
    time = dt * np.arange(columns[0].size, dtype=np.float64)
    return time, _side_by_side(columns, time.size)


def input_row(name: str, inputs: tuple[str, ...], values: ArrayLike) -> Matrix:
    """A copy (n_inputs,) of the inputs of the law ``name`` in one sample."""
    row = np.array(values, dtype=np.float64)
    if row.shape != (len(inputs),):
        raise InvalidInput(
            f"{name}.step", f"shape {row.shape}", f"{len(inputs)} inputs", f"Give {', '.join(inputs)}."
        )
    return row


def _side_by_side(columns: list[Matrix], rows: int) -> Matrix:
    """(rows, columns), written once: fresh memory costs more time than the law itself."""
    inputs = np.empty((rows, len(columns)))
    for i, column in enumerate(columns):
        inputs[:, i] = column
    return inputs


def renamed_signals(
    law: str, names: Mapping[str, str], inputs: tuple[str, ...], outputs: tuple[str, ...]
) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Inputs and outputs under new names, old name → new name; raises for names that the law does not have."""
    known = inputs + outputs
    unknown = sorted(set(names) - set(known))
    if unknown:
        raise InvalidInput(f"{law}.renamed", f"{unknown}", f"names out of {known}", "Check the name.")
    return tuple(names.get(n, n) for n in inputs), tuple(names.get(n, n) for n in outputs)
