"""The H∞ observer: its bound, its limits, and what it is good for."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.errors import InvalidInput
from lostmotion.observers import h_infinity, kalman
from lostmotion.observers.fixed_gain.h_infinity import WEIGHTS, _gain, _smallest_level, _weight_rows
from lostmotion.observers.fixed_gain.kalman import covariances_of
from lostmotion.observers.fixed_gain.sampled_model import sampled_model
from lostmotion.simulation import simulate

DT = 1e-4


def design(**options):
    found = sampled_model(PAPER, ("speed_motor",), DT, **options)
    return found, *covariances_of(found, None, None), _weight_rows(found, WEIGHTS)


def worst_gain(found, q, r, w, gain):
    """Largest singular value over frequency from noises of unit covariance to the weighted error."""
    error = found.step(found.model.A) - gain @ found.c
    noise = np.linalg.cholesky(found.noise(found.model.A, q) + 1e-18 * np.eye(len(error)))
    inputs = np.hstack([noise, -gain @ np.sqrt(r / DT)])
    frequencies = np.concatenate([[0.0], np.geomspace(1e-5, np.pi, 400)])
    responses = [
        w @ np.linalg.solve(np.exp(1j * f) * np.eye(len(error)) - error, inputs) for f in frequencies
    ]
    return max(float(np.linalg.norm(response, 2)) for response in responses)


@pytest.mark.parametrize("margin", [1.02, 1.5, 4.0])
def test_the_bound_holds_and_kalman_breaks_it(margin):
    found, q, r, w = design()
    smallest = _smallest_level(found, q, r, w)
    gain = _gain(found, q, r, w, margin * smallest)
    assert worst_gain(found, q, r, w, gain) < margin * smallest
    calm = _gain(found, q, r, w, 1e4 * smallest)
    assert worst_gain(found, q, r, w, calm) > 1.02 * smallest


def test_the_gain_is_that_of_the_recursion():
    """P and K by iterating the docstring's equations from P = 0."""
    found, q, r, w = design()
    level = 1.1 * _smallest_level(found, q, r, w)
    phi, noise, r_d = found.step(found.model.A), found.noise(found.model.A, q), r / DT
    information = found.c.T @ np.linalg.inv(r_d) @ found.c - w.T @ w / level**2
    p = np.zeros((3, 3))
    for _ in range(10_000):
        filtered = p @ np.linalg.inv(np.eye(3) + information @ p)
        p = phi @ filtered @ phi.T + noise
    wanted = phi @ p @ np.linalg.inv(np.eye(3) + information @ p) @ found.c.T @ np.linalg.inv(r_d)
    np.testing.assert_allclose(_gain(found, q, r, w, level), wanted, rtol=1e-6)


def test_below_the_smallest_level_there_is_no_gain():
    found, q, r, w = design()
    smallest = _smallest_level(found, q, r, w)
    assert _gain(found, q, r, w, 0.99 * smallest) is None
    assert _gain(found, q, r, w, 1.01 * smallest) is not None


@pytest.mark.parametrize("options", [{}, {"speed_from_counts": True}, {"load_torque": True}])
def test_far_from_the_level_it_is_the_kalman_observer(options):
    a, b = h_infinity(PAPER, dt=DT, margin=1e5, **options), kalman(PAPER, dt=DT, **options)
    assert a.states == b.states and a.outputs == b.outputs
    np.testing.assert_allclose(a.B, b.B, rtol=1e-5, atol=1e-9)
    assert not np.allclose(h_infinity(PAPER, dt=DT, margin=1.05, **options).B, b.B, rtol=0.1, atol=1e-9)


def test_a_wrong_load_inertia_hurts_it_less():
    rng = np.random.default_rng(3)
    recording = simulate(PAPER, dt=DT, torque_motor=5.0 + 10.0 * rng.normal(size=20_000))
    wrong = PAPER.with_parameters(inertia_load=0.8 * PAPER.inertia_load)

    def error(law):
        found = law.run(recording)["speed_load_estimated"] - recording["speed_load"]
        return float(np.sqrt(np.mean(found[3000:] ** 2)))

    assert error(h_infinity(wrong, dt=DT)) < 0.8 * error(kalman(wrong, dt=DT))


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"margin": 1.0}, "margin"),
        ({"margin": float("nan")}, "margin"),
        ({"weights": {"speed": 1.0}}, "weights"),
        ({"weights": {"twist": -1.0}}, "weights"),
        ({"weights": {}}, "weights"),
        ({"measured": ("speed",)}, "measured"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        h_infinity(PAPER, dt=DT, **arguments)


def test_sensors_that_cannot_see_the_rotation():
    with pytest.raises(InvalidInput, match="detectable"):
        h_infinity(PAPER.with_parameters(viscous=0.0), measured=("twist",), dt=DT)
