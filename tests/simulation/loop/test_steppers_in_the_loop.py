"""Steppers in the loop: what they estimate there is what they estimate over the recording of the loop."""

from __future__ import annotations

import math

import numpy as np
import pytest
from all_steppers import STEPPERS
from table_i import TABLE_I

import lostmotion as lm
from lostmotion import DiscreteSystem, Drivetrain, Recording, Sensor, observers
from lostmotion.controllers import pole_placement
from lostmotion.systems import Stepper

DT = 1e-4
EVERY = pytest.mark.parametrize("make", STEPPERS, ids=lambda make: make.__name__)
MODEL = Drivetrain.two_mass(**TABLE_I)
PLANT = Drivetrain.two_mass(**TABLE_I, contact="physical")
ENCODER = {"speed_motor": Sensor("angle_motor", 2.0 * math.pi / 2**20, difference=True)}


def controller(dt: float = DT) -> DiscreteSystem:
    return pole_placement(MODEL, poles=(-200, -200, -200), dt=dt, torque_limit=30.0)


def reference(n: int) -> np.ndarray:
    return np.where(np.arange(n) * DT % 0.2 < 0.1, -2.0, 2.0)


def torque(n: int, seed: int = 1) -> np.ndarray:
    square = np.where(np.arange(n) % 400 < 200, 6.0, -6.0)
    return square + 5.0 * np.random.default_rng(seed).standard_normal(n)


def assert_same_over_the_recording(law: Stepper, loop: Recording, number: int = 0, every: int = 1) -> None:
    """Outputs, faults and final state, to the last bit, of the law run over what the loop recorded."""
    shown = {
        name: loop[f"{name}_measured" if f"{name}_measured" in loop else name][::every] for name in law.inputs
    }
    after = law.run(shown)
    for name in law.outputs:
        np.testing.assert_array_equal(loop[name][::every], after[name])
    np.testing.assert_array_equal(loop[f"input_fault_{law.name}"][::every], after["input_fault"])
    np.testing.assert_array_equal(loop.final_state["law"][number], after.final_state["state"])


@EVERY
def test_a_stepper_that_watches(make):
    law = make(MODEL, dt=DT)
    loop = lm.simulate(PLANT, dt=DT, torque_motor=torque(600), law=law)
    alone = lm.simulate(PLANT, dt=DT, torque_motor=torque(600))
    np.testing.assert_array_equal(loop["speed_load"], alone["speed_load"])
    assert np.ptp(loop["speed_load_estimated"]) > 0.1
    assert_same_over_the_recording(law, loop)


@EVERY
@pytest.mark.parametrize("delay", [0, 1])
def test_pole_placement_on_the_estimates_of_a_stepper(make, delay):
    """The observer reads the torque that acts, also where the controller makes it in the same sample."""
    law = make(MODEL, dt=DT, speed_from_counts=True)
    loop = lm.simulate(
        PLANT, dt=DT, law=[law, controller()], speed_reference=reference(2000), delay=delay, sensors=ENCODER
    )
    assert_same_over_the_recording(law, loop)
    commanded = controller().run(loop.only(*controller().inputs))["torque_motor"]
    np.testing.assert_array_equal(loop["torque_motor"][delay:], commanded[: 2000 - delay])
    # The first step is for the filters that start without knowing their parameters; the second one is followed.
    assert np.max(np.abs(loop["speed_load"][1900:] - 2.0)) < 0.1


def test_order_of_the_laws_does_not_matter():
    law = observers.super_twisting(MODEL, dt=DT)
    arguments = {"dt": DT, "speed_reference": reference(500)}
    first = lm.simulate(PLANT, law=[law, controller()], **arguments)
    second = lm.simulate(PLANT, law=[controller(), law], **arguments)
    np.testing.assert_array_equal(first["torque_motor"], second["torque_motor"])
    np.testing.assert_array_equal(first["speed_load_estimated"], second["speed_load_estimated"])


def test_several_observers_watch_one_controller():
    """Four laws of both kinds; those that watch change nothing."""
    kalman = observers.kalman(MODEL, dt=DT)
    watching = [
        make(MODEL, dt=DT)
        for make in (observers.extended_kalman, observers.sliding_mode, observers.neural_network)
    ]
    renamed = [law.renamed({name: f"{name}_{law.name}" for name in law.outputs}) for law in watching]
    arguments = {"dt": DT, "speed_reference": reference(500)}
    loop = lm.simulate(PLANT, law=[*renamed[:1], kalman, controller(), *renamed[1:]], **arguments)
    alone = lm.simulate(PLANT, law=[kalman, controller()], **arguments)
    np.testing.assert_array_equal(loop["torque_motor"], alone["torque_motor"])
    for number, law in zip((0, 3, 4), renamed, strict=True):
        assert_same_over_the_recording(law, loop, number)


def test_joined_beforehand_or_not_is_the_same():
    """One law joined beforehand and its parts; the order of the sums differs."""
    kalman = observers.kalman(MODEL, dt=DT)
    outputs = (*kalman.outputs, "torque_motor")
    joined = lm.connect([kalman, controller()], inputs=("speed_reference", "speed_motor"), outputs=outputs)
    limited = Drivetrain.two_mass(**TABLE_I, contact="physical", torque_limit=50.0)
    arguments = {"dt": DT, "speed_reference": reference(500), "sensors": ENCODER}
    parts = lm.simulate(limited, law=[kalman, controller()], **arguments)
    whole = lm.simulate(limited, law=joined, **arguments)
    for name in outputs:
        np.testing.assert_allclose(parts[name], whole[name], rtol=0.0, atol=1e-9)
    np.testing.assert_array_equal(parts["torque_motor"], kalman_command(parts))


def kalman_command(loop: Recording) -> np.ndarray:
    return controller().run(loop.only(*controller().inputs))["torque_motor"]


def test_a_law_reads_the_torque_that_acts():
    """Limited and delayed torque: the watching observer sees what the plant gets, as it is recorded."""
    limited = Drivetrain.two_mass(**TABLE_I, contact="physical", torque_limit=4.0)
    kalman = observers.kalman(MODEL, dt=DT)
    demand = DiscreteSystem(
        inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",), D=np.array([[9.0, -9.0]]), dt=DT
    )
    loop = lm.simulate(limited, dt=DT, law=[demand, kalman], speed_reference=reference(500), delay=2)
    assert np.max(np.abs(loop["torque_motor"])) == 4.0
    np.testing.assert_array_equal(loop["torque_motor"][:2], 0.0)
    after = kalman.run(loop.only(*kalman.inputs))
    for name in kalman.outputs:
        np.testing.assert_array_equal(loop[name], after[name])


def test_a_slow_controller_on_a_fast_observer():
    """Controller every 5 samples, observer every sample, a second observer every 10: each as over the recording."""
    fast = observers.super_twisting(MODEL, dt=DT)
    slow = observers.extended_kalman(MODEL, dt=10 * DT)
    slow = slow.renamed({name: f"{name}_slow" for name in slow.outputs})
    loop = lm.simulate(
        PLANT, dt=DT, law=[fast, controller(5 * DT), slow], speed_reference=reference(1000), sensors=ENCODER,
        delay=(0, 3, 0),
    )  # fmt: skip
    assert_same_over_the_recording(fast, loop)
    inputs = {name: loop[name][::5] for name in controller().inputs}
    commanded = controller(5 * DT).run(inputs)["torque_motor"]
    held = np.concatenate([np.zeros(3), np.repeat(commanded, 5)])[:1000]
    np.testing.assert_array_equal(loop["torque_motor"], held)
    assert np.max(np.abs(loop["speed_load"][900:] + 2.0)) < 0.1
    # The slow observer counts over its own sample; where nothing else does, its readings are the encoder's.
    counts = np.floor(loop["angle_motor"][::10] / ENCODER["speed_motor"].resolution)
    shown = np.diff(counts, prepend=counts[:1]) * ENCODER["speed_motor"].resolution / (10 * DT)
    after = slow.run({"torque_motor": loop["torque_motor"][::10], "speed_motor": shown})
    np.testing.assert_allclose(
        loop["speed_load_estimated_slow"][::10], after["speed_load_estimated_slow"], rtol=0.0, atol=1e-9
    )
    assert np.all(np.diff(loop["speed_load_estimated_slow"].reshape(-1, 10), axis=1) == 0.0)


def test_each_law_has_its_own_delay():
    """Two laws drive two ends, one at once and one 4 samples late."""
    motor = DiscreteSystem(inputs=("wish",), outputs=("torque_motor",), D=np.eye(1), dt=DT, name="motor")
    load = DiscreteSystem(inputs=("wish",), outputs=("torque_load",), D=-np.eye(1), dt=2 * DT, name="load")
    wish = torque(100)
    loop = lm.simulate(PLANT, dt=DT, law=[motor, load], wish=wish, delay=(0, 4))
    np.testing.assert_array_equal(loop["torque_motor"], wish)
    np.testing.assert_array_equal(loop["torque_load"][:4], 0.0)
    np.testing.assert_array_equal(loop["torque_load"][4:], np.repeat(-wish[::2], 2)[:96])
    alone = lm.simulate(PLANT, dt=DT, torque_motor=loop["torque_motor"], torque_load=loop["torque_load"])
    np.testing.assert_array_equal(loop["speed_load"], alone["speed_load"])


def test_a_signal_that_depends_on_itself_is_refused():
    """The law's torque is the torque that acts, plus one: without a delay there is no such number."""
    law = DiscreteSystem(
        inputs=("torque_motor", "wish"),
        outputs=("torque_motor",),
        D=np.array([[1.0, 1.0]]),
        dt=DT,
        name="echo",
    )
    wish = np.ones(50)
    with pytest.raises(lm.InvalidInput, match=r"algebraic loop.*echo.*sample 0"):
        lm.simulate(PLANT, dt=DT, law=law, wish=wish)
    loop = lm.simulate(PLANT, dt=DT, law=law, wish=wish, delay=1)
    np.testing.assert_array_equal(loop["torque_motor"], np.arange(50.0))


def test_lost_samples_are_predicted_through_and_flagged():
    law = observers.super_twisting(MODEL, dt=DT)
    sensors = {"speed_motor": Sensor("speed_motor", noise=0.01, dropout=0.05)}
    loop = lm.simulate(
        PLANT, dt=DT, law=[law, controller()], speed_reference=reference(1000), sensors=sensors, seed=3
    )
    lost = np.isnan(loop["speed_motor_measured"])
    assert 20 < np.count_nonzero(lost) < 90
    assert np.all(loop["input_fault_super_twisting"][lost] == 1.0)
    assert_same_over_the_recording(law, loop)


def test_laws_of_one_name_have_faults_of_their_own():
    """One of two alike reads a sensor that loses samples."""
    sound = observers.super_twisting(MODEL, dt=DT)
    names = {name: f"{name}_2" for name in ("speed_motor", *sound.outputs)}
    loop = lm.simulate(
        PLANT,
        dt=DT,
        law=[sound, sound.renamed(names), controller()],
        speed_reference=reference(1000),
        sensors={
            "speed_motor": Sensor("speed_motor"),
            "speed_motor_2": Sensor("speed_motor", dropout=0.05),
        },
        seed=3,
    )
    assert "input_fault_super_twisting" not in loop
    assert not np.any(loop["input_fault_super_twisting_1"])
    lost = np.isnan(loop["speed_motor_2_measured"])
    assert np.count_nonzero(lost) > 20 and np.all(loop["input_fault_super_twisting_2"][lost] == 1.0)


def test_numbered_names_avoid_those_that_are_taken():
    from lostmotion.simulation.laws_in_loop import _distinct

    assert _distinct(["a", "b"]) == ["a", "b"]
    assert _distinct(["a", "a_1", "a", "b"]) == ["a_2", "a_1", "a_3", "b"]


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"law": []}, r"simulate\.law"),
        ({"law": [controller(), "observer"]}, r"simulate\.law"),
        ({"delay": (0, 1, 2)}, r"simulate\.delay"),
        ({"delay": (0, -1)}, r"simulate\.delay"),
        ({"law": [observers.sliding_mode(MODEL, dt=DT)] * 2, "torque_motor": np.zeros(100)}, "made or given twice"),
        ({"law": [observers.sliding_mode(MODEL, dt=1.5 * DT), controller()]}, r"simulate\.dt"),
        ({"law": observers.sliding_mode(MODEL, dt=DT)}, "torque_motor"),
        ({"idle": np.zeros(100)}, "idle"),
        ({"sensors": {"twist": Sensor("twist")}}, r"simulate\.sensors"),
        ({"law": [observers.extended_kalman(MODEL, measured=("speed_motor", "twist"), dt=DT), controller()],
          "sensors": {"twist": Sensor("twist_measured_elsewhere")}}, "twist_measured_elsewhere|twist"),
    ],
)  # fmt: skip
def test_wrong_wiring_is_named(change, where):
    arguments = {
        "law": [observers.sliding_mode(MODEL, dt=DT), controller()], "speed_reference": reference(100), **change
    }  # fmt: skip
    with pytest.raises(lm.InvalidInput, match=where):
        lm.simulate(PLANT, dt=DT, **arguments)
