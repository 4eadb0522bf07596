"""Describing functions against their formulas, and what they expect against exact orbits."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import harmonic_balance, limit_cycle, limit_cycle_map
from lostmotion.certificates.limit_cycles.describing_functions import CurveValues, describing_function
from lostmotion.certificates.static_curves import StaticCurve
from lostmotion.errors import InvalidInput

#: 3.2 ms of delay: the loop is unstable.
DT, DELAY = 4e-4, 8
ONE = Fraction(1)
SATURATION = CurveValues.of(StaticCurve(((-ONE, -ONE), (ONE, ONE))))
RELAY = CurveValues.of(StaticCurve(((Fraction(0), -ONE), (Fraction(0), ONE))))


@pytest.mark.parametrize("amplitude", [0.5, 1.2, 3.0, 20.0])
def test_of_saturation_and_relay_they_are_those_of_the_textbook(amplitude: float) -> None:
    x = min(1.0, 1.0 / amplitude)
    formula = 2.0 / math.pi * (math.asin(x) + x * math.sqrt(1.0 - x * x))
    mean, gain, of_mean = describing_function(SATURATION, 0.0, amplitude)
    assert mean == pytest.approx(0.0, abs=1e-12) and gain == pytest.approx(formula, rel=5e-3)
    # The share of the period in the linear part.
    assert of_mean == pytest.approx(2.0 / math.pi * math.asin(x), rel=0.03)
    assert describing_function(RELAY, 0.0, amplitude)[1] == pytest.approx(
        4.0 / (math.pi * amplitude), rel=5e-3
    )


def test_of_a_relay_on_a_mean() -> None:
    # Mean B, amplitude A > B: output mean 2/π·asin(B/A), gain 4/(πA)·√(1 − (B/A)²).
    mean, gain, _ = describing_function(RELAY, 0.5, 1.0)
    assert mean == pytest.approx(2.0 / math.pi * math.asin(0.5), abs=0.01)
    assert gain == pytest.approx(4.0 / math.pi * math.sqrt(0.75), rel=0.01)


def limited() -> tuple[lm.Drivetrain, lm.DiscreteSystem]:
    plant = lm.Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.0, "coulomb": 0.0})
    return plant, lm.controllers.pi(dt=DT, torque_limit=20.0)


def test_a_limited_torque_with_too_long_a_delay_swings_as_expected() -> None:
    plant, law = limited()
    (expected,) = harmonic_balance(plant, law, reference=2.0, delay=DELAY).expected
    orbit = limit_cycle(plant, law, reference=2.0, delay=DELAY, settle=3.0)
    assert orbit is not None and expected.is_stable
    assert expected.frequency == pytest.approx(orbit.frequency, rel=0.01)
    assert expected.amplitude == pytest.approx(0.5 * orbit.swing("speed_load"), rel=0.05)
    assert harmonic_balance(plant, law, reference=2.0, delay=2).expected == ()


def test_stribeck_friction_is_expected_to_swing_where_it_does() -> None:
    friction = lm.Friction(2.0, 0.0175, stribeck=((0.0, 1.0), (0.1, 0.0)))
    plant = replace(lm.Drivetrain.two_mass(**TABLE_I), frictions=(lm.Friction(), friction))
    (expected,) = harmonic_balance(plant, lm.controllers.pi(dt=1e-4), reference=0.02).expected
    # The exact orbit: 6.38 Hz, 0.022 rad/s.
    assert expected.frequency == pytest.approx(6.38, rel=0.05)
    assert expected.amplitude == pytest.approx(0.022, rel=0.15)
    plain = lm.Drivetrain.two_mass(**TABLE_I)
    assert harmonic_balance(plain, lm.controllers.pi(dt=1e-4), reference=0.02).expected == ()


def test_a_map_tells_rest_from_swinging() -> None:
    plant, _ = limited()

    def build(limit: float, kp: float) -> tuple[lm.Drivetrain, lm.DiscreteSystem, float]:
        return plant, lm.controllers.pi(dt=DT, kp=kp, ki=10.0 * kp, torque_limit=limit), 2.0

    found = limit_cycle_map(
        build, ("limit", "Nm"), (20.0, 40.0), ("gain", "Nm s/rad"), (0.5, 10.0), delay=DELAY, settle=3.0
    )
    assert found.swing.shape == (2, 2) and (found.swing[0] == 0.0).all() and (found.swing[1] > 1.0).all()
    # A limit twice as high lets it swing twice as far, at the same frequency.
    assert found.swing[1, 1] == pytest.approx(2.0 * found.swing[1, 0], rel=0.02)
    assert found.frequency[1, 1] == pytest.approx(found.frequency[1, 0], rel=0.01)
    assert found.expected.tolist() == [[False, False], [True, True]]
    with pytest.raises(InvalidInput, match="limit_cycle_map"):
        limit_cycle_map(build, ("limit", "Nm"), (), ("gain", ""), (1.0,))
