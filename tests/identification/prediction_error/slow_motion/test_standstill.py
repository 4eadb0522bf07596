"""A standstill is slow for long; a drive that turns back is slow as well, but not for long."""

from __future__ import annotations

import numpy as np

from lostmotion.identification.prediction_error.slow_motion.standstill import standstill


def test_slow_for_long_is_a_standstill():
    slow = np.array([1, 0, 1, 1, 0, 1, 1, 1, 1], dtype=bool)
    assert np.array_equal(np.flatnonzero(standstill(slow, 3)), [5, 6, 7, 8])
    assert np.array_equal(np.flatnonzero(standstill(slow, 2)), [2, 3, 5, 6, 7, 8])
    assert np.array_equal(standstill(slow, 1), slow)
    assert not np.any(standstill(slow, 5)) and not np.any(standstill(~np.ones(9, dtype=bool), 1))
