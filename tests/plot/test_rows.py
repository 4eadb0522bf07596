"""Rows of different lengths: an error of the package that names them, from every figure that takes rows."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from lostmotion import plot
from lostmotion.errors import InvalidInput
from lostmotion.plot.rows import rows_of_one_length

LONG, SHORT = np.linspace(0.0, 1.0, 20), np.linspace(0.0, 1.0, 3)
FIGURES: dict[str, Callable[[], object]] = {
    "backlash_locked": lambda: plot.backlash_locked(LONG, SHORT, LONG),
    "backlash_lost_motion": lambda: plot.backlash_lost_motion(LONG, SHORT, LONG, LONG),
    "coherence": lambda: plot.coherence({"a": (LONG, SHORT)}),
    "friction_curve": lambda: plot.friction_curve(LONG, SHORT, LONG, LONG > 0.5, np.abs),
    "friction_fit": lambda: plot.friction_fit(LONG, LONG, SHORT, LONG),
    "mode_shapes": lambda: plot.mode_shapes([1.0, 2.0], np.ones((3, 3)), ["a"]),
    "quantile_bands": lambda: plot.quantile_bands(LONG, {"twist": SHORT}),
    "ring_down_fit": lambda: plot.ring_down_fit([(LONG, SHORT, LONG)]),
    "no window": lambda: plot.ring_down_fit([]),
    "sensor_worth": lambda: plot.sensor_worth([1.0], {"a": []}, {}),
    "stiffness_fit": lambda: plot.stiffness_fit(LONG, SHORT, LONG),
    "leaderboard": lambda: plot.leaderboard({}),
    "identified_parameters": lambda: plot.identified_parameters({"stiffness": 3.0}),
    "no parameter": lambda: plot.identified_parameters({}),
    "no response": lambda: plot.bode({}),
    "period": lambda: plot.loop_timing([1e-5] * 5, period=-1.0),
}


@pytest.mark.parametrize("name", FIGURES)
def test_rows_that_do_not_fit_are_refused(name: str) -> None:
    with pytest.raises(InvalidInput):
        FIGURES[name]()


def test_the_odd_row_is_named() -> None:
    with pytest.raises(InvalidInput, match=r"a of shape \(20,\), b of shape \(3,\)"):
        rows_of_one_length("some", a=LONG, b=SHORT, c=None)
    assert len(rows_of_one_length("some", a=LONG, c=None)) == 1
