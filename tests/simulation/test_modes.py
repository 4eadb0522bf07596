"""Tables of a mode: exponential, bounds of the enclosure, segments of a friction curve."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plants import TABLE_I
from scipy.linalg import expm

from lostmotion.drivetrain import CONTACT_LAWS, Drivetrain, Friction
from lostmotion.simulation.modes import (
    Layout,
    build_mode,
    delta_over,
    doubled,
    elements,
    friction_segment,
    taylor_terms,
)
from lostmotion.simulation.tables import Plant

DT = 1e-4


def test_exponential_of_a_known_matrix():
    a = np.array([[0.0, 1.0], [-4.0, 0.0]], dtype=np.longdouble)
    for time, halvings in ((1e-6, 0), (0.1, 0), (0.1, 3), (0.12, 8)):
        terms, order = taylor_terms(a, time, 4.0)
        assert 4 <= order < len(terms)
        got = doubled(delta_over(terms, 1.0), halvings)
        t = time * 2**halvings
        c, s = math.cos(2 * t), math.sin(2 * t)
        np.testing.assert_allclose(got.astype(float), [[c - 1, s / 2], [-2 * s, c - 1]], rtol=0, atol=4e-15)


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_delta_of_every_mode_is_the_exponential_of_its_rate(contact):
    plant = Drivetrain.two_mass(**TABLE_I, contact=contact, lag=1e-3)
    layout = Layout(plant, ("torque_motor",))
    parts = elements(plant)
    for digits in np.ndindex(*(e.digits for e in parts)):
        mode = build_mode(layout, parts, digits, DT)
        full = np.zeros((layout.columns, layout.columns))
        full[: layout.states] = mode.rate
        expected = expm(full * DT)[: layout.states] - np.eye(layout.columns)[: layout.states]
        scale = np.abs(expected).max(axis=1, keepdims=True)
        assert np.all(np.abs(mode.delta - expected) <= 1e-12 * scale)


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_bounds_of_the_enclosure_hold(contact):
    """Swing and remainder bound the guard's second and fourth derivative at every time within a sample."""
    plant = Drivetrain.two_mass(**TABLE_I, contact=contact)
    layout = Layout(plant, ("torque_motor",))
    parts = elements(plant)
    rng = np.random.default_rng(0)
    for digits in np.ndindex(*(e.digits for e in parts)):
        mode = build_mode(layout, parts, digits, DT)
        full = np.zeros((layout.columns, layout.columns))
        full[: layout.states] = mode.rate
        second = mode.guard @ full @ full
        fourth = second @ full @ full
        largest = np.zeros((2, len(parts)))
        s = np.append(rng.uniform(-1, 1, layout.columns - 1) * 10.0, 1.0)
        for t in np.linspace(0.0, DT, 13):
            at = expm(full * t) @ s
            largest = np.maximum(largest, np.abs([second @ at, fourth @ at]))
        assert np.all(mode.swing @ np.abs(s) >= 0.5 * DT**2 * largest[0] * (1 - 1e-12))
        assert np.all(mode.remainder @ np.abs(s) >= DT**4 / 384 * largest[1] * (1 - 1e-12))


def test_segments_join_to_the_friction_curve():
    friction = Friction((0.5, 0.3), stribeck=((0.0, 0.4), (1.0, 0.1), (3.0, 0.0)))
    for digit in (0, 1, 2, 4, 5, 6):
        constant, slope, low, high = friction_segment(friction, digit, 3)
        for speed in np.linspace(max(low, -9.0), min(high, 9.0), 7)[1:-1]:
            assert constant + slope * speed == pytest.approx(friction.torque(speed), abs=1e-15)


def test_modes_are_built_when_entered():
    plant = Plant(Drivetrain.two_mass(**TABLE_I), DT, ("torque_motor",))
    assert len(plant.modes) == 0
    plant.enter((1, 2))
    plant.enter((1, 2))
    assert len(plant.modes) == 1
    assert np.count_nonzero(plant.row_of_mode >= 0) == 1
    assert plant.digits_of(int(np.flatnonzero(plant.row_of_mode >= 0)[0])) == (1, 2)
