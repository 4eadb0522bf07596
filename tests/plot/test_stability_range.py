"""The bars of what is proved: where they begin and end, and what they say."""

from __future__ import annotations

import pytest
from matplotlib.patches import Rectangle

from lostmotion.errors import InvalidInput
from lostmotion.plot import stability_range

PROVED = {"proved": True, "speed_from": 0.315, "speed_to": 1000.0, "step": 0.5, "torque_load": [-36.8, -25.7]}
NOT_PROVED = {
    "proved": False,
    "speed_from": None,
    "speed_to": 1000.0,
    "step": None,
    "torque_load": [0.0, 0.0],
}


def test_the_bar_covers_what_is_proved_and_the_hatching_the_rest() -> None:
    (axis,) = stability_range({"nominal": PROVED, "±10 %": NOT_PROVED}).axes
    bars = [patch for patch in axis.patches if isinstance(patch, Rectangle)]
    spans = [(bar.get_x(), bar.get_x() + bar.get_width(), bar.get_hatch() is not None) for bar in bars]
    assert spans == [
        pytest.approx((1e-3, 0.315, True)), pytest.approx((0.315, 1000.0, False)), pytest.approx((1e-3, 1000.0, True)),
    ]  # fmt: skip
    said = [text.get_text() for text in axis.texts]
    assert said == ["from 0.315 rad/s\nafter steps to 0.5 rad/s\nagainst 25.7 to 36.8 Nm", "not proved"]
    assert [label.get_text() for label in axis.get_yticklabels()] == ["nominal", "±10 %"]


def test_what_is_no_proof_is_refused() -> None:
    for wrong in ({}, {"a": {"skipped": "no drivetrain"}}):
        with pytest.raises(InvalidInput, match="proofs"):
            stability_range(wrong)
