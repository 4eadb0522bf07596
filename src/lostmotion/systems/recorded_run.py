"""The outputs of a law over recorded inputs, as a recording."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..recording import Recording
from .inputs import Matrix


def recorded_run(
    law: str, names: tuple[str, ...], time: Matrix, outputs: Matrix, faults: NDArray[np.int64], state: Matrix
) -> Recording:
    """Outputs (n, n_outputs) under their names, ``input_fault``, and the memory after the last row."""
    signals = {name: outputs[:, i] for i, name in enumerate(names)}
    signals["input_fault"] = (faults != 0).astype(float)
    return Recording(
        time=time,
        signals=signals,
        origin={**dict.fromkeys(names, "estimated"), "input_fault": "derived"},
        final_state={"state": state},
        meta={"law": law},
    )
