"""The verdicts of a law's check on samples, one by one; that they do in laws what they should: tests/contracts."""

from __future__ import annotations

import ctypes

import numpy as np

from lostmotion.kernels.estimators.verdicts import FROZEN, JUMP, MISSING, START_AGAIN, USE
from lostmotion.kernels.law.input_check import CHECK_MEMORY, LASTS, check
from lostmotion.systems import InputCheck

HOLD = 10
CHECK = InputCheck("speed_motor", limit=1.0, hold=HOLD, forget=0.99)


class Checked:
    """A check whose prediction is zero, after a while of good samples."""

    def __init__(self) -> None:
        self.memory = np.array(CHECK.start())
        for k in range(5 * HOLD):
            self.verdict(0.1 * (-1) ** k)

    def verdict(self, given: float, predicted: float = 0.0) -> int:
        pointer = self.memory.ctypes.data_as(ctypes.POINTER(ctypes.c_double))
        return check.ctypes(pointer, given, predicted, CHECK.limit, CHECK.hold, CHECK.forget, 0)

    def __getitem__(self, name: str) -> float:
        return float(self.memory.view(CHECK_MEMORY)[0][name])


def test_a_good_sample_is_used():
    checked = Checked()
    assert checked.verdict(0.15) == USE
    assert (checked["value"], checked["refused"]) == (0.15, 0.0)


def test_missing_samples_for_the_hold_time_and_beyond():
    checked = Checked()
    assert [checked.verdict(value) for value in (np.nan, np.inf, -1e31)] == [MISSING] * 3
    assert [checked.verdict(np.nan) for _ in range(2 * HOLD)] == [MISSING] * 2 * HOLD


def test_a_jump_is_refused_until_the_hold_time_is_over():
    checked, shown = Checked(), 5.0 + 0.1 * (-1.0) ** np.arange(2 * HOLD)
    verdicts = [checked.verdict(value) for value in shown]
    assert verdicts == [JUMP] * HOLD + [USE] * HOLD


def test_a_frozen_sample_is_refused_longer_then_used_and_flagged():
    checked, drift = Checked(), np.linspace(0.0, 50.0, 8 * HOLD)
    verdicts = [checked.verdict(0.1, predicted) for predicted in drift]
    refused = [v for v in verdicts if v in (FROZEN, JUMP)]
    assert FROZEN in refused and set(verdicts[len(refused) + 5 :]) == {START_AGAIN}
    assert (1.0 + LASTS) * HOLD - 1 <= len(refused) <= (1.0 + LASTS) * HOLD + 1


def test_without_a_prediction_a_finite_sample_is_used():
    assert Checked().verdict(1e6, np.nan) == USE
