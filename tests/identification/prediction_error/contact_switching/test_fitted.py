"""What the observer of constant gain has found, as the contact-switching filter sees it."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.fitted import intervals
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box
from lostmotion.identification.prediction_error.innovations import NAMES, to_theta


def test_the_box_is_no_wider_than_the_intervals(
    flt: ContactFilter, plant: lm.Drivetrain, values: dict[str, float]
):
    """10 % either way of what is identified; a friction enters θ plainly, and its interval is one of its logarithm."""
    theta = to_theta([getattr(plant, name) for name in NAMES], flt.dt)
    free = [NAMES.index(name) for name in ("stiffness", "coulomb", "viscous", "lag")]
    stage: Any = SimpleNamespace(free=free)
    told: Any = SimpleNamespace(theta=theta, half=np.full(len(free), 0.1))
    wide = Box.around(flt, flt.theta(values), 10.0)
    box = intervals(flt, stage, told, wide)
    for name in ("stiffness", "coulomb", "viscous"):
        low, high = (flt.values(end)[INDEX[name]] for end in (box.lower, box.upper))
        assert (low, high) == pytest.approx(
            (getattr(plant, name) * np.exp(-0.1), getattr(plant, name) * np.exp(0.1))
        )
    others = [INDEX[name] for name in ("inertia_motor", "backlash", "coulomb_motor")]
    assert np.array_equal(box.lower[others], wide.lower[others])
    assert np.array_equal(box.upper[others], wide.upper[others])
