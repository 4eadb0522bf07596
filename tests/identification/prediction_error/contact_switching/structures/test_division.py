"""Which values a gap in another shaft would change, and by how much."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.structures.division import (
    LOAD,
    MOTOR,
    STIFFNESS,
    UNSEEN,
    room_for_division,
)

#: Motor, load: those of ``conftest.TWO_MASSES``.
M, L = 0.05, 0.08


@pytest.fixture
def room(recorded: Callable[..., ContactFilter], two_masses: dict[str, float]) -> Callable[..., np.ndarray]:
    """(motor, load, stiffness), without the joint that is not seen."""

    def of(widest: float = np.inf, behind: bool = False, fourth_behind: bool = False, **further: float):
        flt = replace(recorded(False), behind=behind, fourth_behind=fourth_behind)

        def squares(values: dict[str, float]) -> np.ndarray:
            one = Candidate("one", flt.theta(values), 0.0, flt, [])
            return room_for_division(one, widest) ** 2

        chain = two_masses | {"compliance": 0.3, "loss": 1.0} | further
        both = squares(chain) - squares(two_masses) if further else squares(two_masses)
        assert not np.any(np.delete(both, [MOTOR, LOAD, STIFFNESS]))
        return np.sqrt(np.maximum(both[[MOTOR, LOAD, STIFFNESS]], 0.0))

    return of


def test_of_two_masses_a_small_joint_may_be_hidden(room):
    motor, load = np.log1p(-UNSEEN), np.log1p(UNSEEN * M / L)
    assert room() == pytest.approx(np.abs([motor, load, motor + load]))


def test_a_joint_may_be_on_either_side(room):
    before = np.log([0.9, (L + 0.1 * M) / L])
    assert room(share=0.1) == pytest.approx(np.abs([*before, before.sum()]))
    behind = np.log([(M + 0.1 * L) / M, 0.9])
    assert room(share=0.1, behind=True) == pytest.approx(np.abs([*behind, behind.sum()]))


def test_the_largest_change_of_all_shafts_counts(room):
    further = {"share_fourth": 0.5, "compliance_fourth": 0.3, "loss_fourth": 1.0}
    # The fourth is half of the third, next to the gap: the outer shaft moves both.
    assert room(share=0.1, **further) == pytest.approx(room(share=0.1))
    third, fourth = np.log([0.9, (L + 0.1 * M) / L]), np.log([(M + 0.5 * L) / M, 0.5])
    expected = [np.abs(fourth[0]), np.abs(fourth[1]), max(abs(third.sum()), abs(fourth.sum()))]
    assert room(share=0.1, fourth_behind=True, **further) == pytest.approx(expected)


def test_what_changes_a_value_too_much_is_no_joint(room):
    assert room(0.2, share=0.1)[0] == pytest.approx(-np.log(0.9))
    assert not np.any(room(0.2, share=0.3))
    further = {"share_fourth": 0.2, "compliance_fourth": 0.3, "loss_fourth": 1.0}
    assert room(0.2, share=0.3, **further)[0] == pytest.approx(-np.log1p(-0.06))
