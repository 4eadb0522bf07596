"""Checked inputs as data: what a law refuses, what connect and files do with them."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from lostmotion.curves import saturation
from lostmotion.errors import InvalidInput
from lostmotion.systems import DiscreteSystem, InputCheck, connect, one_sample_delay

CHECK = InputCheck("y", limit=1.0, hold=3, forget=0.9)


def tracker(name="tracker", output="estimate", curve=False):
    """x⁺ = x + 0.5 (y − x) + u, with x (or what a curve makes of it) expected for y."""
    expected = {"R": [[1.0]], "F": [[1.0]], "curves": (saturation(10.0),)} if curve else {"P": [[1.0]]}
    return DiscreteSystem(
        inputs=("u", "y"), outputs=(output,), states=("x",), dt=0.1, A=[[0.5]], B=[[1.0, 0.5]], C=[[1.0]], name=name,
        checks=(CHECK,), **expected,
    )  # fmt: skip


def run(law, y, u=None):
    return law.run({"u": np.zeros(len(y)) if u is None else np.asarray(u, dtype=float), "y": np.array(y)})


SETTLED = [0.0] * 5


@pytest.mark.parametrize("curve", [False, True])
def test_a_jump_is_replaced_by_the_prediction_until_the_hold_time_is_over(curve):
    found = run(tracker(curve=curve), [*SETTLED, 7.0, 7.1, 7.0, 7.1, 7.0])
    assert found["input_fault"].tolist() == [0.0] * 5 + [1.0, 1.0, 1.0, 0.0, 0.0]
    assert found["estimate"][-1] == 3.55


def test_a_jump_that_stays_exactly_where_it_is_is_refused_four_times_as_long_then_taken_but_flagged():
    found = run(tracker(), [*SETTLED, *[7.0] * 14, 7.1])
    assert found["input_fault"].tolist() == [0.0] * 5 + [1.0] * 14 + [0.0]
    assert found["estimate"].tolist() == [0.0] * 18 + [3.5, 5.25]


def test_what_follows_a_long_frozen_stretch_is_taken_at_once():
    found = run(tracker(), [*SETTLED, *[7.0] * 6, 9.0, 8.0])
    assert found["input_fault"].tolist() == [0.0] * 5 + [1.0] * 6 + [0.0] * 2
    assert found["estimate"].tolist() == [0.0] * 12 + [4.5]


#: Errors that drift: from −0.4 to 0.4 in steps of 0.1, as wrong parameters make them.
DRIFT = [-0.4, -0.3, -0.2, -0.1, 0.0, 0.1, 0.2, 0.3, 0.4]


@pytest.mark.parametrize("jump, fault", [(0.35, 1.0), (0.2, 0.0)])
def test_a_jump_within_the_limit_shows_by_how_suddenly_the_error_changes(jump, fault):
    """A quarter of the limit, and three times the largest change of late."""
    law = replace(tracker(), A=[[1.0]], B=[[1.0, 0.0]])  # keeps its state: the error is y itself
    found = run(law, [*DRIFT, 0.4 + jump])
    assert found["input_fault"].tolist() == [0.0] * 9 + [fault]


def test_a_sample_is_back_if_it_is_nearer_to_its_prediction_than_to_the_bad_one_or_if_that_hung():
    law = replace(tracker(), A=[[1.0]], B=[[1.0, 0.0]], checks=(replace(CHECK, hold=20),))
    settled = [0.0, 0.01] * 15
    assert run(law, [*settled, 0.5, 0.3, 0.1, 0.0])["input_fault"].tolist() == [0.0] * 30 + [
        1.0,
        1.0,
        0.0,
        0.0,
    ]
    # Five equal ones are a sensor that hangs: the first other sample is believed, though far from the prediction.
    assert run(law, [*settled, *[0.5] * 5, 0.3])["input_fault"].tolist() == [0.0] * 30 + [1.0] * 5 + [0.0]


@pytest.mark.parametrize("value, times", [(0.5, 1), (0.0, 0)])
def test_a_law_without_a_model_tells_a_frozen_signal_by_its_repetition(value, times):
    """By the tenth of equal ones after a run of three; zero is standstill."""
    check = replace(CHECK, alone=True, hold=30, forget=1.0)
    law = replace(tracker(), A=[[0.0]], B=[[0.0, 1.0]], checks=(check,))  # expects the value before
    moving = [0.1, 0.2, 0.3, 0.4] * 15
    found = run(law, [*moving, 0.1, 0.1, 0.1, 0.2, *[value] * 10, 0.3])
    assert found["input_fault"].tolist() == [0.0] * (74 - times) + [1.0] * times + [0.0]


def test_a_missing_sample_is_predicted_through():
    found = run(tracker(), [*SETTLED, np.nan, np.nan, 2.0], u=[*SETTLED[1:], 1.0, 1.0, 0.0, 0.0])
    assert found["input_fault"].tolist() == [0.0] * 5 + [1.0, 1.0, 0.0]
    assert found["estimate"].tolist() == [*SETTLED, 1.0, 2.0, 2.0]


def test_the_last_good_sample_can_take_its_place():
    law = replace(tracker(), checks=(replace(CHECK, keep=True),))
    found = run(law, [*SETTLED, np.nan, np.nan], u=[*SETTLED[1:], 1.0, 0.0, 0.0])
    assert found["estimate"].tolist() == [*SETTLED, 1.0, 0.5]


def test_what_the_same_law_takes_without_its_checks():
    assert not np.any(run(tracker().without_checks(), [*SETTLED, 7.0, 7.0])["input_fault"])


def follower(checks=(CHECK, InputCheck.when_missing("u")), rows=((1.0, 0.0, 0.0), (10.0, 0.0, 2.0))):
    """The tracker, which takes 10 x + 2 y for u where that is missing; rows of (P, Q)."""
    rows = np.array(rows)
    return replace(tracker(), checks=checks, P=rows[:, :1], Q=rows[:, 1:], R=[])


@pytest.mark.parametrize("keep, wanted", [(False, [0.0, 0.0, 2.5, 28.75]), (True, [0.0, 0.0, 0.5, 0.75])])
def test_a_missing_command_is_told_from_an_input_that_is_checked_before_it(keep, wanted):
    law = follower((replace(CHECK, limit=100.0), replace(InputCheck.when_missing("u"), keep=keep)))
    found = run(law, [0.0, 1.0, 1.0, 1.0], u=[0.0, np.nan, np.nan, 0.0])
    # x⁺ = 0.5 (x + y) + u with u = 2 and 27, or 0.
    assert found["estimate"].tolist() == wanted
    assert found["input_fault"].tolist() == [0.0, 1.0, 1.0, 0.0]


def test_the_last_given_one_takes_its_place_where_that_input_is_bad_too():
    found = run(
        follower((replace(CHECK, limit=100.0), InputCheck.when_missing("u"))),
        [*SETTLED, 0.0, np.nan, np.nan, 0.0],
        u=[*SETTLED[1:], 3.0, np.nan, np.nan, np.nan, 0.0],
    )
    # x⁺ = 0.5 (x + y) + u with u = 3, then 10 x + 2 y = 30 for once; while y is missing, x⁺ = x + 3.
    assert found["estimate"].tolist() == [*SETTLED, 3.0, 31.5, 34.5, 37.5]


def test_a_command_may_stand_and_jump():
    u = [*[1.0] * 40, 1e29, *[-1e29] * 40, 0.0]
    law = replace(follower(), A=[[0.0]], B=[[1.0, 0.0]])
    found = run(law, [0.0] * len(u), u=u)
    assert found["estimate"].tolist() == [0.0, *u[:-1]]
    assert (
        run(replace(law, checks=law.checks[1:], P=law.P[1:], Q=law.Q[1:], R=[]), [0.0] * 82, u)[
            "input_fault"
        ].tolist()
        == [0.0] * 82
    )


@pytest.mark.parametrize(
    "changes, complaint",
    [
        ({"checks": (CHECK, CHECK), "P": [[1.0], [1.0]], "Q": [], "R": []}, "each once"),
        ({"checks": (replace(CHECK, input="z"),)}, "inputs out of"),
        ({"Q": [[0.0, 1.0]]}, "prediction that needs"),
        ({"R": [[1.0]], "G": [[0.0, 1.0]]}, "prediction that needs"),
        ({"P": [[1.0, 2.0]]}, "shape"),
        # Told by itself, or by what is checked later.
        ({"checks": (InputCheck.when_missing("u"),), "Q": [[1.0, 0.0]]}, "not checked yet"),
        (
            {"checks": (InputCheck.when_missing("u"), CHECK), "P": [], "Q": [[0.0, 1.0], [0.0, 0.0]]},
            "not checked yet",
        ),
    ],
)
def test_misuse_of_a_law(changes, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        replace(tracker(curve="R" in changes), **changes)


@pytest.mark.parametrize(
    "changes", [{"limit": 0.0}, {"limit": float("nan")}, {"hold": 0}, {"hold": 1.5}, {"forget": 1.1}]
)
def test_misuse_of_a_check(changes):
    with pytest.raises(InvalidInput, match="check of 'y'"):
        replace(CHECK, **changes)


def test_times_become_samples():
    check = InputCheck.over_time("y", 2.0, 1e-3, hold=0.03, memory=1.0)
    assert (check.hold, check.forget) == (30, np.exp(-1e-3))


def test_a_joined_law_keeps_the_check_for_all_and_the_order_of_curves():
    limiter = DiscreteSystem(
        inputs=("y", "estimate"), outputs=("u",), dt=0.1, curves=(saturation(2.0),), G=[[1.0, 1.0]], J=[[1.0]]
    )
    other = tracker("other", "other_estimate")
    law = connect([limiter, tracker(curve=True), other], inputs=("y",), outputs=("u", "estimate"))
    assert [check.input for check in law.checks] == ["y"] and law.early_curves == 1
    found = law.run({"y": np.array([*SETTLED, np.nan, 9.0])})
    assert found["input_fault"].tolist() == [0.0] * 5 + [1.0, 1.0]
    assert found["u"].tolist() == [0.0] * 7


def test_a_signal_that_a_system_makes_is_not_checked():
    law = connect([one_sample_delay("raw", 0.1, "y"), tracker()], inputs=("raw", "u"), outputs=("estimate",))
    assert law.checks == ()


def test_the_check_of_a_command_vanishes_where_a_system_makes_it():
    controller = one_sample_delay("command", 0.1, "u")
    joined, plain = (
        connect([law, controller], inputs=("y", "command"), outputs=("estimate",))
        for law in (follower(), tracker())
    )
    assert joined.to_dict() == plain.to_dict()
    filter_of_y = DiscreteSystem(inputs=("raw",), outputs=("y",), dt=0.1, D=[[2.0]])
    outside = connect([filter_of_y, follower()], inputs=("raw", "u"), outputs=("estimate",))
    assert [check.input for check in outside.checks] == ["u"] and outside.Q.tolist() == [[4.0, 0.0]]


def test_new_names_and_plain_data_keep_the_check():
    law = tracker().renamed({"y": "speed"})
    assert law.checks[0].input == "speed"
    for one in (law, follower()):
        again = DiscreteSystem.from_dict(json.loads(json.dumps(one.to_dict(), allow_nan=False)))
        assert again.to_dict() == one.to_dict()


@pytest.mark.parametrize("key", ["checks", "P", "Q", "R"])
def test_nothing_that_is_missing_is_filled_in(key):
    data = tracker().to_dict()
    del data[key]
    with pytest.raises(InvalidInput, match=f"without {key}"):
        DiscreteSystem.from_dict(data)
    data = tracker().to_dict()
    del data["checks"][0]["missing_only"]
    with pytest.raises(InvalidInput, match="without missing_only"):
        DiscreteSystem.from_dict(data)
