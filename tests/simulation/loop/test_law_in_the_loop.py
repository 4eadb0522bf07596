"""A law in the loop: equal to the law run over the recording, to the sensors' readings, and to a loop by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
from plants import trajectory
from table_i import TABLE_I

import lostmotion as lm
from lostmotion import DiscreteSystem, Drivetrain, Sensor

DT = 1e-4
ENCODER = Sensor("angle_motor", 2.0 * math.pi / 2**16, difference=True)


@pytest.fixture
def plant() -> Drivetrain:
    return Drivetrain.two_mass(**TABLE_I, contact="physical", lag=3e-4)


def speed_control(gain: float = 3.0) -> DiscreteSystem:
    return DiscreteSystem(
        inputs=("speed_reference", "speed_motor"),
        outputs=("torque_motor",),
        D=np.array([[gain, -gain]]),
        dt=DT,
        name="proportional",
    )


def observed_law() -> DiscreteSystem:
    observer = lm.observers.kalman(Drivetrain.two_mass(**TABLE_I), dt=DT)
    outputs = ("torque_motor", "speed_load_estimated", "twist_estimated")
    return lm.connect([observer, speed_control()], inputs=("speed_reference", "speed_motor"), outputs=outputs)


def reference(n: int) -> np.ndarray:
    return np.where(np.arange(n) * DT % 0.1 < 0.05, -2.0, 2.0)


def test_observer_in_the_loop_equals_observer_over_the_recording(plant):
    observer = lm.observers.kalman(Drivetrain.two_mass(**TABLE_I), dt=DT)
    torque = 10.0 * np.random.default_rng(1).standard_normal(2000)
    loop = lm.simulate(plant, dt=DT, torque_motor=torque, law=observer)
    after = observer.run(loop.only("torque_motor", "speed_motor"))
    for name in observer.outputs:
        np.testing.assert_array_equal(loop[name], after[name])
    np.testing.assert_array_equal(loop.final_state["law"][0], after.final_state["state"])


@pytest.mark.parametrize("delay", [0, 1])
def test_loop_equals_a_loop_by_hand(delay, plant):
    """One call of simulate per sample, going on from the final state, the torque computed in between."""
    n = 300
    loop = lm.simulate(plant, dt=DT, law=speed_control(), speed_reference=reference(n), delay=delay)
    state, waiting, rows = None, 0.0, []
    speed = 0.0
    for k in range(n):
        torque = 3.0 * reference(n)[k] - 3.0 * speed
        acting, waiting = (waiting, torque) if delay else (torque, 0.0)
        rows.append(acting)
        part = lm.simulate(plant, dt=DT / 2, torque_motor=np.full(2, acting), state=state)
        state = part.final_state
        speed = state["state"][1]
    np.testing.assert_allclose(loop["torque_motor"], rows, rtol=0.0, atol=1e-10)
    if delay:
        assert loop["torque_motor"][0] == 0.0


def test_loop_equals_the_plant_under_its_torque(plant):
    """The torque that a loop made, given to the plant alone, makes the same trajectory but for rounding."""
    loop = lm.simulate(plant, dt=DT, law=observed_law(), speed_reference=reference(1500), delay=1)
    alone = lm.simulate(plant, dt=DT, torque_motor=loop["torque_motor"])
    np.testing.assert_allclose(trajectory(loop), trajectory(alone), rtol=0.0, atol=1e-10)
    assert sum(e.kind == "impact" for e in loop.events) > 2


def test_sensors_in_the_loop_equal_measure(plant):
    sensors = {
        "speed_motor": Sensor("angle_motor", 2.0 * math.pi / 2**16, difference=True, noise=0.01, bias=0.1)
    }
    loop = lm.simulate(
        plant, dt=DT, law=observed_law(), speed_reference=reference(2000), sensors=sensors, seed=5
    )
    shown = lm.simulation.measure(sensors, loop.signals, DT, seed=5)
    np.testing.assert_array_equal(loop["speed_motor_measured"], shown["speed_motor"])
    other = lm.simulation.measure(sensors, loop.signals, DT, seed=6)
    assert np.any(other["speed_motor"] != shown["speed_motor"])


def test_encoder_shows_the_mean_speed_of_the_sample(plant):
    torque = 10.0 * np.random.default_rng(2).standard_normal(1000)
    exact = lm.simulate(plant, dt=DT, torque_motor=torque)
    shown = lm.simulation.measure({"speed_motor": ENCODER}, exact.signals, DT, seed=0)["speed_motor"]
    assert shown[0] == 0.0
    mean = np.diff(exact["angle_motor"]) / DT
    assert np.max(np.abs(shown[1:] - mean)) <= ENCODER.resolution / DT * (1 + 1e-9)
    counts = shown * DT / ENCODER.resolution
    np.testing.assert_allclose(counts, np.round(counts), atol=1e-6)


def test_torque_limit_holds_in_the_loop(plant):
    limited = Drivetrain.two_mass(**TABLE_I, torque_limit=4.0)
    loop = lm.simulate(limited, dt=DT, law=speed_control(30.0), speed_reference=reference(2000))
    assert np.max(np.abs(loop["torque_motor"])) == 4.0


def test_going_on_equals_going_through(plant):
    torque = 10.0 * np.random.default_rng(3).standard_normal(1000)
    whole = lm.simulate(plant, dt=DT, torque_motor=torque)
    first = lm.simulate(plant, dt=DT, torque_motor=torque[:400])
    second = lm.simulate(plant, dt=DT, torque_motor=torque[400:], state=first.final_state)
    np.testing.assert_array_equal(whole["speed_load"][400:], second["speed_load"])
    np.testing.assert_array_equal(whole.final_state["state"], second.final_state["state"])


@pytest.mark.parametrize(
    ("change", "where"),
    [
        ({"delay": -1}, "simulate.delay"),
        ({"dt": 2e-4}, "simulate.dt"),
        ({"speed_reference": None, "speed_wanted": np.zeros(5)}, "simulate"),
        ({"sensors": {"speed_load": ENCODER}}, "simulate.sensors"),
        ({"sensors": {"speed_motor": Sensor("speed")}}, "speed"),
        ({"idle": np.zeros(100)}, "simulate"),
        ({"torque_load": np.zeros(99)}, "simulate"),
    ],
)
def test_wrong_wiring_is_named(change, where, plant):
    arguments = {"dt": DT, "law": speed_control(), "speed_reference": reference(100), **change}
    with pytest.raises(lm.InvalidInput, match=where):
        lm.simulate(plant, **{k: v for k, v in arguments.items() if v is not None})


def test_law_without_torque_needs_one(plant):
    watcher = lm.observers.kalman(Drivetrain.two_mass(**TABLE_I), dt=DT)
    with pytest.raises(lm.InvalidInput, match="torque_motor"):
        lm.simulate(plant, dt=DT, law=watcher, torque_load=np.zeros(10))


@pytest.mark.parametrize("change", [{"resolution": -1.0}, {"noise": math.nan}])
def test_sensor_numbers_are_checked(change):
    with pytest.raises(lm.InvalidInput, match="Sensor"):
        Sensor("speed_motor", **change)


def test_law_at_a_multiple_of_the_sample_time(plant):
    """A law every 4 samples equals a loop by hand with its torque held, its delay counted in samples of the plant."""
    n, every, delay = 200, 4, 3
    slow = DiscreteSystem(
        inputs=("speed_reference", "speed_motor"),
        outputs=("torque_motor",),
        D=np.array([[3.0, -3.0]]),
        dt=every * DT,
    )
    loop = lm.simulate(plant, dt=DT, law=slow, speed_reference=reference(n), delay=delay)
    made = 3.0 * (reference(n) - loop["speed_motor"])[::every]
    held = np.concatenate([np.zeros(delay), np.repeat(made, every)])[:n]
    np.testing.assert_allclose(loop["torque_motor"], held, rtol=0.0, atol=1e-13)
    alone = lm.simulate(plant, dt=DT, torque_motor=held)
    np.testing.assert_allclose(trajectory(loop), trajectory(alone), rtol=0.0, atol=1e-10)


def test_observer_that_only_watches(plant):
    """Two laws at once: the watching observer changes nothing and shows what it would over the recording."""
    observer = lm.observers.kalman(Drivetrain.two_mass(**TABLE_I), dt=DT)
    both = lm.simulate(plant, dt=DT, law=[speed_control(), observer], speed_reference=reference(1000))
    one = lm.simulate(plant, dt=DT, law=speed_control(), speed_reference=reference(1000))
    np.testing.assert_array_equal(both["torque_motor"], one["torque_motor"])
    after = observer.run(both.only("torque_motor", "speed_motor"))
    np.testing.assert_allclose(
        both["speed_load_estimated"], after["speed_load_estimated"], rtol=0.0, atol=1e-12
    )


def test_a_watching_law_with_a_check_changes_nothing(plant):
    """The watcher refuses lost samples; what the controller reads must not be refused with them."""
    watching = lm.observers.kalman(Drivetrain.two_mass(**TABLE_I), dt=DT)
    assert watching.checks
    given = dict(
        dt=DT,
        speed_reference=reference(2000),
        sensors={"speed_motor": Sensor("speed_motor", dropout=0.05)},
        seed=3,
    )
    alone = lm.simulate(plant, law=speed_control(), **given)
    watched = lm.simulate(plant, law=[speed_control(), watching], **given)
    np.testing.assert_array_equal(watched["speed_load"], alone["speed_load"])


def test_a_final_state_of_another_plant_is_refused(plant):
    state = lm.simulate(plant, torque_motor=np.ones(50), dt=DT).final_state
    other = Drivetrain.two_mass(**TABLE_I, coulomb_motor=0.1, contact="physical", lag=3e-4)
    for digits in (state["digits"], [0, -1, 0], [0, 9, 0]):
        with pytest.raises(lm.InvalidInput, match="final_state"):
            lm.simulate(other, torque_motor=np.ones(50), dt=DT, state={**state, "digits": digits})


def test_law_steps_once_where_a_mode_is_new_at_the_start_of_a_sample():
    """The motor breaks away as a sample starts, in a mode that was never built: one law step all the same."""
    plant = Drivetrain.two_mass(**TABLE_I, coulomb_motor=0.5)
    doubling = DiscreteSystem(
        inputs=("speed_motor",), outputs=("count",), A=np.array([[2.0]]), B=np.zeros((1, 1)), C=np.eye(1), dt=DT,
        states=("count",), initial_state=np.array([1.0]),
    )  # fmt: skip
    torque = 3.0 * np.sign(np.sin(np.arange(30) * 0.5))
    loop = lm.simulate(plant, dt=DT, torque_motor=torque, law=doubling)
    assert loop.events[0].time == pytest.approx(DT, abs=1e-12)
    np.testing.assert_array_equal(loop["count"], 2.0 ** np.arange(30))


def test_lost_samples_keep_the_last_good_value(plant):
    sensors = {"speed_motor": Sensor("speed_motor", dropout=0.2)}
    loop = lm.simulate(
        plant, dt=DT, law=speed_control(), speed_reference=reference(1000), sensors=sensors, seed=2
    )
    lost = np.isnan(loop["speed_motor_measured"])
    assert 0.12 < lost.mean() < 0.28
    assert np.isfinite(loop["torque_motor"]).all()
    shown = lm.simulation.measure(sensors, loop.signals, DT, seed=2)["speed_motor"]
    np.testing.assert_array_equal(np.isnan(shown), lost)
    with pytest.raises(lm.InvalidInput, match=r"Sensor\.dropout"):
        Sensor("speed_motor", dropout=1.5)


def test_rate_limit_in_and_out_of_the_loop(plant):
    limited = Drivetrain(plant.inertias, plant.shafts, plant.frictions, lm.Actuator(rate_limit=1e4))
    loop = lm.simulate(limited, dt=DT, law=speed_control(30.0), speed_reference=reference(500))
    steps = np.diff(loop["torque_motor"], prepend=0.0)
    assert np.max(np.abs(steps)) == pytest.approx(1.0, rel=1e-9)
    wanted = 30.0 * (reference(500) - loop["speed_motor"])
    by_hand, last = [], 0.0
    for value in wanted:
        last = min(max(value, last - 1.0), last + 1.0)
        by_hand.append(last)
    np.testing.assert_allclose(loop["torque_motor"], by_hand, rtol=0.0, atol=1e-12)
    alone = lm.simulate(limited, dt=DT, torque_motor=wanted)
    np.testing.assert_allclose(alone["torque_motor"], by_hand, rtol=0.0, atol=1e-12)
    first = lm.simulate(limited, dt=DT, torque_motor=wanted[:100])
    second = lm.simulate(limited, dt=DT, torque_motor=wanted[100:], state=first.final_state)
    np.testing.assert_allclose(second["torque_motor"], by_hand[100:], rtol=0.0, atol=1e-12)
