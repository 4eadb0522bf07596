"""The parameter vector of the contact-switching filter."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import (
    INDEX,
    PARAMETERS,
    pole_of,
)


def test_values_survive_the_parameter_vector(flt: ContactFilter):
    some = {name: 0.1 * (i + 1.0) for i, name in enumerate(PARAMETERS)}
    assert flt.values(flt.theta(some)) == pytest.approx(list(some.values()))


def test_what_is_not_there_is_none_and_no_lag_below_zero(flt: ContactFilter):
    theta = flt.theta({"lag": 0.0, "inertia_motor": 1.0, "inertia_load": 1.0, "stiffness": 2.0})
    assert theta[INDEX["backlash"]] == -np.inf and flt.values(theta)[INDEX["backlash"]] == 0.0
    theta[INDEX["lag"]] -= 1.0
    assert flt.values(theta)[INDEX["lag"]] == 0.0
    assert pole_of(theta) == pytest.approx(2.0 / (2.0 * np.pi))
