"""Recordings of the measured rig: speeds of both ends of a shaft, and its torque."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

from lostmotion.recording import Recording

DATA = Path(os.environ.get("LOSTMOTION_DATA", Path(__file__).parents[3] / ".." / "shared" / "data"))


def measured(name: str) -> Recording:
    path = DATA / "aalto" / name
    if not path.exists():
        pytest.skip(f"no {path}: set LOSTMOTION_DATA to the folder of measured data")
    columns = np.loadtxt(path, delimiter=",", unpack=True)
    return Recording(
        columns[0], {"speed_motor": columns[1], "speed_load": columns[2], "torque_shaft": columns[3]}
    )
