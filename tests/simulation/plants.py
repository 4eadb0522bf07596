"""Plants and helpers that several tests of the simulation share."""

from __future__ import annotations

import numpy as np

from lostmotion import Recording


def trajectory(recording: Recording) -> np.ndarray:
    """(n + 1, 2 N − 1) twists and speeds, the final state included."""
    names = recording.final_state["names"]
    keep = [i for i, name in enumerate(names) if name.startswith(("twist", "speed"))]
    rows = np.column_stack([recording[names[i]] for i in keep])
    return np.vstack([rows, np.array(recording.final_state["state"])[keep]])
