"""Where descents begin, from the nameplate and the frequency response."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import replace

import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.starts.from_drivetrain import (
    frictions,
    lag_and_delay,
    response_start,
    start_values,
)


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


@pytest.mark.parametrize("both, lag, delay", [(4.0, 2.0, 2.0), (-0.5, 0.05, -0.55), (-7.0, 0.05, -1.0)])
def test_lag_and_delay_share_what_the_response_shows(both: float, lag: float, delay: float):
    """In samples; a measured torque may be ahead by one at most."""
    assert lag_and_delay(both * 1e-3, 1e-3) == pytest.approx({"lag": lag * 1e-3, "delay": delay * 1e-3})


@pytest.mark.parametrize("fixed", [(), ("lag", "stiffness")], ids=["free", "fixed"])
def test_a_start_has_the_lag_and_the_mode_of_the_frequency_response(
    flt: ContactFilter, plant: lm.Drivetrain, fixed: Collection[str]
):
    """Whatever the nameplate says of them, but for what is fixed."""
    nameplate = plant.with_parameters(inertia_motor=0.05, stiffness=2000.0, lag=5e-3)
    values = dict(zip(INDEX, flt.values(response_start(flt, nameplate, fixed)), strict=True))
    if fixed:
        assert (values["lag"], values["delay"]) == pytest.approx((5e-3, 0.0))
        assert values["stiffness"] == pytest.approx(2000.0)
    else:
        # The exact lag is 3e-4 s, a sample and a half.
        assert values["lag"] + values["delay"] == pytest.approx(3e-4, abs=0.5 * flt.dt)
        # The gap makes the spring softer than it is, and the nameplate's is a third of it.
        assert 2000.0 < values["stiffness"] < 7000.0
    assert values["inertia_motor"] == pytest.approx(plant.inertia_motor, rel=0.3)
