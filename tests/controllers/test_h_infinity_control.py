"""H∞: the smallest level equals that of a linear matrix inequality, each level the norm of its closed loop."""

from __future__ import annotations

import clarabel
import numpy as np
import pytest
from scipy.sparse import csc_matrix

from lostmotion.controllers import quadratic_feedback, robust_feedback
from lostmotion.controllers.feedback.feedback_law import wished_rows
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.systems import design_model

LIMIT, PULL = 73.5, 10.0
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, viscous=0.0175, lag=3e-4
)
WISHES = {"largest_error": 2.0, "largest_torque": LIMIT, "largest_oscillation": 4.0}

every_sample_time = pytest.mark.parametrize("dt", [1e-4, 1e-3])


def wished(model):
    """Rows of error and oscillation in units of their wishes; the twist has none."""
    return wished_rows("", model, 2.0, LIMIT, 4.0, np.inf)[:2]


def norm(gain, dt):
    """Largest gain from the torque on the load to the wishes over all frequencies."""
    model = design_model(PLANT, dt)
    a = model.A - np.outer(model.B, gain)
    c = np.vstack([wished(model), -gain / LIMIT])
    points = np.exp(1j * dt * np.append(0.0, np.geomspace(0.01, np.pi / dt, 4000)))
    columns = (np.linalg.solve(z * np.eye(len(a)) - a, PULL * model.E) for z in points)
    return max(np.linalg.norm(c @ column) for column in columns)


def level_by_inequality(dt):
    """The smallest level of any state feedback u = Y Q⁻¹ x, by the bounded real lemma (Gahinet & Apkarian 1994).

    In units of 4 mrad, 1 rad/s, 20 Nm::

        min level²   with   [Q  0  (AQ+BY)ᵀ  (CQ+DY)ᵀ;  0  level²  Eᵀ  0;  AQ+BY  E  Q  0;  CQ+DY  0  0  I] ≥ 0
    """
    model = design_model(PLANT, dt)
    units = np.array([4e-3, 1.0, 1.0, 20.0, 20.0])
    a, b, e = model.A * units / units[:, None], model.B * LIMIT / units, model.E * PULL / units
    c, d = np.vstack([wished(model) * units, np.zeros(5)]), np.eye(3)[2]
    lower = np.tril_indices(5)

    def inequality(unknowns, constant):
        q = np.zeros((5, 5))
        q[lower] = q[lower[::-1]] = unknowns[:15]
        y, square = unknowns[15:20], unknowns[20:]
        f, g, e_ = a @ q + np.outer(b, y), c @ q + np.outer(d, y), constant * e[:, None]
        return np.block([
            [q, np.zeros((5, 1)), f.T, g.T],
            [np.zeros((1, 5)), square[:, None], e_.T, np.zeros((1, 3))],
            [f, e_, q, np.zeros((5, 3))],
            [g, np.zeros((3, 6)), constant * np.eye(3)],
        ])  # fmt: skip

    rows, columns = np.tril_indices(14)
    weights = np.where(rows == columns, 1.0, np.sqrt(2.0))
    parts = np.array([weights * inequality(one, 0.0)[columns, rows] for one in np.eye(21)])
    right = weights * inequality(np.zeros(21), 1.0)[columns, rows]
    settings = clarabel.DefaultSettings()
    settings.verbose, settings.max_threads = False, 1
    nothing, cost, cones = csc_matrix((21, 21)), np.eye(21)[20], [clarabel.PSDTriangleConeT(14)]
    found = clarabel.DefaultSolver(nothing, cost, csc_matrix(-parts.T), right, cones, settings).solve()
    assert str(found.status) == "Solved"
    return float(np.sqrt(found.x[20]))


@every_sample_time
def test_the_smallest_level_is_that_of_a_linear_matrix_inequality(dt):
    found = robust_feedback(PLANT, dt, load_torque=PULL, **WISHES)
    assert found.smallest_level == pytest.approx(level_by_inequality(dt), rel=1e-3)


@every_sample_time
def test_near_the_smallest_level_the_loop_has_just_that_norm(dt):
    found = robust_feedback(PLANT, dt, load_torque=PULL, margin=1.006, **WISHES)
    assert found.level == pytest.approx(1.006 * found.smallest_level)
    assert found.smallest_level * (1.0 - 1e-3) <= norm(found.feedback.gain, dt) <= found.level


@every_sample_time
@pytest.mark.parametrize("margin", [1.05, 1.5, 5.0])
def test_the_level_is_kept_and_no_law_is_below_the_smallest(margin, dt):
    found = robust_feedback(PLANT, dt, load_torque=PULL, margin=margin, **WISHES)
    assert found.smallest_level * (1.0 - 1e-3) <= norm(found.feedback.gain, dt) <= found.level
    assert norm(quadratic_feedback(PLANT, dt, **WISHES).gain, dt) > norm(found.feedback.gain, dt)


def test_far_above_it_is_the_quadratic_law():
    far = robust_feedback(PLANT, 1e-4, load_torque=PULL, margin=1e4, **WISHES)
    np.testing.assert_allclose(far.feedback.gain, quadratic_feedback(PLANT, 1e-4, **WISHES).gain, rtol=1e-5)


@pytest.mark.parametrize("changes", [{"margin": 1.0}, {"load_torque": 0.0}, {"largest_error": -1.0}])
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"h_infinity.{next(iter(changes))}"):
        robust_feedback(PLANT, 1e-4, **{"load_torque": PULL, **WISHES, **changes})
