"""DiscreteSystem and connect: validation, running, joining."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.curves import dead_zone, saturation
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.observers import kalman
from lostmotion.recording import Recording
from lostmotion.systems import DiscreteSystem, connect, one_sample_delay, zero_order_hold


def first_order(name="lag", inputs=("a",), outputs=("b",), pole=0.5, dt=1e-3, **changes):
    """b⁺ = pole·b + a."""
    return DiscreteSystem(
        inputs=inputs, outputs=outputs, states=("x",), dt=dt, name=name,
        A=np.array([[pole]]), B=np.ones((1, 1)), C=np.ones((1, 1)), **changes,
    )  # fmt: skip


def gain(value, source, target, dt=1e-3):
    return DiscreteSystem(
        inputs=(source,), outputs=(target,), dt=dt, D=np.array([[value]]), name=f"gain {value}"
    )


def curved(curve, source, target, dt=1e-3, name="curved"):
    return DiscreteSystem(
        inputs=(source,),
        outputs=(target,),
        dt=dt,
        curves=(curve,),
        G=np.ones((1, 1)),
        J=np.ones((1, 1)),
        name=name,
    )


def test_the_equations_by_hand():
    law = DiscreteSystem(
        inputs=("u",), outputs=("y",), states=("x",), dt=0.1, curves=(dead_zone(1.0), saturation(2.0)),
        A=[[0.5]], B=[[1.0]], E=[[0.0, 0.25]], F=[[1.0], [0.0]], G=[[2.0], [1.0]], H=[[0.0, 0.0], [3.0, 0.0]],
        C=[[10.0]], D=[[100.0]], J=[[1000.0, 0.0]], initial_state=[4.0],
    )  # fmt: skip
    result = law.run({"u": [1.0, -1.0]})
    # k = 0: z0 = 4 + 2, w0 = 5; z1 = 1 + 15, w1 = 2; y = 40 + 100 + 5000; x = 2 + 1 + 0.5
    # k = 1: z0 = 3.5 − 2, w0 = 0.5; z1 = −1 + 1.5, w1 = 0.5; y = 35 − 100 + 500; x = 1.75 − 1 + 0.125
    np.testing.assert_array_equal(result["y"], [5140.0, 435.0])
    np.testing.assert_array_equal(result.final_state["state"][:1], [0.875])
    np.testing.assert_array_equal(result.time, [0.0, 0.1])
    assert result.origin["y"] == "estimated"


def test_a_run_goes_on_from_its_final_state():
    law = first_order()
    u = np.random.default_rng(0).normal(size=50)
    whole = law.run({"a": u})
    first = law.run({"a": u[:20]})
    rest = law.run({"a": u[20:]}, state=first.final_state["state"])
    np.testing.assert_array_equal(np.concatenate([first["b"], rest["b"]]), whole["b"])


def test_a_recording_gives_its_time_axis_and_must_fit_the_sample_time():
    time = 5.0 + 1e-3 * np.arange(4)
    data = Recording(time, {"a": [1.0, np.nan, 1.0, 1.0], "other": np.zeros(4)})
    result = first_order().run(data)
    np.testing.assert_array_equal(result.time, time)
    np.testing.assert_array_equal(result["input_fault"], [0.0, 1.0, 0.0, 0.0])
    np.testing.assert_array_equal(result["b"], [0.0, 1.0, 1.5, 1.75])
    with pytest.raises(InvalidInput, match=r"dt = 0\.001 s"):
        first_order(dt=2e-3).run(data)


@pytest.mark.parametrize(
    "data, complaint",
    [({"b": [1.0, 2.0]}, "no a"), ({"a": [[1.0, 2.0]]}, r"shape|\(1, 2\)")],
)
def test_wrong_run_inputs(data, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        first_order().run(data)


@pytest.mark.parametrize(
    "changes, complaint",
    [
        ({"A": np.ones((2, 1))}, r"law\.A: got shape \(2, 1\), expected shape \(1, 1\)"),
        ({"B": np.array([[np.nan]])}, r"law\.B: got NaN"),
        ({"inputs": ("u", "u")}, "without doubles"),
        ({"dt": 0.0}, r"law\.dt"),
        ({"dt": float("nan")}, r"DiscreteSystem\.dt: got nan"),
        ({"H": np.ones((1, 1))}, "strictly lower triangular"),
        ({"initial_state": np.zeros(2)}, "initial_state"),
        ({"inputs": tuple(f"u{i}" for i in range(32)), "B": [], "G": []}, "at most 31"),
    ],
)
def test_validation(changes, complaint):
    good = {
        "inputs": ("u",), "outputs": ("y",), "states": ("x",), "dt": 1e-3, "curves": (saturation(1.0),),
        "A": np.ones((1, 1)), "B": np.ones((1, 1)), "G": np.ones((1, 1)),
    }  # fmt: skip
    DiscreteSystem(**good)
    with pytest.raises(InvalidInput, match=complaint):
        DiscreteSystem(**{**good, **changes})


def test_matrices_are_copied_and_read_only():
    a = np.array([[0.5]])
    law = DiscreteSystem(inputs=("u",), outputs=("y",), states=("x",), dt=1.0, A=a)
    a[0, 0] = 7.0
    assert law.A[0, 0] == 0.5
    with pytest.raises(ValueError, match="read-only"):
        law.A[0, 0] = 1.0


def test_zero_order_hold_of_a_double_integrator():
    phi, gamma = zero_order_hold([[0.0, 1.0], [0.0, 0.0]], [[0.0], [1.0]], 0.1)
    np.testing.assert_allclose(phi, [[1.0, 0.1], [0.0, 1.0]], rtol=1e-15)
    np.testing.assert_allclose(gamma, [[0.005], [0.1]], rtol=1e-15)


def test_poles():
    np.testing.assert_array_equal(first_order(pole=0.25).poles(), [0.25])


def test_connect_in_series_equals_one_after_the_other():
    one, two = first_order("one", ("a",), ("b",), 0.5), first_order("two", ("b",), ("c",), -0.3)
    law = connect([two, one], inputs=("a",), outputs=("c", "b"))
    u = np.random.default_rng(1).normal(size=100)
    middle = one.run({"a": u})
    result = law.run({"a": u})
    np.testing.assert_allclose(result["b"], middle["b"], rtol=1e-15)
    np.testing.assert_allclose(result["c"], two.run(middle)["c"], rtol=1e-13, atol=1e-15)
    assert law.states == ("two.x", "one.x")


def test_a_joined_law_is_named_after_its_parts():
    one, two = (DiscreteSystem(inputs=("u",), outputs=(f"y{n}",), D=[[1.0]], dt=1.0, name=n) for n in "ab")
    assert connect([one, two], inputs=("u",), outputs=("ya",)).name == "a_and_b"
    assert connect([one, two], inputs=("u",), outputs=("ya",), name="mine").name == "mine"


def test_connect_closes_a_loop_through_a_state():
    plant = first_order("plant", ("torque",), ("speed",), pole=1.0)
    law = connect([plant, gain(-0.5, "speed", "torque")], outputs=("speed",))
    np.testing.assert_array_equal(law.poles(), [0.5])


def test_connect_interleaves_curves_of_several_systems():
    # one: p = dz(u), and q = sat(r); two: r = 3·sat(p): the order must be dz, sat of two, sat of one.
    one = DiscreteSystem(
        inputs=("u", "r"), outputs=("p", "q"), dt=1e-3, name="one", curves=(saturation(1.0), dead_zone(0.5)),
        G=[[0.0, 1.0], [1.0, 0.0]], J=[[0.0, 1.0], [1.0, 0.0]],
    )  # fmt: skip
    two = DiscreteSystem(
        inputs=("p",), outputs=("r",), dt=1e-3, name="two", curves=(saturation(0.25),), G=[[1.0]], J=[[3.0]]
    )
    law = connect([one, two], inputs=("u",), outputs=("q",))
    u = np.linspace(-2.0, 2.0, 41)
    wanted = np.clip(3.0 * np.clip(u - np.clip(u, -0.5, 0.5), -0.25, 0.25), -1.0, 1.0)
    np.testing.assert_allclose(law.run({"u": u})["q"], wanted, atol=1e-15)


def test_an_algebraic_loop_is_named_and_a_delay_breaks_it():
    systems = [curved(saturation(1.0), "a", "b"), gain(2.0, "b", "a")]
    with pytest.raises(InvalidInput, match=r"loop through curve 0 of curved → b → a → .*one_sample_delay"):
        connect(systems, outputs=("b",))
    delayed = [systems[0].renamed({"a": "b_delayed"}), one_sample_delay("b", 1e-3, start=0.5)]
    law = connect(delayed, outputs=("b",))
    assert law.initial_state.tolist() == [0.5]


@pytest.mark.parametrize(
    "systems, inputs, outputs, complaint",
    [
        (
            [first_order(), first_order("other", ("c",), ("b",))],
            ("a", "c"),
            ("b",),
            "an output of 'lag' and 'other'",
        ),
        ([first_order()], (), ("b",), "a: no output of a system"),
        ([first_order()], ("a", "z"), ("b",), "z: listed as inputs, but used by no system"),
        ([first_order(), gain(1.0, "b", "a")], ("a",), ("b",), "a: listed as inputs, but outputs of"),
        ([first_order()], ("a",), ("z",), r"connect\.outputs: got z"),
        ([first_order(), gain(1.0, "b", "c", dt=2e-3)], ("a",), ("c",), "one sample time"),
        ([], (), ("b",), "at least one system"),
    ],
)
def test_misuse_of_connect(systems, inputs, outputs, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        connect(systems, inputs=inputs, outputs=outputs)


def test_from_dict_says_what_is_missing():
    data = first_order().to_dict()
    del data["A"]
    with pytest.raises(InvalidInput, match="law: got a table without A"):
        DiscreteSystem.from_dict(data)


def test_renamed_refuses_unknown_names():
    with pytest.raises(InvalidInput, match="nobody"):
        first_order().renamed({"nobody": "x"})


def test_a_replaced_law_is_checked_again():
    with pytest.raises(InvalidInput, match=r"lag\.C"):
        replace(first_order(), C=np.ones((2, 2)))


def test_a_check_whose_prediction_needs_its_own_input_is_left_out():
    """A system that corrects the speed by the torque stands before an observer that tells a torque from the speed."""
    plant = Drivetrain.two_mass(inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, backlash=0.012)
    corrected = DiscreteSystem(
        inputs=("torque_motor", "speed_raw"),
        outputs=("speed_motor",),
        dt=1e-4,
        D=[[1e-3, 1.0]],
        name="corrected",
    )
    filtered = replace(corrected, inputs=("speed_raw",), D=[[1.0]])
    for before, checked in ((corrected, []), (filtered, ["torque_motor"])):
        law = connect(
            [before, kalman(plant, dt=1e-4)],
            inputs=("torque_motor", "speed_raw"),
            outputs=("speed_load_estimated",),
        )
        assert [check.input for check in law.checks] == checked
        torque = np.where(np.arange(50) == 20, np.nan, 1.0)
        found = law.run({"torque_motor": torque, "speed_raw": np.linspace(0.0, 0.3, 50)})
        assert found["input_fault"][20] == 1.0 and np.all(np.isfinite(found["speed_load_estimated"]))
