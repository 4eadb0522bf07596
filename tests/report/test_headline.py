"""The headline says in one sentence what the user may rely on and what not, and follows the results."""

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


OBSERVER_1 = "that Observer 1 estimates from motor torque and motor speed"


def law(**figures: Any) -> dict[str, Any]:
    usual = {"overshoot": 0.7, "peak_torque": 38.2, "steady_error": 1e-4, "settling_time": 0.1}
    return {"controllers": {"pole_placement": {**usual, **figures}}}


def test_one_sentence_says_what_to_rely_on_and_what_not():
    assert headline({"parameters": PARAMETERS}) == (
        "You may rely on motor inertia and backlash (±1.9\u00a0%), but not on damping (±50\u00a0%), "
        "Coulomb friction (from the nameplate) and viscous friction (not identified)."
    )
    everything = {
        "parameters": PARAMETERS,
        "observers": {"observer_1": {"speed_load": rmse(0.0004)}},
        **law(),
    }
    text = headline({**everything, "export": {"max_difference": 1e-9}})
    assert text.count(". ") == 0 and text.endswith(".")
    assert text.index("control law") < text.index("but not on") < text.index("the C code")


def test_only_what_there_is_is_said():
    assert headline({}) == "No stage gave a result."
    assert headline({"parameters": {"skipped": "no motor torque"}}) == "No stage gave a result."
    assert (
        headline({"parameters": {"damping": identified(0.4, 0.9)}}) == "Do not rely on damping (±90\u00a0%)."
    )


@pytest.mark.parametrize(
    ("signal", "words"), [("speed_load", "load speed"), ("torque_shaft", "shaft torque")]
)
def test_observer_1_is_explained_and_judged_by_the_first_signal_that_was_recorded(signal, words):
    text = headline({"observers": {"observer_1": {signal: rmse(0.0004)}}})
    assert text == f"You may rely on the {words} {OBSERVER_1} (error 0.040\u00a0% of its range)."


@pytest.mark.parametrize("better", ["motor_speed", "no_backlash"])
def test_an_observer_that_any_naive_estimate_beats_is_not_praised(better):
    naive = {"motor_speed": {"speed_load": rmse(0.05)}, "no_backlash": {"speed_load": rmse(0.05)}}
    naive[better] = {"speed_load": rmse(0.01)}
    text = headline({"observers": {"observer_1": {"speed_load": rmse(0.02)}, "baselines": naive}})
    name = {"motor_speed": "motor speed taken as estimate", "no_backlash": "observer without backlash"}[
        better
    ]
    assert text == (
        f"Do not rely on the load speed {OBSERVER_1} (error 2.0\u00a0% of its range; {name}: 1.0\u00a0%)."
    )


@pytest.mark.parametrize(
    ("results", "words"),
    [
        (law(), "You may rely on the control law (in simulation 0.70\u00a0% overshoot at 38.2\u00a0Nm)."),
        (
            law(overshoot=14.0),
            "Do not rely on the control law (in simulation 14\u00a0% overshoot, steady error",
        ),
        (law(steady_error=0.03), "Do not rely on the control law"),
        (law(settling_time=None), "Do not rely on the control law"),
        (law(overshoot=None, rise_time=None), "the load does not reach the set-point"),
        (
            {"controllers": {"pole_placement": {"skipped": "unstable loop"}}},
            "Do not rely on the control law (unstable loop).",
        ),
    ],
)
def test_controller(results, words):
    assert words in headline(results)


def test_code_is_named_only_where_it_must_not_be_used():
    assert headline({"export": {"max_difference": 0.0}}) == "No stage gave a result."
    assert (
        headline({"export": {"max_difference": 1e-9}})
        == "Do not rely on the C code, which differs from Python."
    )
