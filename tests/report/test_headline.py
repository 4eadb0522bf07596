"""The headline says what the user may rely on and what not, and follows the results."""

from __future__ import annotations

from typing import Any

import pytest

from lostmotion.report.headline import headline


def identified(value: float, half: float) -> dict[str, Any]:
    return {"value": value, "low": value * (1.0 - half), "high": value * (1.0 + half), "source": "identified"}


def given(source: str) -> dict[str, Any]:
    return {"value": 1.0 if source == "nameplate" else None, "low": None, "high": None, "source": source}


def rmse(share: float) -> dict[str, float]:
    return {"rmse": 5.0 * share, "range": 5.0}


PARAMETERS = {
    "backlash": identified(0.012, 0.019),
    "damping": identified(0.4, 0.5),
    "inertia_motor": identified(0.018, 0.01),
    "coulomb": given("nameplate"),
    "viscous": given("not excited"),
}


def test_sure_and_uncertain_parameters_are_named_with_their_half_widths():
    assert headline({"parameters": PARAMETERS}) == (
        "Motor inertia and backlash are identified within ±1.9\u00a0%; damping (±50\u00a0%) is uncertain; "
        "Coulomb friction is taken from the nameplate; viscous friction is not identified."
    )


def test_only_what_there_is_is_said():
    assert headline({}) == "No stage gave a result."
    assert headline({"parameters": {"skipped": "no motor torque"}}) == "No stage gave a result."
    assert headline({"parameters": {"damping": identified(0.4, 0.9)}}) == "Damping (±90\u00a0%) is uncertain."


@pytest.mark.parametrize(
    ("signal", "words"), [("speed_load", "load speed"), ("torque_shaft", "shaft torque")]
)
def test_observer_1_is_explained_and_judged_by_the_first_signal_that_was_recorded(signal, words):
    text = headline({"observers": {"observer_1": {signal: rmse(0.0004)}}})
    assert text == (
        f"Observer 1, the Kalman observer that measures the motor speed alone, follows the {words} "
        "with an error of 0.040\u00a0% of its range."
    )


def test_an_observer_that_is_worse_than_the_motor_speed_is_not_praised():
    naive = {"motor_speed": {"speed_load": rmse(0.01)}}
    text = headline({"observers": {"observer_1": {"speed_load": rmse(0.02)}, "baselines": naive}})
    assert "does not beat motor speed taken as estimate for the load speed: 2.0\u00a0%" in text


@pytest.mark.parametrize(
    ("controllers", "words"),
    [
        (
            {"pole_placement": {"overshoot": 0.7}, "pi": {"overshoot": 10.7}},
            "overshoots by 0.70\u00a0% with pole placement and 11\u00a0% under PI.",
        ),
        ({"pole_placement": {"overshoot": 0.7}}, "overshoots by 0.70\u00a0% with pole placement."),
        ({"pole_placement": {"overshoot": None, "rise_time": None}}, "does not reach the set-point"),
        ({"pole_placement": {"skipped": "unstable loop"}}, "There is no controller to use: unstable loop."),
    ],
)
def test_controller(controllers, words):
    assert words in headline({"controllers": controllers})


def test_code_is_named_only_where_it_must_not_be_used():
    assert headline({"export": {"max_difference": 0.0}}) == "No stage gave a result."
    assert headline({"export": {"max_difference": 1e-9}}) == "Do not use the C code: it differs from Python."
