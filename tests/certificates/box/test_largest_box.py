"""The search for the largest tolerance: what is proved, what is just wider, and that its time is kept."""

from __future__ import annotations

import time

import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import continuous_pi, largest_box, verdict
from lostmotion.errors import InvalidInput


def test_it_ends_between_a_proved_and_an_unproved_tolerance() -> None:
    """A large gain on a small motor inertia: sampled, the loop is not stable with much less of it."""
    law = lm.controllers.pi(dt=1e-4, kp=170.0)
    found = largest_box(PAPER, law, ("inertia_motor",), speed=20.0, workers=1)
    assert found.proof is not None and verdict(found.proof.certificate) is None
    assert found.proof.box == {"inertia_motor": pytest.approx((1 - found.half_width, 1 + found.half_width))}
    narrowest = min(attempt.half_width for attempt in found.attempts if not attempt.proved)
    assert 0.0 < found.half_width < narrowest <= found.half_width + 0.021


def test_nothing_is_claimed_when_the_time_is_over() -> None:
    start = time.monotonic()
    found = largest_box(PAPER, continuous_pi(), seconds=1e-6, workers=1)
    assert time.monotonic() - start < 5.0
    assert found.proof is None and found.half_width == 0.0
    assert {attempt.reason for attempt in found.attempts} <= {"it took too long"}


def test_no_time_is_refused() -> None:
    with pytest.raises(InvalidInput, match="seconds"):
        largest_box(PAPER, continuous_pi(), seconds=0.0)
