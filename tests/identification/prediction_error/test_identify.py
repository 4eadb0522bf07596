"""Identification by prediction error: exact models, the virtual rig, what is not excited, and misuse."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import binomtest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.identification import Identification
from lostmotion.identification.prediction_error.innovations import NAMES
from lostmotion.io import read_recording, write_csv
from lostmotion.recording import Recording

DT = 1e-4
LAGGED = {**TABLE_I, "lag": 3e-4}
PLANT = lm.Drivetrain.two_mass(**LAGGED)
#: What an identification says values of.
TRUTH = {**LAGGED, "inertia_total": PLANT.inertia_total}
COUNT = 2.0 * np.pi / 2**20
#: Largest relative errors on the virtual rig.
TARGETS = {"inertia_motor": 0.04, "inertia_load": 0.015, "stiffness": 0.04, "backlash": 0.04, "coulomb": 0.04}


def off_by_two(values: dict[str, float], seed: int) -> lm.Drivetrain:
    """Every parameter doubled or halved."""
    signs = np.random.default_rng(seed).choice([-1.0, 1.0], len(NAMES))
    return lm.Drivetrain.two_mass(**{n: values[n] * 2.0**s for n, s in zip(NAMES, signs, strict=True)})


def counted(recording: Recording, phase: float = 0.0) -> Recording:
    """Motor torque and the speed that a 20 bit encoder gives, a mean over the sample before."""
    counts = np.floor(recording["angle_motor"] / COUNT + phase)
    speed = np.diff(counts, prepend=counts[0]) * COUNT / DT
    return recording.only("torque_motor").with_signals("measured", speed_motor=speed)


def excitation(duration: float, seed: int, viscous: float) -> np.ndarray:
    """Strong noise at modest speeds: the shaft's parameters count more than viscous friction."""
    return lm.signals.excitation(
        duration, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=viscous,
        levels=(10.0, 25.0, -10.0, -25.0, 15.0, -15.0), ramp=0.5, noise_rms=7.0,
    )  # fmt: skip


@cache
def simulated(seed: int = 1, duration: float = 10.0) -> Recording:
    torque = excitation(duration, seed=seed, viscous=0.0175)
    return lm.simulate(PLANT, torque_motor=torque, dt=DT)


#: Calls of the progress of ``found_from_counts``.
CALLS: list[tuple[float, str]] = []


@cache
def found_from_counts() -> Identification:
    start = off_by_two(LAGGED, 0)
    return lm.identify(
        counted(simulated()), start=start, progress=lambda share, text: CALLS.append((share, text))
    )


@cache
def on_rig(seed: int) -> tuple[Identification, dict[str, float]]:
    recording, truth = lm.rig.record(seed)
    values = {**truth.parameters, "inertia_total": truth.drivetrain.inertia_total}
    return lm.identify(recording, start=off_by_two(truth.parameters, seed)), values


def error(found: Identification, truth: dict[str, float], name: str) -> float:
    value = found.values[name]
    assert value is not None
    return abs(value / truth[name] - 1.0)


def test_exact_model_with_exact_speed():
    """What is left is the observer's discretisation: 0.1 % at 0.1 ms."""
    recording = simulated().only("torque_motor", "speed_motor")
    start = off_by_two(LAGGED, 1)
    found = lm.identify(recording, start=start, speed_from_counts=False, second_estimator=False)
    limits = dict.fromkeys(NAMES, 0.003) | {"viscous": 0.02, "lag": 0.02}
    assert {n: error(found, LAGGED, n) for n in NAMES if error(found, LAGGED, n) > limits[n]} == {}
    assert found.prediction.unmodelled_frequency is None
    assert found.drivetrain.contact == "viscoelastic"


def test_exact_model_with_encoder_counts():
    found = found_from_counts()
    limits = dict.fromkeys(NAMES, 0.004) | {"viscous": 0.03, "lag": 0.05}
    assert {n: error(found, LAGGED, n) for n in NAMES if error(found, LAGGED, n) > limits[n]} == {}
    assert set(found.sources.values()) == {"identified"}
    # The residual is the rounding of the encoder: two roundings of 1/√12 count per sample.
    assert found.prediction.rms == pytest.approx(COUNT / DT / np.sqrt(6.0), rel=0.05)
    assert found.prediction.fit > 0.99


def test_speed_taken_as_instantaneous_is_worse():
    """The mean over the sample lags by half a sample: taken as instantaneous, it shows as lag."""
    recording = counted(simulated())
    found = lm.identify(recording, start=PLANT, speed_from_counts=False, second_estimator=False)
    lag = found.values["lag"]
    assert lag is not None and lag - LAGGED["lag"] == pytest.approx(0.5 * DT, rel=0.2)
    assert found.prediction.rms > found_from_counts().prediction.rms


def test_intervals_hold_the_truth_as_often_as_they_say():
    hits = []
    for seed in range(2, 8):
        found = lm.identify(counted(simulated(seed, 5.0), phase=0.1 * seed), start=PLANT)
        hits += [low <= TRUTH[n] <= high for n, (low, high) in found.intervals.items()]
    assert len(hits) == 6 * len(TRUTH)
    # Too few only where chance would hardly make it so: the last digits move single intervals over the truth.
    assert binomtest(sum(hits), len(hits), 0.95, "less").pvalue > 0.005


def test_intervals_shrink_with_the_recording():
    """The recording of 10 s tells more of every kind of motion than its first second alone, to the same estimator."""
    short = lm.identify(counted(simulated()).window(0.0, 1.0), start=PLANT, second_estimator=False)
    wider = [
        name
        for name in short.names
        if np.ptp(short.intervals[name]) > 1.3 * np.ptp(found_from_counts().intervals[name])
    ]
    assert "coulomb" in wider or short.sources["coulomb"] == "not excited"
    assert "viscous" in wider or short.sources["viscous"] == "not excited"


@pytest.mark.parametrize("seed", [1, 3, 4])
def test_rig_within_the_targets(seed: int):
    found, truth = on_rig(seed)
    assert {n: error(found, truth, n) for n, most in TARGETS.items() if error(found, truth, n) > most} == {}
    outside = [n for n, (low, high) in found.intervals.items() if not low <= truth[n] <= high]
    assert outside == []


def test_counts_are_recognised_in_a_file_that_does_not_say_so(tmp_path: Path):
    recording, truth = lm.rig.record(1)
    write_csv(tmp_path / "rig.csv", recording.window(0.0, 4.0), names=("torque_motor", "speed_motor"))
    found = lm.identify(read_recording(tmp_path / "rig.csv"), start=off_by_two(truth.parameters, 1))
    assert found.speed_from_counts is True
    low, high = found.intervals["lag"]
    assert truth.parameters["lag"] == pytest.approx(3e-4) and low <= 3e-4 <= high


@pytest.mark.parametrize("stated", [True, False])
def test_what_is_stated_of_counts_is_kept(stated: bool):
    recording = counted(simulated()).window(0.0, 1.0)
    argument = lm.identify(recording, start=PLANT, speed_from_counts=stated, second_estimator=False)
    told = replace(recording, meta={"speed_from_counts": stated})
    meta = lm.identify(told, start=PLANT, second_estimator=False)
    assert argument.speed_from_counts is stated and meta.speed_from_counts is stated


def test_rig_says_what_is_poorly_known():
    found, _ = on_rig(1)
    relative = {
        n: (high - low) / 2.0 / getattr(found.drivetrain, n) for n, (low, high) in found.intervals.items()
    }
    assert relative["lag"] > 0.1 and relative["viscous"] > 0.05
    assert relative["inertia_load"] < 0.03
    assert found.prediction.unmodelled_frequency == pytest.approx(750.0, abs=80.0)
    assert any("peak at" in p.got for p in found.problems)


def test_any_start_within_a_factor_of_two_gives_the_same():
    """One descent from the last of these starts ends in another minimum, whose innovations are a third larger."""
    recording, truth = lm.rig.record(2)
    values = [lm.identify(recording, start=off_by_two(truth.parameters, s)).values for s in (20, 24)]
    for name in ("inertia_motor", "inertia_load", "stiffness", "backlash", "coulomb"):
        column = [v[name] for v in values]
        assert max(column) / min(column) - 1.0 < 2e-3, name


def test_nothing_but_torque_and_speed_is_used():
    whole, truth = lm.rig.record(1)
    recording = whole.window(0.0, 2.0)
    bare = recording.only("torque_motor", "speed_motor")
    spoilt = recording.with_signals(
        "measured", speed_load=np.full(len(recording), np.nan), torque_shaft=np.zeros(len(recording))
    )
    start = off_by_two(truth.parameters, 1)
    results = [lm.identify(r, start=start) for r in (recording, bare, spoilt)]
    assert results[0].values == results[1].values == results[2].values
    assert results[0].intervals == results[1].intervals == results[2].intervals


def test_nameplate_without_backlash_damping_friction_and_lag():
    start = lm.Drivetrain.two_mass(inertia_motor=0.03, inertia_load=0.08, stiffness=9000.0)
    found = lm.identify(counted(simulated()), start=start)
    limits = dict.fromkeys(NAMES, 0.004) | {"viscous": 0.03, "lag": 0.05}
    assert {n: error(found, LAGGED, n) for n in NAMES if error(found, LAGGED, n) > limits[n]} == {}


def test_fixed_values_stay():
    plant = PLANT.with_parameters(viscous=0.0)
    run = lm.simulate(plant, torque_motor=excitation(1.5, seed=1, viscous=0.0), dt=DT)
    start = plant.with_parameters(stiffness=9000.0)
    found = lm.identify(counted(run), start=start, fixed=("backlash", "viscous"))
    assert found.drivetrain.backlash == pytest.approx(PLANT.backlash, rel=1e-12)
    assert found.drivetrain.viscous == 0.0
    assert found.sources["backlash"] == found.sources["viscous"] == "nameplate"
    assert "backlash" not in found.intervals and found.values["backlash"] == pytest.approx(PLANT.backlash)
    assert error(found, LAGGED, "stiffness") < 0.005 and error(found, LAGGED, "inertia_load") < 0.005


def test_friction_of_the_motor_stays_as_given():
    plant = PLANT.with_parameters(viscous_motor=0.01)
    torque = excitation(5.0, seed=3, viscous=0.0275)
    recording = counted(lm.simulate(plant, torque_motor=torque, dt=DT))
    known = lm.identify(recording, start=plant.with_parameters(stiffness=4000.0))
    # The second estimator would see at which end the friction is.
    unknown = lm.identify(recording, start=PLANT, second_estimator=False)
    assert known.drivetrain.viscous_motor == 0.01
    assert error(known, LAGGED, "viscous") < 0.1
    assert error(unknown, LAGGED, "viscous") > 0.2, "left out, it must show up at the load"


@pytest.mark.parametrize("exact", [True, False])
def test_a_torque_that_never_reverses_does_not_tell_the_backlash(exact: bool):
    """Not even with an exact speed, where the first transient of the observer might seem to tell it."""
    torque = 4.0 + lm.signals.noise(5.0, 120.0, 0.6, 3.0, DT, seed=3)
    run = lm.simulate(PLANT, torque_motor=torque, dt=DT, state=(0.0066, 10.0, 10.0))
    recording = run if exact else counted(run)
    start = PLANT.with_parameters(backlash=0.02, stiffness=4000.0)
    found = lm.identify(recording, start=start)
    assert found.sources["backlash"] == "not excited"
    assert found.values["backlash"] is None and "backlash" not in found.intervals
    assert found.drivetrain.backlash == pytest.approx(0.02)
    # One in twenty 95 % intervals may miss, but not by more than twice its half width.
    assert all(abs(found.values[n] - TRUTH[n]) < high - low for n, (low, high) in found.intervals.items())
    assert error(found, LAGGED, "stiffness") < 0.03
    (problem,) = [p for p in found.problems if p.where == "backlash"]
    assert problem.severity == "warning" and "reversals" in problem.remedy and "0.02 rad" in problem.remedy
    # Nearly constant acceleration: with the noise of counts, friction and inertia are hard to tell apart.
    assert any("correlations" in p.got for p in found.problems) != exact


def test_closed_loop_with_dither():
    rng = np.random.default_rng(3)
    levels = np.repeat([10.0, 25.0, -10.0, -25.0, 15.0, -15.0], 16667)[:100000]
    smooth = np.convolve(np.r_[np.zeros(5000), levels], np.ones(5000) / 5000.0, "valid")[:100000]
    reference = smooth + lm.signals.noise(2.0, 120.0, 0.8, 10.0, DT, seed=int(rng.integers(100)))
    law = lm.controllers.pi(kp=10.0, ki=200.0, dt=DT, torque_limit=73.5)
    recording, truth = lm.rig.record(1, law=law, speed_reference=reference)
    found = lm.identify(recording, start=off_by_two(truth.parameters, 5))
    for name, most in TARGETS.items():
        assert error(found, truth.parameters, name) < most, name


def test_closed_loop_out_of_a_poor_minimum():
    """Where the observer loses the motion for moments, plain descents left the load inertia 1.3, Coulomb 6 % off."""
    levels = np.repeat([10.0, 25.0, -10.0, -25.0, 15.0, -15.0], 16667)[:100000]
    ramps = np.convolve(np.r_[np.zeros(5000), levels], np.ones(5000) / 5000.0, "valid")[:100000]
    dither = lm.signals.noise(2.0, 120.0, 0.8, 10.0, DT, seed=14)
    law = lm.controllers.pi(kp=10.0, ki=200.0, dt=DT, torque_limit=lm.rig.TORQUE_LIMIT)
    recording, truth = lm.rig.record(14, law=law, speed_reference=ramps + dither)
    signs = np.random.default_rng([14, 77]).choice([-1.0, 1.0], len(NAMES))
    values = {n: truth.parameters[n] * 2.0**s for n, s in zip(NAMES, signs, strict=True)}
    found = lm.identify(recording, start=lm.Drivetrain.two_mass(**values))
    assert error(found, truth.parameters, "inertia_load") < 0.01
    assert error(found, truth.parameters, "coulomb") < 0.04


def test_closed_loop_without_dither_still_finds_most():
    """Set-point ramps alone: the damping is hardly excited, all else is found, by two dozen reversals."""
    levels = np.repeat([10.0, 25.0, -10.0, -25.0, 15.0, -15.0], 16667)[:100000]
    reference = np.convolve(np.r_[np.zeros(5000), levels], np.ones(5000) / 5000.0, "valid")[:100000]
    law = lm.controllers.pi(kp=10.0, ki=200.0, dt=DT, torque_limit=73.5)
    recording, truth = lm.rig.record(1, law=law, speed_reference=reference)
    # The fit alone: the second estimator takes half a minute more.
    found = lm.identify(recording, start=off_by_two(truth.parameters, 5), second_estimator=False)
    low, high = found.intervals.get("damping", (0.0, np.inf))
    assert low < truth.parameters["damping"] < high and high > 2.0 * low
    low, high = found.intervals["stiffness"]
    assert low < truth.parameters["stiffness"] < high
    assert high - low > 0.04 * truth.parameters["stiffness"], "the nameplate's damping must widen it"
    for name in ("inertia_motor", "inertia_load", "backlash", "coulomb"):
        assert error(found, truth.parameters, name) < 0.02, name


def test_torque_of_the_wrong_sign_is_told():
    recording = counted(simulated(1, 2.5))
    wrong = recording.with_signals("measured", torque_motor=-recording["torque_motor"])
    found = lm.identify(wrong, start=PLANT, second_estimator=False)
    (problem,) = [p for p in found.problems if p.where == "torque_motor"]
    assert "sign" in problem.remedy
    assert not [p for p in found_from_counts().problems if p.where == "torque_motor"]


def test_progress_runs_from_zero_to_one():
    found_from_counts()
    shares = [share for share, _ in CALLS]
    assert shares[0] == 0.0 and shares[-1] == 1.0 and shares == sorted(shares)
    assert all(text for _, text in CALLS)


def broken(**signals: np.ndarray) -> Recording:
    return counted(simulated(1, 2.5)).with_signals("measured", **signals)


def test_misuse_is_told_at_once():
    good = counted(simulated(1, 2.5))
    spoilt = good["speed_motor"].copy()
    spoilt[1234] = np.inf
    with pytest.raises(lm.InvalidInput, match=r"speed_motor.*row 1234"):
        lm.identify(broken(speed_motor=spoilt), start=PLANT)
    with pytest.raises(lm.InvalidInput, match="a moving signal"):
        lm.identify(broken(torque_motor=np.ones(len(good))), start=PLANT)
    with pytest.raises(lm.InvalidInput, match="Check the unit"):
        lm.identify(broken(speed_motor=1e9 * good["speed_motor"]), start=PLANT)
    with pytest.raises(lm.InvalidInput, match="every parameter"):
        lm.identify(good, start=PLANT, fixed=NAMES)
    with pytest.raises(lm.InvalidInput, match="at least 1000 rows"):
        lm.identify(good.window(0.0, 0.05), start=PLANT)
    with pytest.raises(lm.InvalidInput, match="torque_motor"):
        lm.identify(good.only("speed_motor"), start=PLANT)
    with pytest.raises(lm.InvalidInput, match="stifness"):
        lm.identify(good, start=PLANT, fixed=("stifness",))
    with pytest.raises(lm.InvalidInput, match="two masses"):
        lm.identify(good, start=lm.Drivetrain((0.01,)))
    time = good.time + 0.3 * DT * (np.arange(len(good)) % 2)
    with pytest.raises(lm.InvalidInput, match="uniform raster"):
        lm.identify(Recording(time=time, signals=good.signals), start=PLANT)
