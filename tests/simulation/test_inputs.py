"""What ``simulate`` refuses: text, NaN, sizes that nothing has; each named with its sample."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import lostmotion as lm

PLANT = lm.Drivetrain.two_mass(inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, backlash=0.012)
ONES = np.ones(20)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"torque_motor": np.full(20, 1e300)}, r"torque_motor: got 1e\+300 in sample 0, .* at most 1e\+30"),
        ({"torque_load": np.append(ONES[1:], -1e31)}, r"torque_load: got -1e\+31 in sample 19"),
        ({"torque_motor": "text"}, "torque_motor: got 'text', expected numbers"),
        ({"torque_motor": ["1.0"] * 20}, "torque_motor: got"),
        ({"torque_motor": [1, 10**400]}, "torque_motor: got"),
        ({"torque_motor": [[1, 2], [3]]}, "torque_motor: got"),
        ({"torque_motor": ONES * 1j}, "torque_motor: got"),
        ({"torque_motor": {"a": 1}}, "torque_motor: got {'a': 1}"),
        ({"torque_motor": [1.0, None]}, "torque_motor: got"),
        ({"torque_motor": 3.0}, r"shape \(\)"),
        ({"dt": "x"}, r"simulate\.dt: got 'x', expected a finite number"),
        ({"dt": None}, r"simulate\.dt: got None"),
        (
            {"dt": 1e10},
            r"simulate\.dt: got 10000000000.0, expected a positive sample time in s, of at most 100 s",
        ),
        ({"dt": 1e300}, r"simulate\.dt: got 1e\+300, expected a finite number"),
        ({"dt": 10**400}, r"simulate\.dt: got"),
        ({"dt": 0.0}, r"simulate\.dt: got 0\.0"),
        ({"state": (0.0, 1e40, 0.0)}, r"simulate\.state\[1\]: got 1e\+40, expected at most 1e\+30"),
        ({"state": (0.0, 1e300, 0.0)}, r"simulate\.state\[1\]: got 1e\+300, expected a finite number"),
        ({"state": "abc"}, r"simulate\.state: got 'abc'"),
        ({"state": (0, "x", 0)}, r"simulate\.state\[1\]: got 'x'"),
        ({"state": 5}, r"simulate\.state: got 5"),
        ({"state": {"state": (1e300, 0, 0)}}, r"simulate\.state\[0\]: got 1e\+300"),
        ({"seed": "x"}, r"simulate\.seed: got 'x', expected a whole number"),
        ({"seed": 1.5}, r"simulate\.seed: got 1\.5"),
    ],
)
def test_what_is_no_number_of_a_possible_size_is_named(change: dict[str, Any], words: str) -> None:
    with pytest.raises(lm.InvalidInput, match=words):
        lm.simulate(PLANT, **{"dt": 1e-4, "torque_motor": ONES, **change})


def test_large_but_possible_sizes_and_whole_numbers_are_taken() -> None:
    large = lm.simulate(PLANT, dt=1e-4, torque_motor=np.full(20, 1e30))
    assert np.all(np.isfinite(large["speed_load"]))
    whole = lm.simulate(PLANT, dt=1e-4, torque_motor=[1] * 20, state=np.array([0, 0, 0]), seed=np.int64(3))
    assert np.array_equal(whole["speed_motor"], lm.simulate(PLANT, dt=1e-4, torque_motor=ONES)["speed_motor"])
