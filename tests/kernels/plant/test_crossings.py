"""The kernel's two decisions: whether a guard may be crossed in a sample, and when it is crossed first."""

from __future__ import annotations

import numpy as np
import pytest
from numba import njit

import lostmotion as lm
from lostmotion.drivetrain import Drivetrain
from lostmotion.kernels.numerics.vectors import LANES
from lostmotion.kernels.plant.crossings import first_crossing
from lostmotion.kernels.plant.entered import enter as enter_one
from lostmotion.kernels.plant.layout import MAX_ORDER
from lostmotion.simulation.tables import Plant


def polynomial(*coefficients: float) -> np.ndarray:
    return np.array([*coefficients, *[0.0] * (MAX_ORDER + 1 - len(coefficients))])


@njit
def _crossing(p, order, sign, bound, until, bend, tolerance):
    return first_crossing(p, order, sign, bound, until, bend, tolerance)


def first(p: np.ndarray, sign: float, bound: float, until: float = 1.0) -> float:
    tolerance = 4.5e-16 * np.abs(p).sum()
    bend = float(np.arange(2, p.size) @ np.abs(p[2:]))
    return _crossing(p.ctypes.data, MAX_ORDER, sign, bound, until, bend, tolerance)


def test_crossing_of_a_line():
    assert first(polynomial(1.0, -2.0), 1.0, 0.0) == pytest.approx(0.5, abs=1e-15)
    assert first(polynomial(1.0, -2.0), 1.0, 0.0, until=0.4) == 2.0
    assert first(polynomial(-1.0, 2.0), -1.0, 0.5) == pytest.approx(0.75, abs=1e-15)


def test_no_crossing():
    assert first(polynomial(1.0, -0.5), 1.0, 0.0) == 2.0
    assert first(polynomial(0.0, 1.0), 1.0, 0.0) == 2.0


def test_double_crossing_within_the_piece_is_seen():
    """(t − 0.5)² − ε dips below zero for 2√ε only."""
    for gap in (1e-2, 1e-6, 1e-10, 1e-13):
        at = first(polynomial(0.25 - gap, -1.0, 1.0), 1.0, 0.0)
        assert at == pytest.approx(0.5 - np.sqrt(gap), abs=1e-8)
    assert first(polynomial(0.25 + 1e-14, -1.0, 1.0), 1.0, 0.0) == 2.0


def test_first_of_random_polynomials():
    """Against all roots of numpy; only crossings downwards count."""
    rng = np.random.default_rng(0)
    found = 0
    for _ in range(2000):
        p = rng.standard_normal(6) * 3.0 ** -np.arange(6)
        p[0] = abs(p[0])
        roots = np.roots(p[::-1])
        real = np.sort(roots[np.abs(roots.imag) < 1e-9].real)
        inside = real[(real > 0.0) & (real < 1.0)]
        at = first(polynomial(*p), 1.0, 0.0)
        if inside.size == 0:
            assert at == 2.0
        else:
            found += 1
            assert at == pytest.approx(inside[0], abs=1e-9)
    assert found > 150


@pytest.mark.parametrize("rows", [slice(-2 * LANES, -LANES), slice(-LANES, None)], ids=["swing", "remainder"])
def test_swing_and_remainder_decide(monkeypatch, rows):
    """One whole period of the contact in one sample: both ends look alike, and the cubic between them is flat.

    The twist above the edge is m − a + a·cos(ωt) with ωT = 2π and m = 1.5 a: it dips below the edge between two
    samples. That is told by the swing alone, and then by the remainder of the Hermite interpolation alone.
    """
    period, a = 0.01, 1e-4
    stiffness = (2.0 * np.pi / period) ** 2
    plant = Drivetrain.two_mass(inertia_motor=1.0, inertia_load=1e12, stiffness=stiffness, backlash=0.02)
    arguments = dict(
        torque_motor=np.full(3, 0.5 * a * stiffness), dt=period, state=(0.01 + 1.5 * a, 0.0, 0.0)
    )
    events = lm.simulate(plant, **arguments).events
    assert events[0].kind == "separation"
    assert events[0].time == pytest.approx(period / 3.0, rel=1e-9)

    enter = Plant.entered

    def without(self):
        """All contact states entered beforehand, and the rows struck out."""
        found = enter(self)
        for digit in range(3):
            enter_one(found, np.array([digit]))
        for mode in self.modes:
            mode.table[:, rows] = 0.0
        return found

    monkeypatch.setattr(Plant, "entered", without)
    assert lm.simulate(plant, **arguments).events == ()
