"""The Stepper type by itself: purity, the input-fault rule, misuse."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InvalidInput
from lostmotion.io.storage.law_files import load_law, save_law
from lostmotion.kernels.steppers import SIZES
from lostmotion.recording import Recording
from lostmotion.systems import Stepper

sys.path.insert(0, str(Path(__file__).parents[1] / "contracts"))


@pytest.fixture
def counting() -> Stepper:
    return Stepper(
        name="counting",
        inputs=("a", "b"),
        outputs=("count", "integral"),
        dt=0.5,
        parameters=np.array([2.0]),
        estimator="counting_stepper",
    )


def test_runs_over_a_recording(counting):
    recording = Recording(time=0.5 * np.arange(4), signals={"b": [1.0, 2.0, 3.0, 4.0], "a": np.zeros(4)})
    result = counting.run(recording)
    assert result["integral"].tolist() == [0.0, 2.0, 6.0, 12.0]
    assert result["count"].tolist() == [0.0, 1.0, 2.0, 3.0]
    assert result.final_state["state"].tolist() == [4.0, 20.0, 0.0, 4.0]
    assert result.origin["integral"] == "estimated"


def test_a_bad_input_is_replaced_by_the_last_good_one_and_flagged(counting):
    bad = [3.0, np.nan, np.inf, -2e30, 1.0]
    result = counting.run({"a": np.zeros(5), "b": bad})
    assert result["integral"].tolist() == [0.0, 6.0, 12.0, 18.0, 24.0]
    assert result["input_fault"].tolist() == [0.0, 1.0, 1.0, 1.0, 0.0]


def test_the_step_may_flag_an_input_that_it_does_not_believe(counting):
    result = counting.run({"a": [0.0, 200.0, 0.0], "b": np.zeros(3)})
    assert result["input_fault"].tolist() == [0.0, 1.0, 0.0]


def test_a_run_in_pieces_is_the_run(counting):
    rng = np.random.default_rng(1)
    data = {"a": rng.normal(size=20), "b": rng.normal(size=20)}
    data["b"][9:12] = np.nan  # the last good value must cross the border
    whole = counting.run(data)
    first = counting.run({n: v[:10] for n, v in data.items()})
    second = counting.run({n: v[10:] for n, v in data.items()}, state=first.final_state["state"])
    assert np.array_equal(np.concatenate([first["integral"], second["integral"]]), whole["integral"])


def test_a_step_leaves_its_arguments_alone(counting):
    start = counting.init()
    new, outputs, faults = counting.step(start, [0.0, 5.0])
    assert start.tolist() == [0.0] * 4
    assert (new.tolist(), outputs.tolist(), faults) == ([1.0, 10.0, 0.0, 5.0], [0.0, 0.0], 0)
    assert counting.step(new, [np.nan, np.inf])[2] == 0b11


def test_renamed_signals_carry_the_same_numbers(counting):
    other = counting.renamed({"a": "first", "count": "samples"})
    assert (other.inputs, other.outputs) == (("first", "b"), ("samples", "integral"))
    data = {"b": np.arange(4.0), "a": np.zeros(4)}
    result = other.run({"b": data["b"], "first": data["a"]})
    assert np.array_equal(result["samples"], counting.run(data)["count"])
    with pytest.raises(InvalidInput, match=r"counting\.renamed"):
        counting.renamed({"c": "d"})


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"dt": 0.0}, "dt"),
        ({"inputs": ("a", "a")}, "inputs"),
        ({"inputs": ()}, "inputs"),
        ({"outputs": ("x", "x")}, "outputs"),
        ({"parameters": np.array([np.nan])}, "parameters"),
    ],
)
def test_misuse_is_refused_at_once(change, where):
    fields = {"name": "s", "inputs": ("a",), "outputs": ("b",), "dt": 1.0, "parameters": np.zeros(1)}
    with pytest.raises(InvalidInput, match=where):
        Stepper(**{**fields, "estimator": "counting_stepper", **change})


def test_a_state_of_another_law_is_refused(counting):
    with pytest.raises(InvalidInput, match="state"):
        counting.run({"a": np.zeros(3), "b": np.zeros(3)}, state=np.zeros(3))
    with pytest.raises(InvalidInput, match="state"):
        counting.step([0.0, np.nan, 0.0, 0.0], [0.0, 0.0])
    with pytest.raises(InvalidInput, match="inputs"):
        counting.step(counting.init(), [0.0])


@pytest.fixture
def sliding() -> Stepper:
    """A stepper with as many numbers as its estimator has."""
    count, outputs = SIZES["sliding_mode"]
    return Stepper(
        name="sliding",
        inputs=("torque_motor", "speed_motor"),
        outputs=tuple(f"y{i}" for i in range(outputs)),
        dt=0.5,
        parameters=np.linspace(0.1, 1.0, count),
        estimator="sliding_mode",
        state_names={"sum": 3},
    )


def test_a_stored_stepper_is_read_again_and_a_foreign_one_is_not(counting, sliding, tmp_path):
    save_law(sliding, tmp_path / "law.json")
    again = load_law(tmp_path / "law.json")
    assert isinstance(again, Stepper) and again.to_dict() == sliding.to_dict()
    assert np.array_equal(again.parameters, sliding.parameters)
    with pytest.raises(InvalidInput, match="sliding_mode"):
        Stepper.from_dict(counting.to_dict())
    with pytest.raises(InvalidInput, match="without dt"):
        Stepper.from_dict({"estimator": sliding.estimator})


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"parameters": [1.0]}, r"parameters: got shape \(1,\), expected numbers of shape \(130,\)"),
        ({"outputs": ["y"]}, "outputs: got 1 names, expected the 6"),
        ({"parameters": "x" * 130}, "parameters: got"),
        ({"state_names": ["a"]}, "state_names"),
        ({"exportable": "no"}, "exportable: got 'no', expected true or false"),
        ({"dt": "0.1"}, "dt: got '0.1'"),
        ({"estimator": ["sliding_mode"]}, "estimator"),
    ],
)
def test_a_stepper_whose_arrays_its_step_would_overrun_is_refused(sliding, change, message):
    with pytest.raises(InvalidInput, match=message):
        Stepper.from_dict({**sliding.to_dict(), **change})


@pytest.mark.parametrize(
    ("old", "new"), [("sliding_mode", "sliding_mode"), ("radial_basis", "neural_network")]
)
def test_a_file_of_schema_version_1_names_a_module(sliding, tmp_path, old, new):
    data = sliding.to_dict()
    count, outputs = SIZES[new]
    data |= {"parameters": [0.5] * count, "outputs": [f"y{i}" for i in range(outputs)]}
    del data["estimator"]
    stored = {"kind": "law", "schema_version": 1, **data, "kernel": f"lostmotion.kernels.steppers_{old}"}
    (tmp_path / "law.json").write_text(json.dumps(stored))
    assert load_law(tmp_path / "law.json").estimator == new
