"""Notch: its gain at zero, at its frequency and far off; misuse."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import notch
from lostmotion.errors import InvalidInput


@pytest.mark.parametrize("frequency, dt", [(100.0, 1e-4), (300.0, 1e-3), (37.0, 1e-2)])
@pytest.mark.parametrize("depth", [0.0, 0.1, 1.0])
def test_gain(frequency, dt, depth):
    law = notch("a", "b", frequency=frequency, dt=dt, depth=depth)

    def gain(hertz):
        z = np.exp(2j * np.pi * hertz * dt)
        return abs((law.C @ np.linalg.solve(z * np.eye(2) - law.A, law.B) + law.D)[0, 0])

    assert gain(0.0) == pytest.approx(1.0) and gain(0.5 / dt) == pytest.approx(1.0)
    assert gain(frequency) == pytest.approx(depth, abs=1e-9)
    assert np.max(np.abs(law.poles())) < 1.0


@pytest.mark.parametrize(
    "changes", [{"frequency": 5000.0}, {"frequency": 0.0}, {"width": 0.0}, {"depth": 1.5}]
)
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"notch.*{next(iter(changes))}"):
        notch("a", "b", **{"frequency": 100.0, "dt": 1e-4, **changes})
