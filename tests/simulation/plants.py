"""Plants and helpers that several tests of the simulation share."""

from __future__ import annotations

import numpy as np

from lostmotion import Recording

#: Table I of Fietzek & Rinderknecht.
TABLE_I = dict(
    inertia_motor=0.0182,
    inertia_load=0.111,
    stiffness=6285.896,
    damping=0.397,
    backlash=0.012,
    coulomb=2.0,
    viscous=0.0175,
)


def trajectory(recording: Recording) -> np.ndarray:
    """(n + 1, 2 N − 1) twists and speeds, the final state included."""
    names = recording.final_state["names"]
    keep = [i for i, name in enumerate(names) if name.startswith(("twist", "speed"))]
    rows = np.column_stack([recording[names[i]] for i in keep])
    return np.vstack([rows, np.array(recording.final_state["state"])[keep]])
