"""Parameter vectors and what is told of them."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import INDEX, ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.starts import (
    frictions,
    lag,
    start_values,
    told_slopes,
    told_vector,
)

FREE = ("inertia_motor", "lag", "delay")


@pytest.mark.parametrize("delay", [0.5, -0.9], ids=["behind", "ahead"])
def test_lag_and_delay_are_told_as_a_sum(flt: ContactFilter, values: dict[str, float], delay: float):
    """A measured torque may be ahead of that which acts: told is none, known as well as the sum."""
    theta = flt.theta(values | {"lag": 0.2 * flt.dt, "delay": delay * flt.dt})
    one = Candidate("truth", theta, 0.0, flt, sorted(INDEX[name] for name in FREE))
    total = max(0.2 + delay, 0.0) * flt.dt
    assert lag(one) == pytest.approx(total, abs=1e-12)
    assert told_vector(one)[-1] == pytest.approx(np.log(total + flt.dt))
    slopes = told_slopes(one)[-1]
    # θ has the logarithm of lag + sample time, and the delay in samples.
    expected = {"inertia_motor": 0.0, "lag": 1.2 * flt.dt, "delay": flt.dt}
    for place, slope in zip(one.free, slopes, strict=True):
        name = next(name for name in FREE if INDEX[name] == place)
        assert slope == pytest.approx(expected[name] / (total + flt.dt), rel=1e-4, abs=1e-9), name


@pytest.mark.parametrize(
    "motor, fixed, expected",
    [
        (0.0, (), (0.7 * 3.0, 0.3 * 3.0)),
        (1.0, (), (2.0, 1.0)),
        (5.0, (), (0.1 * 3.0, 5.0)),
        (0.0, ("coulomb",), (2.0, 0.0)),
        (1.0, ("coulomb",), (2.0, 1.0)),
    ],
    ids=["either end", "motor's given", "motor's too large", "load's fixed", "both given"],
)
def test_a_start_has_the_friction_of_the_slow_motion(
    flt: ContactFilter,
    plant: lm.Drivetrain,
    motor: float,
    fixed: Collection[str],
    expected: tuple[float, float],
):
    """Not the nameplate's, which may be off by far; but that of the motor if it is given, and what is fixed."""
    start, flt = plant.with_parameters(coulomb_motor=motor), replace(flt, units=(1.0, 3.0, 0.5))
    given = frictions(flt, start, fixed)
    assert (given["coulomb"], given["coulomb_motor"]) == pytest.approx(expected)
    assert given["viscous"] + given["viscous_motor"] == pytest.approx(0.5)
    values = start_values(flt, plant.with_parameters(coulomb=9.0), start, fixed)
    assert {name: values[name] for name in given} == given
