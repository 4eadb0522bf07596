"""The torque's ramp: its two rates, the mirror image, misuse."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import torque_ramp
from lostmotion.errors import InvalidInput

DT = 1e-4


def ramp(reference: np.ndarray) -> np.ndarray:
    return torque_ramp(unwinding_rate=4000.0, winding_rate=20000.0, dt=DT).run(
        {"torque_reference": reference}
    )["torque_ramp"]


def test_a_tip_in_unwinds_slowly_and_winds_up_fast():
    torque = ramp(np.repeat([-10.0, 20.0], 100))[100:]
    steps = np.diff(torque)
    falling, rising = torque[:-1] < -1e-9, (torque[:-1] > 0.4) & (torque[1:] < 20.0)
    assert np.allclose(steps[falling], 0.4) and np.allclose(steps[rising], 2.0) and rising.sum() > 5
    assert np.all(steps > -1e-12) and torque[-1] == 20.0


def test_it_is_its_own_mirror_image_and_never_beyond_the_set_point():
    reference = 30.0 * np.random.default_rng(3).standard_normal(40).repeat(20)
    torque = ramp(reference)
    np.testing.assert_allclose(ramp(-reference), -torque, atol=1e-12)
    last = np.concatenate([[0.0], torque[:-1]])
    assert np.all(torque >= np.minimum(last, reference) - 1e-12)
    assert np.all(torque <= np.maximum(last, reference) + 1e-12)
    assert np.max(np.abs(np.diff(torque))) <= 2.0 + 1e-12


@pytest.mark.parametrize(("unwinding", "winding"), [(0.0, 1.0), (2.0, 1.0), (1.0, np.inf)])
def test_misuse(unwinding, winding):
    with pytest.raises(InvalidInput, match="torque_ramp"):
        torque_ramp(unwinding_rate=unwinding, winding_rate=winding, dt=DT)
