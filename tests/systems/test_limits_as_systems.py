"""Minimum, maximum and rate limit: the very numbers of numpy, and the ramp."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.errors import InvalidInput
from lostmotion.systems import connect, maximum, minimum, rate_limit

DT = 1e-3


@pytest.mark.parametrize("law, wanted", [(minimum, np.minimum), (maximum, np.maximum)])
def test_of_two_signals(law, wanted):
    rng = np.random.default_rng(1)
    a, b = 50.0 * rng.normal(size=(2, 500))
    b[::7] = a[::7]
    found = law("a", "b", "c", DT).run({"a": a, "b": b})["c"]
    np.testing.assert_allclose(found, wanted(a, b), rtol=0.0, atol=2e-14)


def test_of_whole_numbers_they_are_exact():
    a, b = np.random.default_rng(2).integers(-100, 100, size=(2, 500)).astype(float)
    law = connect([maximum("a", "b", "c", DT), minimum("c", "b", "d", DT)], inputs=("a", "b"), outputs=("d",))
    np.testing.assert_array_equal(law.run({"a": a, "b": b})["d"], b)


def test_a_step_becomes_a_ramp_and_slow_signals_pass():
    law = rate_limit("u", "y", rate=100.0, dt=DT, start=1.0)
    steps = law.run({"u": [2.0] * 12 + [-2.0] * 5})["y"]
    np.testing.assert_allclose(steps[:12], np.minimum(1.0 + 0.1 * np.arange(1, 13), 2.0), atol=1e-14)
    np.testing.assert_allclose(np.diff(steps[11:]), -0.1, atol=1e-14)
    slow = np.sin(np.linspace(0.0, 3.0, 2000))
    np.testing.assert_allclose(
        rate_limit("u", "y", rate=100.0, dt=DT).run({"u": slow})["y"], slow, atol=1e-15
    )


@pytest.mark.parametrize("rate", [0.0, -1.0, np.inf, np.nan])
def test_a_rate_that_is_none(rate):
    with pytest.raises(InvalidInput, match=r"rate_limit\.rate"):
        rate_limit("u", "y", rate=rate, dt=DT)
