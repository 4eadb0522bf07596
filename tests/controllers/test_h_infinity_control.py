"""H∞: the level equals the norm of the closed loop, computed from its frequency response."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import quadratic_feedback, robust_feedback
from lostmotion.controllers.feedback_law import wished_rows
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.systems import design_model

DT, LIMIT, PULL = 1e-4, 73.5, 10.0
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, viscous=0.0175, lag=3e-4
)
WISHES = {"largest_error": 2.0, "largest_torque": LIMIT, "largest_oscillation": 4.0}


def norm(gain):
    """Largest gain from the torque on the load to the wishes over all frequencies."""
    model = design_model(PLANT, DT)
    a = model.A - np.outer(model.B, gain)
    c = np.vstack([wished_rows("", model, 2.0, LIMIT, 4.0, np.inf), -gain / LIMIT])
    points = np.exp(1j * DT * np.append(0.0, np.geomspace(0.01, np.pi / DT, 4000)))
    columns = (np.linalg.solve(z * np.eye(len(a)) - a, PULL * model.E) for z in points)
    return max(np.linalg.norm(c @ column) for column in columns)


def test_the_smallest_level_is_the_norm_of_its_loop():
    found = robust_feedback(PLANT, DT, load_torque=PULL, margin=1.02, **WISHES)
    assert found.level == pytest.approx(1.02 * found.smallest_level)
    assert norm(found.feedback.gain) == pytest.approx(found.level, rel=1e-3)


@pytest.mark.parametrize("margin", [1.05, 1.5, 5.0])
def test_the_level_is_kept_and_no_law_is_below_the_smallest(margin):
    found = robust_feedback(PLANT, DT, load_torque=PULL, margin=margin, **WISHES)
    assert found.smallest_level * (1.0 - 1e-3) <= norm(found.feedback.gain) <= found.level
    assert norm(quadratic_feedback(PLANT, DT, **WISHES).gain) > norm(found.feedback.gain)


def test_far_above_it_is_the_quadratic_law():
    far = robust_feedback(PLANT, DT, load_torque=PULL, margin=1e4, **WISHES)
    np.testing.assert_allclose(far.feedback.gain, quadratic_feedback(PLANT, DT, **WISHES).gain, rtol=1e-5)


@pytest.mark.parametrize("changes", [{"margin": 1.0}, {"load_torque": 0.0}, {"largest_error": -1.0}])
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"h_infinity.{next(iter(changes))}"):
        robust_feedback(PLANT, DT, **{"load_torque": PULL, **WISHES, **changes})
