"""What a candidate tells of a drivetrain."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.told import lag, told_slopes, told_vector

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
