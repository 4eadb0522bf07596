"""The virtual rig: the frequencies of the paper's rig, its family, its recordings."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from table_i import PAPER, TABLE_I

import lostmotion as lm
from lostmotion.rig import (
    eigenfrequencies,
    finer_rig,
    motor_zeros,
    nominal_rig,
    two_mass_equivalent,
    varied_rig,
)
from lostmotion.rig.nominal import (
    BACKLASH,
    COULOMB,
    INERTIAS,
    SPREAD_FRICTION,
    SPREAD_STRUCTURE,
    STIFFNESSES,
    VISCOUS,
)
from lostmotion.run import run
from lostmotion.structure import GAP, paper_powertrain, reduce_to_chain

MODEL_LAWS = ("viscoelastic", "dead_zone")


def test_frequencies_of_the_nominal_rig():
    rig = nominal_rig().drivetrain
    assert len(rig.inertias) >= 4
    assert eigenfrequencies(rig)[0] == pytest.approx(0.0, abs=1e-3)
    assert eigenfrequencies(rig)[1] == pytest.approx(100.0, abs=1.5)
    assert eigenfrequencies(rig)[2] == pytest.approx(750.0, abs=20.0)
    assert motor_zeros(rig)[0] == pytest.approx(38.0, abs=0.5)
    assert sum(rig.inertias) == pytest.approx(0.1292, abs=1e-12)


def test_the_rig_is_made_from_the_finite_element_model():
    reduced = reduce_to_chain(paper_powertrain(), 4, gap=GAP, band=(5.0, 900.0), gap_shaft=2)
    assert tuple(round(j, 6) for j in reduced.drivetrain.inertias) == INERTIAS
    # The search ends where its last digits depend on the linear algebra library.
    assert [shaft.stiffness for shaft in reduced.drivetrain.shafts] == pytest.approx(STIFFNESSES, rel=1e-4)


def test_backlash_lies_in_the_joint_at_the_load_end():
    rig = nominal_rig().drivetrain
    gaps = [i for i, shaft in enumerate(rig.shafts) if shaft.has_backlash]
    assert gaps == [len(rig.shafts) - 1]
    assert rig.shafts[gaps[0]].backlash == 0.012
    assert rig.inertias[gaps[0]] <= 5e-4
    assert rig.actuator.lag <= 5e-4
    assert rig.frictions[-1].stribeck[0][1] > 0.0


def test_contact_law_is_no_observers_law():
    for rig in (nominal_rig(), varied_rig(3)):
        laws = {shaft.contact for shaft in rig.drivetrain.shafts if shaft.has_backlash}
        assert laws == {"physical"}
        assert not laws & set(MODEL_LAWS)


def test_encoder_resolution_and_torque_sensor():
    sensors = nominal_rig().sensors
    assert sensors["speed_motor"].difference
    assert 2.0 * np.pi / sensors["speed_motor"].resolution >= 2**18
    assert sensors["torque_shaft"].noise > 0.0


def test_family_varies_within_its_ranges():
    rigs = [varied_rig(seed).drivetrain for seed in range(1, 60)]
    rows = np.array(
        [
            [j / n for j, n in zip(r.inertias, INERTIAS, strict=True)]
            + [s.stiffness / n for s, n in zip(r.shafts, STIFFNESSES, strict=True)]
            + [
                r.shafts[-1].backlash / BACKLASH,
                r.frictions[-1].coulomb / COULOMB,
                r.frictions[-1].viscous / VISCOUS,
            ]
            for r in rigs
        ]
    )
    spread = np.array([SPREAD_STRUCTURE] * 7 + [SPREAD_FRICTION] * 3)
    assert (SPREAD_STRUCTURE, SPREAD_FRICTION) == (0.10, 0.20)
    assert np.all(np.abs(rows - 1.0) <= spread + 1e-12)
    assert np.all(np.ptp(rows, axis=0) > 1.6 * spread)
    assert varied_rig(7) == varied_rig(7)


def test_a_negative_seed_is_refused(tmp_path):
    for make in (varied_rig, lm.rig.record, lambda seed: run(seed=seed, out=tmp_path / "out")):
        with pytest.raises(lm.InvalidInput, match="seed"):
            make(-1)


def torque(n: int = 3000) -> np.ndarray:
    return 8.0 * np.sign(np.sin(np.arange(n) * 0.01)) + np.random.default_rng(0).standard_normal(n)


def test_recording_holds_no_truth():
    recording, truth = lm.rig.record(2, torque_motor=torque())
    assert set(recording.names) == {"torque_motor", "speed_motor", "speed_load", "torque_shaft", "twist"}
    assert recording.events == () and not recording.final_state
    assert set(recording.meta) == {"source", "rig_seed", "noise_seed", "speed_from_counts", "averaged"}
    assert set(recording.origin.values()) == {"simulated"}
    for name in ("speed_motor", "speed_load", "torque_shaft", "twist"):
        assert np.any(recording[name] != truth.signals[name])
    resolution = nominal_rig().sensors["speed_motor"].resolution / 1e-4
    steps = recording["speed_motor"] / resolution
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-4)


def test_what_an_estimator_is_given_says_how_it_was_sampled_and_not_from_which_rig():
    recording, _ = lm.rig.record(2, torque_motor=torque(500))
    given = recording.only("torque_motor", "speed_motor")
    assert dict(given.meta) == {"speed_from_counts": True, "averaged": ("speed_motor",)}
    assert given.events == () and not given.final_state


def test_nothing_of_the_rig_is_called_measured():
    law = lm.controllers.pi(dt=1e-3, kp=1.0, ki=5.0)
    recording, truth = lm.rig.record(1, law=law, speed_reference=np.ones(300), dt=1e-3)
    assert recording.origin["speed_reference"] == "reference"
    assert {o for n, o in recording.origin.items() if n != "speed_reference"} == {"simulated"}
    assert set(truth.signals.origin.values()) == {"simulated"}


def test_same_seed_same_bytes():
    def bytes_of(rig: int, noise: int) -> list[bytes]:
        recording, _ = lm.rig.record(rig, torque_motor=torque(500), noise_seed=noise)
        return [recording[name].tobytes() for name in recording.names]

    assert bytes_of(1, 0) == bytes_of(1, 0)
    noisy = [a != b for a, b in zip(bytes_of(1, 0), bytes_of(1, 1), strict=True)]
    assert sum(noisy) == 1  # the torque sensor alone has noise
    assert all(a != b for a, b in zip(bytes_of(1, 0)[1:], bytes_of(2, 0)[1:], strict=True))


def test_channels_are_withheld():
    recording, _ = lm.rig.record(1, torque_motor=torque(200), channels=("speed_motor",))
    assert set(recording.names) == {"torque_motor", "speed_motor"}
    with pytest.raises(lm.InvalidInput, match="channels"):
        lm.rig.record(1, torque_motor=torque(200), channels=("angle_load",))


def test_equivalent_of_a_two_mass_drivetrain_is_itself():
    found = two_mass_equivalent(PAPER.with_parameters(lag=1e-3), np.linspace(-5.0, 5.0, 101))
    for name, value in {**TABLE_I, "lag": 1e-3}.items():
        assert found[name] == pytest.approx(value, rel=1e-9)


def test_equivalent_keeps_sums_and_the_pole():
    rig = nominal_rig().drivetrain
    found = two_mass_equivalent(rig, np.linspace(-20.0, 20.0, 1001))
    model = lm.Drivetrain.two_mass(**found)
    assert model.inertia_motor == pytest.approx(sum(INERTIAS[:3]))
    assert model.inertia_load == INERTIAS[3]
    assert model.pole_frequency == pytest.approx(eigenfrequencies(rig)[1], rel=1e-12)
    assert COULOMB < found["coulomb"] < COULOMB * 1.15
    two_gaps = lm.Drivetrain((1.0, 1.0, 1.0), (lm.Shaft(1e3, backlash=0.1), lm.Shaft(1e3, backlash=0.1)))
    with pytest.raises(lm.InvalidInput, match="two_mass_equivalent"):
        two_mass_equivalent(two_gaps, np.ones(3))


@pytest.mark.parametrize(
    "speeds", [[], [0.0, 0.0], [2.0, -2.0, 0.0], [np.nan, np.inf, -np.inf], [np.inf, 3.0, 3.0, -3.0]]
)
def test_friction_that_the_motion_does_not_tell_is_left_open(speeds):
    found = two_mass_equivalent(nominal_rig().drivetrain, np.array(speeds))
    assert found["coulomb"] is None and found["viscous"] is None
    assert found["inertia_load"] == INERTIAS[3]


def test_friction_is_told_by_the_finite_speeds():
    plant = lm.Drivetrain((0.02, 0.1), (lm.Shaft(5e3),), (lm.Friction(), lm.Friction(1.0, 0.02)))
    found = two_mass_equivalent(plant, np.array([np.nan, 3.0, np.inf, -7.0, 5.0]))
    assert (found["coulomb"], found["viscous"]) == pytest.approx((1.0, 0.02))
    huge = two_mass_equivalent(plant, np.array([1e200, -3e250, 1e300]))
    assert huge["viscous"] == pytest.approx(0.02)


def test_a_load_that_never_moves_is_recorded():
    _, truth = lm.rig.record(1, torque_motor=np.zeros(100))
    assert truth.parameters["coulomb"] is None


def test_finer_rig_lies_within_the_intervals():
    intervals = {"inertia_load": (0.1, 0.12), "backlash": (0.011, 0.013), "stiffness": (6000.0, 6500.0)}
    drawn = []
    for seed in range(20):
        rig = finer_rig(PAPER, intervals, seed).drivetrain
        found = two_mass_equivalent(rig, np.array([-20.0, -10.0, 10.0, 20.0]))
        drawn.append([found[name] for name in intervals])
        for name, (low, high) in intervals.items():
            assert low * (1 - 1e-9) <= found[name] <= high * (1 + 1e-9)
        assert len(rig.inertias) == 4
        assert rig.shafts[-1].contact == "physical"
    assert np.all(np.ptp(drawn, axis=0) > 0.0)


# Laws in the loop, load torque, start.


def test_a_list_of_laws_does_what_the_joined_law_does():
    observer = lm.observers.kalman(PAPER, dt=1e-4)
    control = lm.controllers.pole_placement(PAPER, dt=1e-4, torque_limit=73.5)
    reference = np.where(np.arange(2000) < 500, -2.0, 2.0)
    joined = lm.connect(
        [observer.renamed({"torque_motor": "torque_motor_acting"}), control,
         lm.one_sample_delay("torque_motor", 1e-4, "torque_motor_acting")],
        inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",),
    )  # fmt: skip
    one, _ = lm.rig.record(3, law=joined, speed_reference=reference)
    # As an input, torque_motor is what acts in this sample: with one sample of delay that of the last step.
    several, truth = lm.rig.record(3, law=[observer, control], speed_reference=reference)
    np.testing.assert_allclose(several["torque_motor"], one["torque_motor"], atol=1e-9)
    assert "speed_load_estimated" in truth.signals and "speed_load_estimated" not in several


def test_a_stepper_is_a_law_like_any_other():
    observer = lm.observers.extended_kalman(PAPER, dt=1e-4)
    control = lm.controllers.hybrid_predictive(
        PAPER, dt=1e-4, largest_error=1.0, largest_torque=73.5, torque_limit=73.5, contact_speed=0.4
    )
    reference = np.where(np.arange(1000) < 300, -1.0, 1.0)
    acting = {"torque_motor": "torque_motor_acting"}
    plant = varied_rig(3)
    sensors = {**plant.sensors, "torque_motor_acting": lm.Sensor("torque_motor")}
    recording, truth = lm.rig.record(
        replace(plant, sensors=sensors), law=[observer.renamed(acting), control], speed_reference=reference
    )
    told = {name: truth.signals[name] for name in control.inputs if name in truth.signals}
    told["torque_motor_acting"] = truth.signals["torque_motor"]
    again = control.run(told)["torque_motor"]
    # One sample of computing delay.
    np.testing.assert_array_equal(truth.signals["torque_motor"][1:], again[:-1])
    assert np.ptp(again) > 50.0 and "speed_load_estimated" not in recording


def test_a_load_torque_acts_and_no_sensor_shows_it():
    pull = np.where(np.arange(1000) < 200, 0.0, 8.0)
    recording, truth = lm.rig.record(1, torque_motor=np.zeros(1000), torque_load=pull)
    np.testing.assert_array_equal(truth.signals["torque_load"], pull)
    assert "torque_load" not in recording
    assert truth.signals["speed_load"][200] == 0.0 and truth.signals["speed_load"][-1] > 1.0


def test_it_starts_where_an_earlier_recording_ended():
    whole, _ = lm.rig.record(1, torque_motor=torque(600))
    _, first = lm.rig.record(1, torque_motor=torque(600)[:250])
    rest, _ = lm.rig.record(1, torque_motor=torque(600)[250:], state=first.signals.final_state)
    # The first count difference of a recording has no sample before it.
    np.testing.assert_allclose(rest["twist"][1:], whole["twist"][251:], atol=1e-9)


@pytest.mark.parametrize("delay", [0, 1, 3])
def test_a_torque_acts_after_its_delay(delay):
    law = lm.controllers.pi(dt=1e-4)
    _, truth = lm.rig.record(1, law=law, speed_reference=np.ones(50), delay=delay)
    assert np.flatnonzero(truth.signals["torque_motor"])[0] == delay
