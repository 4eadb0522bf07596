"""Whether differences have one sign."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.statistics.permuted_signs import chance_of


def test_the_chance_of_signs():
    assert chance_of(np.ones(4)) == chance_of(np.array([3.0, 1.0, 2.0, 0.5])) == pytest.approx(1 / 16)
    assert chance_of(np.array([1.0, -1.0])) == pytest.approx(0.75)
