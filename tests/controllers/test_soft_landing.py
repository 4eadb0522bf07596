"""Soft landing: the contact speed that was asked for, no hold on steady torques, the mirror image, misuse."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import lqi, soft_landing
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.metrics import crossing_metrics, step_metrics
from lostmotion.observers import kalman
from lostmotion.simulation import Sensor, simulate
from lostmotion.systems import DiscreteSystem, connect, one_sample_delay

DT, LIMIT = 1e-4, 73.5
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip
ACTING = one_sample_delay("torque_motor", DT, "torque_motor_acting")


def limiter(plant=PLANT, **changes) -> DiscreteSystem:
    return soft_landing(plant, **{"dt": DT, "contact_speed": 0.6, "torque_limit": LIMIT, **changes})


def landing(plant: Drivetrain, torque: float, known: Drivetrain | None = None, **changes):
    """A constant wished torque from the far edge of the gap on, all states known; at rest at first."""
    law = connect(
        [limiter(known or plant, **changes), ACTING],
        inputs=("torque_wished", "twist_estimated", "twist_elastic_estimated", "speed_motor_estimated",
                "speed_load_estimated"),
        outputs=("torque_motor",),
    )  # fmt: skip
    elastic = DiscreteSystem(
        inputs=("twist",), outputs=("twist_elastic_estimated",), dt=DT, curves=(dead(plant),),
        G=np.ones((1, 1)), J=np.ones((1, 1)),
    )  # fmt: skip
    seen = {
        "twist_estimated": "twist",
        "speed_motor_estimated": "speed_motor",
        "speed_load_estimated": "speed_load",
    }
    return simulate(
        plant, dt=DT, law=[elastic, law], delay=1, torque_wished=np.full(4000, torque),
        sensors={name: Sensor(source) for name, source in seen.items()},
        state=(-np.sign(torque) * 0.49 * plant.backlash, 0.0, 0.0),
    )  # fmt: skip


def dead(plant):
    from lostmotion.curves import dead_zone

    return dead_zone(0.5 * plant.backlash)


@pytest.mark.parametrize("contact_speed", [0.2, 0.6, 2.0])
@pytest.mark.parametrize("backlash", [0.003, 0.012, 0.1])
@pytest.mark.parametrize("lag", [0.0, 3e-4])
def test_the_gap_closes_at_the_speed_that_was_asked_for(contact_speed, backlash, lag):
    plant = PLANT.with_parameters(backlash=backlash, lag=lag, coulomb=0.0)
    for torque in (30.0, -60.0):
        found = landing(plant, torque, contact_speed=contact_speed)
        first = next(e for e in found.events if e.kind == "impact")
        # What is left is the lag of the control behind the falling speed, and samples of 0.1 ms on small gaps.
        assert 0.6 * contact_speed < abs(first.speed) < 1.3 * contact_speed
        assert np.sign(first.speed) == np.sign(torque)


@pytest.mark.parametrize("coulomb", [2.0, 8.0, 16.0])
def test_a_motor_that_rubs_a_little_harder_than_known_does_not_stop_in_the_gap(coulomb):
    rubs = PLANT.with_parameters(coulomb_motor=1.1 * coulomb, coulomb=0.0)
    found = landing(rubs, 60.0, PLANT.with_parameters(coulomb_motor=coulomb, coulomb=0.0), contact_speed=0.3)
    first = next(e for e in found.events if e.kind == "impact")
    gain = PLANT.inertia_motor / (PLANT.lag + DT)
    assert 0.05 < first.speed < 0.3 + 2.0 * coulomb / gain
    assert found["speed_load"][-1] > 5.0


@pytest.mark.parametrize("share", [0.8, 1.2])
def test_a_backlash_that_an_observer_tells_counts_and_not_the_known_one(share):
    wrong = PLANT.with_parameters(backlash=share * PLANT.backlash)
    rng, law = np.random.default_rng(6), limiter(wrong, backlash_estimated=True)
    data = {name: rng.normal(size=300) for name in law.inputs}
    data |= {"torque_wished": 60.0 * data["torque_wished"], "twist_estimated": 0.006 * data["twist_estimated"],
             "backlash_estimated": np.full(300, PLANT.backlash)}  # fmt: skip
    right = limiter().run(data)["torque_motor"]
    # The chords of the parabola cover the known backlash, so they differ a little.
    assert np.max(np.abs(law.run(data)["torque_motor"] - right)) < 1.0
    assert np.max(np.abs(limiter(wrong).run(data)["torque_motor"] - right)) > 10.0


def test_with_a_tolerance_a_narrower_gap_closes_more_slowly():
    wider = PLANT.with_parameters(backlash=1.1 * PLANT.backlash, coulomb=0.0)

    def impact(tolerance):
        law = connect(
            [limiter(wider, tolerance=tolerance), ACTING], outputs=("torque_motor",),
            inputs=("torque_wished", "twist_estimated", "twist_elastic_estimated", "speed_motor_estimated",
                    "speed_load_estimated"),
        )  # fmt: skip
        elastic = DiscreteSystem(
            inputs=("twist",), outputs=("twist_elastic_estimated",), dt=DT, curves=(dead(wider),),
            G=np.ones((1, 1)), J=np.ones((1, 1)),
        )  # fmt: skip
        seen = {f"{n}_estimated": Sensor(n) for n in ("twist", "speed_motor", "speed_load")}
        run = simulate(
            PLANT.with_parameters(coulomb=0.0), dt=DT, law=[elastic, law], delay=1, sensors=seen,
            torque_wished=np.full(1000, 60.0), state=(-0.49 * PLANT.backlash, 0.0, 0.0),
        )  # fmt: skip
        return next(abs(e.speed) for e in run.events if e.kind == "impact")

    assert impact(0.1) < 0.75 * impact(0.0)


def test_in_the_gap_its_coordinates_are_a_double_integrator_of_the_next_torque():
    plant, n = PLANT.with_parameters(backlash=50.0, coulomb=0.0, viscous=0.0), 300
    torque = 40.0 * np.random.default_rng(5).normal(size=n)
    acting = np.concatenate([[0.0], torque[:-1]])
    run = simulate(plant, dt=DT, torque_motor=acting)
    law = limiter(plant)
    signals = {
        "torque_wished": np.zeros(n), "twist_estimated": run["twist"], "twist_elastic_estimated": np.zeros(n),
        "speed_motor_estimated": run["speed_motor"], "speed_load_estimated": run["speed_load"],
        "torque_motor_acting": acting,
    }  # fmt: skip
    u = np.column_stack([signals[name] for name in law.inputs])
    state = np.zeros(n)
    for k in range(n - 1):
        state[k + 1] = law.A[0, 0] * state[k] + law.B[0] @ u[k]
    # Arguments of the curves: 1 is the distance, 6 the speed times rate·inertia.
    distance, speed = (state * law.F[i, 0] + u @ law.G[i] for i in (1, 6))
    speed = speed / (plant.inertia_motor / (plant.lag + DT))
    step = DT * torque / plant.inertia_motor
    np.testing.assert_allclose(np.diff(speed), step[:-1], atol=1e-11)
    np.testing.assert_allclose(np.diff(distance), DT * (speed + 0.5 * step)[:-1], atol=1e-13)


@pytest.mark.parametrize("torque", [-73.0, -5.0, 0.3, 20.0, 73.0])
def test_a_steady_torque_goes_through(torque):
    elastic = torque / PLANT.stiffness
    steady = {
        "torque_wished": torque, "twist_estimated": elastic + 0.006 * np.sign(torque),
        "twist_elastic_estimated": elastic, "speed_motor_estimated": 5.0, "speed_load_estimated": 5.0,
        "torque_motor_acting": torque,
    }  # fmt: skip
    found = limiter().run({name: np.full(100, value) for name, value in steady.items()})
    assert found["torque_motor"][-1] == pytest.approx(torque, rel=1e-12)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_torque_is_not_held_back_for_longer_than_a_crossing_lasts(sign):
    """An observer that has missed the contact: it goes on to tell a motor at rest before the edge."""
    law, patience = limiter(), round(2.0 * PLANT.backlash / 0.6 / DT)
    before = dict.fromkeys(law.inputs, np.zeros(2000)) | {
        "torque_wished": np.full(2000, 50.0 * sign), "twist_estimated": np.full(2000, 0.0059 * sign),
    }  # fmt: skip
    torque = sign * law.run(before)["torque_motor"]
    assert torque[0] < 30.0 and np.ptp(torque[:patience]) < 1e-12
    assert np.all(np.diff(torque) > -1e-9) and 48.0 < torque[2 * patience] <= 50.0
    for_ever = sign * limiter(patience=1e9).run(before)["torque_motor"]
    assert np.ptp(for_ever) < 1e-6 and for_ever[0] == torque[0]


@pytest.mark.parametrize("torque", [60.0, -30.0])
def test_where_a_gap_closes_in_time_the_patience_changes_no_bit(torque):
    free, bound = (
        landing(PLANT.with_parameters(coulomb=0.0), torque, **more) for more in ({}, {"patience": 1e9})
    )
    assert np.array_equal(free["torque_motor"], bound["torque_motor"])


def test_it_is_its_own_mirror_image():
    rng = np.random.default_rng(4)
    law = limiter()
    data = {name: rng.normal(size=500) for name in law.inputs}
    data["torque_wished"] *= 60.0
    data["twist_estimated"] *= 0.006
    data["twist_elastic_estimated"] *= 0.003
    plus = law.run(data)["torque_motor"]
    minus = law.run({name: -values for name, values in data.items()})["torque_motor"]
    # Where neither limit holds alone the upper one goes first; a contradiction of both is not met in the loop.
    both = np.abs(plus + minus) < 1e-9
    assert np.mean(both) > 0.95
    assert np.ptp(plus) == pytest.approx(2.0 * LIMIT)


def test_a_bounded_motor_stays_below_the_set_point_and_lands_softly():
    def run(**bound):
        observer = kalman(PLANT, dt=DT, load_torque=True, process_covariance={"torque_load": 1e6})
        speed = lqi(
            PLANT, dt=DT, largest_error=2.4, largest_torque=LIMIT, largest_oscillation=8.0, torque_limit=LIMIT
        )
        law = connect(
            [observer.renamed({"torque_motor": "torque_motor_acting"}), ACTING,
             speed.renamed({"torque_motor": "torque_wished"}),
             limiter(contact_speed=0.4, braking_torque=20.0, release=100.0, **bound)],
            inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",),
        )  # fmt: skip
        reference = np.where(np.arange(6000) < 3000, -2.0, 2.0)
        found = simulate(PLANT, dt=DT, law=law, delay=1, speed_reference=reference)
        return crossing_metrics(
            found.time, found["speed_motor"], found["speed_load"], found.events, 0.3, -2.0, 2.0
        )

    free, bounded = run(), run(motor_bounded=True)
    assert free.motor_overshoot > 0.3
    assert bounded.motor_overshoot < 0.02 and bounded.impact_speed < 0.6
    assert bounded.arrival_time < free.arrival_time + 1e-3


def test_a_bounded_motor_crosses_the_gap_at_the_contact_speed_where_the_set_point_asks_for_no_motion():
    law = limiter(motor_bounded=True, contact_speed=0.4)
    signals = dict.fromkeys(law.inputs, np.zeros(100)) | {"torque_wished": np.full(100, LIMIT)}
    # In the middle of the gap at rest: gain·contact_speed, and no more.
    gain = PLANT.inertia_motor / (PLANT.lag + DT)
    assert law.run(signals)["torque_motor"][-1] == pytest.approx(0.4 * gain)
    beyond = signals | {"speed_motor_estimated": np.full(100, 0.4)}
    assert abs(law.run(beyond)["torque_motor"][-1]) < 1e-9


def test_behind_lqi_the_impact_is_a_quarter_and_the_step_as_fast():
    def run(soft):
        observer = kalman(PLANT, dt=DT, load_torque=True, process_covariance={"torque_load": 1e6})
        speed = lqi(PLANT, dt=DT, largest_error=2.0, largest_torque=LIMIT, torque_limit=LIMIT)
        parts = [observer.renamed({"torque_motor": "torque_motor_acting"}), ACTING, speed]
        if soft:
            parts[2:] = [speed.renamed({"torque_motor": "torque_wished"}), limiter()]
        law = connect(parts, inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))
        reference = np.where(np.arange(8000) < 3000, -2.0, 2.0)
        found = simulate(PLANT, dt=DT, law=law, delay=1, speed_reference=reference)
        load = step_metrics(found.time, found["speed_load"], 0.3, -2.0, 2.0)
        return load, crossing_metrics(
            found.time, found["speed_motor"], found["speed_load"], found.events, 0.3, -2.0, 2.0
        )

    (_, hard), (step, soft) = run(False), run(True)
    assert soft.impact_speed < 1.0 and soft.impact_speed < 0.25 * hard.impact_speed
    assert soft.arrival_time < 0.019
    assert step.overshoot < 1.0 and step.steady_error < 1e-3


@pytest.mark.parametrize(
    "changes, complaint",
    [
        ({"contact_speed": 0.0}, r"soft_landing\.contact_speed"),
        ({"torque_limit": np.inf}, r"soft_landing\.torque_limit"),
        ({"braking_torque": -1.0}, r"soft_landing\.braking_torque"),
        ({"rate": 2e4}, r"soft_landing\.rate"),
        ({"release": 1.5}, r"soft_landing\.release"),
        ({"tolerance": 1.0}, r"soft_landing\.tolerance"),
        ({"patience": 0.0}, r"soft_landing\.patience"),
        ({"patience": np.nan}, r"soft_landing\.patience"),
        ({"dt": np.nan}, r"soft_landing\.dt"),
        ({"plant": PLANT.with_parameters(backlash=0.0)}, "backlash"),
    ],
)
def test_misuse(changes, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        limiter(**changes)
