"""Windows computed in 113-bit arithmetic: the simulator's error in each from the window's own start."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from plants import trajectory

import lostmotion as lm

PART = Path(__file__).with_name("reference_windows.npz")
WHOLE = (
    Path(os.environ.get("LOSTMOTION_DATA", Path(__file__).parents[2] / ".." / "shared" / "data")).parent
    / "reference"
    / "two_mass_exact.npz"
)


def window_errors(file: Path, kind: str, plant: lm.Drivetrain) -> np.ndarray:
    with np.load(file) as data:
        torque, start, states = (data[f"{kind}_{part}"] for part in ("torque", "start", "states"))
    span = np.ptp(states.reshape(-1, 3), axis=0)
    errors = []
    for u, x, exact in zip(torque, start, states, strict=True):
        got = trajectory(lm.simulate(plant, torque_motor=u, dt=1e-4, state=x))
        errors.append(float(np.max(np.abs(got - exact) / span)))
    return np.array(errors)


@pytest.mark.parametrize("kind", ["contact", "stiction"])
def test_kept_windows(kind, paper):
    errors = window_errors(PART, kind, paper)
    assert errors.size == 3
    assert np.median(errors) <= 2e-14
    assert errors.max() <= 1e-12


@pytest.mark.parametrize("kind", ["contact", "stiction"])
def test_all_windows(kind, paper):
    if not WHOLE.exists():
        pytest.skip(f"the whole reference file is not at {WHOLE}")
    errors = window_errors(WHOLE, kind, paper)
    assert errors.size == 40
    assert np.median(errors) <= 2e-14
    assert errors.max() <= 1e-12
