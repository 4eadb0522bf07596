"""Friction from torque steps, ramps, ladders of speed and any motion: simulated drives with known values, and
two measured ones."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.identification import (
    FrictionFit,
    breakaway,
    evaluate,
    friction_ladder,
    output_error_fit,
    rigid_drive,
    simulate_rigid_drive,
    torque_step,
)
from lostmotion.recording import Recording

DATA = Path(os.environ.get("LOSTMOTION_DATA", Path(__file__).parents[3] / ".." / "shared" / "data"))
INERTIA, COULOMB, VISCOUS, DT = 0.1292, 2.0, 0.0175, 1e-3


def made(
    inertia: float = INERTIA,
    coulomb: tuple[float, float] = (COULOMB, COULOMB),
    viscous: tuple[float, float] = (VISCOUS, VISCOUS),
    offset: float = 0.0,
) -> FrictionFit:
    """A drive of known values, in the form that the simulation takes."""
    values = {
        "inertia": inertia,
        "coulomb_plus": coulomb[0],
        "coulomb_minus": coulomb[1],
        "viscous_plus": viscous[0],
        "viscous_minus": viscous[1],
        "offset": offset,
    }
    return drive_of(values)


def drive_of(values: dict[str, float]) -> FrictionFit:
    sources = dict.fromkeys(values, "nameplate")
    arrays = dict.fromkeys(("time", "torque", "measured", "fitted"), np.zeros(0))
    return FrictionFit(values=values, intervals={}, sources=sources, signal="torque_motor", **arrays)


def turned(
    drive: FrictionFit, torque: np.ndarray, seed: int, *, speed_noise: float = 0.1, torque_noise: float = 0.3
) -> Recording:
    """The drive under a torque that ripples; the speed and the torque are measured with noise."""
    random = np.random.default_rng(seed)
    exact = simulate_rigid_drive(drive, torque + torque_noise * random.standard_normal(torque.size), DT)
    return exact.with_signals(
        "measured",
        torque_motor=exact["torque_motor"] + torque_noise * random.standard_normal(torque.size),
        speed_motor=exact["speed_motor"] + speed_noise * random.standard_normal(torque.size),
    )


def holds(found: FrictionFit, name: str, truth: float) -> bool:
    low, high = found.intervals[name]
    return low <= truth <= high


def step(up: float = 12.0, down: float = 0.0) -> np.ndarray:
    return np.concatenate([np.full(6000, up), np.full(4000, down)])


# The simulation that open-loop errors rest on


def test_one_inertia_is_simulated_as_the_exact_simulation_does() -> None:
    random = np.random.default_rng(1)
    torque = np.repeat(random.uniform(-6.0, 6.0, 200), 10)
    chain = lm.Drivetrain((INERTIA,), frictions=(lm.Friction((2.0, 1.5), 0.3),))
    exact = lm.simulate(chain, dt=DT, torque_motor=torque)
    ours = simulate_rigid_drive(made(coulomb=(2.0, 1.5), viscous=(0.3, 0.3)), torque, DT)
    assert np.ptp(exact["speed_motor"]) > 0.2
    np.testing.assert_allclose(ours["speed_motor"], exact["speed_motor"], atol=1e-12)
    np.testing.assert_allclose(ours["angle_motor"], exact["angle_motor"], atol=1e-12)


def test_viscous_friction_may_differ_by_direction_and_the_offset_counts() -> None:
    drive = made(coulomb=(0.0, 0.0), viscous=(0.5, 2.0), offset=1.0)
    assert simulate_rigid_drive(drive, np.full(9000, 3.0), DT)["speed_motor"][-1] == pytest.approx(4.0)
    assert simulate_rigid_drive(drive, np.full(9000, -3.0), DT)["speed_motor"][-1] == pytest.approx(-2.0)
    with pytest.raises(InvalidInput, match="inertia"):
        simulate_rigid_drive(drive_of({}), np.ones(9), DT)


# Torque step


def test_torque_step_with_known_inertia_holds_the_truth() -> None:
    found = [torque_step(turned(made(), step(), s), inertia=INERTIA) for s in range(20)]
    for name, truth in (("coulomb", COULOMB), ("viscous", VISCOUS)):
        assert sum(holds(f, name, truth) for f in found) >= 17, name
    assert np.median([f.values["coulomb"] for f in found]) == pytest.approx(COULOMB, rel=0.01)
    assert np.median([f.intervals["coulomb"][1] - f.intervals["coulomb"][0] for f in found]) < 0.1
    assert found[0].sources == {"inertia": "nameplate", "coulomb": "identified", "viscous": "identified"}
    assert found[0].relative_error < 0.01


def test_torque_step_tells_the_inertia_where_the_torque_changes() -> None:
    found = [torque_step(turned(made(), step(), s)) for s in range(20)]
    for name, truth in (("inertia", INERTIA), ("coulomb", COULOMB), ("viscous", VISCOUS)):
        assert sum(holds(f, name, truth) for f in found) >= 17, name
    assert np.median([f.values["inertia"] for f in found]) == pytest.approx(INERTIA, rel=0.01)


def test_one_level_of_torque_does_not_tell_the_inertia() -> None:
    found = torque_step(turned(made(), step(12.0, 12.0), 1, torque_noise=0.0))
    assert set(found.values.values()) == {None}
    assert set(found.sources.values()) == {"not excited"}
    assert "one constant torque" in found.problems[0].got


def test_both_directions_and_their_difference() -> None:
    drive = made(coulomb=(2.4, 1.6), viscous=(0.015, 0.02))
    pair = [turned(drive, step(12.0), 3), turned(drive, step(-12.0), 4)]
    found = torque_step(pair, asymmetric=True)
    for name, truth in (
        ("coulomb_plus", 2.4),
        ("coulomb_minus", 1.6),
        ("viscous_plus", 0.015),
        ("viscous_minus", 0.02),
    ):
        assert holds(found, name, truth), name
    assert found.values["coulomb_plus"] == pytest.approx(2.4, rel=0.03)
    # With one Coulomb level for both directions the difference is an offset.
    shared = torque_step([turned(made(offset=0.4), step(12.0), 3), turned(made(offset=0.4), step(-12.0), 4)])
    assert holds(shared, "offset", 0.4)
    assert shared.friction().coulomb_plus == pytest.approx(2.4, rel=0.03)


def test_a_drive_that_does_not_turn_has_no_friction_to_show() -> None:
    found = torque_step(turned(made(), step(1.0), 1, speed_noise=0.0, torque_noise=0.0))
    assert set(found.values.values()) == {None}
    assert "averages while it turns" in found.problems[0].got


def test_commanded_torque_beside_a_measured_one_is_named() -> None:
    recording = turned(made(), step(), 5)
    both = recording.with_signals("reference", torque_motor_reference=0.8 * recording["torque_motor"])
    assert torque_step(both, inertia=INERTIA).problems == ()
    found = torque_step(both, inertia=INERTIA, torque="torque_motor_reference")
    assert found.problems[0].got == "a commanded torque"
    measured = recording.with_signals("measured", torque_motor_measured=recording["torque_motor"])
    assert torque_step(measured, inertia=INERTIA).problems == ()
    assert len(torque_step(measured, inertia=INERTIA, torque="torque_motor").problems) == 1


def test_torque_step_on_the_virtual_rig() -> None:
    torque = np.concatenate([np.zeros(500), np.full(9500, 12.0), np.zeros(3000)])
    recording, truth = lm.rig.record(3, torque_motor=torque, dt=DT)
    total = truth.parameters["inertia_motor"] + truth.parameters["inertia_load"]
    found = torque_step(recording, inertia=total)
    assert found.values["coulomb"] == pytest.approx(truth.parameters["coulomb"], rel=0.01)
    assert found.values["viscous"] == pytest.approx(truth.parameters["viscous"], rel=0.01)
    assert torque_step(recording).values["inertia"] == pytest.approx(total, rel=0.005)


@pytest.mark.parametrize("name", ["idf_pos_0.06_1", "idf_pos_0.06_2", "idf_pos_0.065_1"])
def test_measured_torque_step(name: str) -> None:
    path = DATA / "hsm150" / f"{name}.mat"
    if not path.exists():
        pytest.skip(f"no {path}: set LOSTMOTION_DATA to the folder of measured data")
    channels = {
        "speed_motor": "data[:,3]",
        "torque_motor_reference": {"column": "data[:,4]", "unit": "Nm"},
        "torque_motor": {"column": "data[:,5]", "unit": "Nm"},
    }
    recording = lm.read_recording(path, time="data[:,0]", channels=channels)
    found = torque_step(recording)
    assert 0.90e-4 <= found.values["inertia"] <= 1.28e-4
    # The independent fit's range is given to two digits: to two digits it is compared.
    assert 5.8e-5 <= float(f"{found.values['viscous']:.1e}") <= 7.9e-5
    assert 0.026 <= round(found.values["coulomb"], 3) <= 0.044
    assert found.problems == ()
    commanded = torque_step(recording, torque="torque_motor_reference")
    assert [p.got for p in commanded.problems] == ["a commanded torque"]
    assert commanded.values["inertia"] > found.values["inertia"]


# Any motion of a rigid drive


def wander(drive: FrictionFit, seed: int, noise: float) -> Recording:
    t = DT * np.arange(10000)
    torque = 8.0 * np.sin(2.0 * np.pi * 0.4 * t) + 5.0 * np.sin(2.0 * np.pi * 1.7 * t + seed)
    exact = simulate_rigid_drive(drive, torque, DT)
    random = np.random.default_rng(seed)
    return exact.with_signals(
        "measured", angle_motor=exact["angle_motor"] + noise * random.standard_normal(t.size)
    )


def test_inverse_dynamics_of_known_drives() -> None:
    symmetric = rigid_drive(wander(made(offset=0.5), 1, 2e-6))
    for name, truth in (("inertia", INERTIA), ("coulomb", COULOMB), ("offset", 0.5)):
        assert symmetric.values[name] == pytest.approx(truth, rel=0.02), name
    one_sided = rigid_drive(wander(made(coulomb=(2.4, 1.6)), 1, 2e-6), asymmetric=True)
    assert one_sided.values["coulomb_plus"] == pytest.approx(2.4, rel=0.02)
    assert one_sided.values["coulomb_minus"] == pytest.approx(1.6, rel=0.02)
    known = rigid_drive(wander(made(), 1, 2e-6), inertia=INERTIA)
    assert known.sources["inertia"] == "nameplate"
    assert known.values["coulomb"] == pytest.approx(COULOMB, rel=0.02)


def test_refined_values_are_those_that_made_the_motion() -> None:
    recording = wander(made(coulomb=(2.4, 1.6)), 2, 0.0)
    refined, run = output_error_fit(rigid_drive(recording, asymmetric=True), recording)
    assert refined.values["inertia"] == pytest.approx(INERTIA, rel=1e-4)
    assert refined.values["coulomb_plus"] == pytest.approx(2.4, rel=1e-4)
    assert np.abs(run["angle_motor"] - recording["angle_motor"]).max() < 1e-4


@pytest.mark.parametrize("asymmetric", [False, True])
def test_a_fit_is_tried_on_another_recording(asymmetric: bool) -> None:
    """The relative error on its own recording is the fit's; on another it is as large; with a wrong mass it is not."""
    time = DT * np.arange(10_000)
    drive = made(coulomb=(2.2, 1.8) if asymmetric else (2.0, 2.0))
    motions = [
        turned(drive, 14.0 * np.sin(w * time), seed, speed_noise=0.0) for w, seed in ((6.0, 1), (9.0, 2))
    ]
    found = rigid_drive(motions[0], asymmetric=asymmetric)
    own, other = (evaluate(found, motion) for motion in motions)
    assert own.relative_error == pytest.approx(found.relative_error, rel=1e-9)
    assert own.fitted == pytest.approx(found.fitted)
    assert other.values == found.values
    assert other.relative_error < 1.5 * found.relative_error
    heavy = drive_of({**{n: v for n, v in found.values.items() if v is not None}, "inertia": 1.2 * INERTIA})
    assert evaluate(heavy, motions[1]).relative_error > 2.0 * other.relative_error
    with pytest.raises(InvalidInput, match="no inertia"):
        evaluate(drive_of({"coulomb": 1.0}), motions[0])


def test_short_motions_are_refused() -> None:
    with pytest.raises(InvalidInput, match="at least 400"):
        rigid_drive(wander(made(), 1, 0.0).window(0.0, 0.3))


@pytest.fixture(scope="module")
def emps() -> Recording:
    """Translational: mass (kg) for inertia, force (N) for torque, metres for radians."""
    path = DATA / "emps" / "DATA_EMPS.mat"
    if not path.exists():
        pytest.skip(f"no {path}: set LOSTMOTION_DATA to the folder of measured data")
    # Names without a known unit: no speed is derived, which would cost the first row, where the drive is at rest.
    columns = {"position": "qm", "force": {"column": "vir", "scale": 35.1507}}
    return lm.read_recording(path, time="t", channels=columns)


EMPS = {"inertia": 95.1089, "viscous": 203.5034, "coulomb": 20.3935, "offset": -3.1648}
EMPS_ASYMMETRIC = {
    "inertia": 95.1540,
    "viscous_plus": 166.7061,
    "coulomb_plus": 20.1440,
    "viscous_minus": 240.4236,
    "coulomb_minus": 20.6277,
}


def position_error(recording: Recording, values: dict[str, float]) -> float:
    """Root mean square in mm of the position that the recorded force alone leads to, from rest."""
    run = simulate_rigid_drive(
        drive_of(values), recording["force"], recording.dt, angle=recording["position"][0]
    )
    return 1e3 * float(np.sqrt(np.mean((run["angle_motor"] - recording["position"]) ** 2)))


def test_emps_symmetric(emps: Recording) -> None:
    found = rigid_drive(emps, angle="position", torque="force")
    for name, published in EMPS.items():
        assert found.values[name] == pytest.approx(published, rel=5e-3), name
        assert holds(found, name, published)
    assert found.relative_error <= 0.041


def test_emps_has_the_published_mass_for_identify_as_well(emps: Recording) -> None:
    """Which takes it for two masses of 60 kg; the speed is that of the counts."""
    speed = np.diff(emps["position"], prepend=emps["position"][0]) / emps.dt
    signals = {"torque_motor": emps["force"], "speed_motor": speed}
    recording = Recording(emps.time, signals, meta={"speed_from_counts": True})
    start = lm.Drivetrain.two_mass(
        inertia_motor=60.0, inertia_load=60.0, stiffness=1.07e6, damping=10.0, coulomb=20.0, viscous=200.0
    )
    found = lm.identify(recording, start=start, second_estimator=False)
    low, high = found.intervals["inertia_total"]
    assert found.values["inertia_total"] == pytest.approx(EMPS["inertia"], rel=0.005)
    assert low < EMPS["inertia"] < high < 1.06 * low


def test_emps_asymmetric(emps: Recording) -> None:
    found = rigid_drive(emps, angle="position", torque="force", asymmetric=True)
    for name, published in EMPS_ASYMMETRIC.items():
        assert found.values[name] == pytest.approx(published, rel=5e-3), name
    assert found.relative_error <= 0.0315
    assert position_error(emps, dict(found.values)) <= 2.66


def test_emps_open_loop(emps: Recording) -> None:
    assert position_error(emps, EMPS_ASYMMETRIC) <= 2.66
    assert position_error(emps, EMPS) == pytest.approx(6.93, abs=0.25)
    best, _ = output_error_fit(
        rigid_drive(emps, angle="position", torque="force", asymmetric=True), emps, angle="position"
    )
    assert 1e3 * np.sqrt(np.mean((best.fitted - best.measured) ** 2)) <= 1.75


# Breakaway


def ramps(level: float, rate: float, seed: int) -> Recording:
    """Up and down, three times; the friction falls at once from the breakaway level to Coulomb."""
    ramp = np.concatenate([np.arange(0.0, 4.0, rate * DT), np.zeros(2500)])
    drive = lm.Drivetrain((INERTIA,), frictions=(lm.Friction(2.0, 0.0175, breakaway=level),))
    run = lm.simulate(drive, dt=DT, torque_motor=np.concatenate([ramp, -ramp] * 3))
    count = 2.0 * np.pi / 2**16
    noisy = run["angle_motor"] + 0.3 * count * np.random.default_rng(seed).standard_normal(len(run))
    return run.with_signals("measured", angle_motor=np.floor(noisy / count) * count)


@pytest.mark.parametrize(("level", "rate"), [(2.3, 1.0), (2.0, 1.0), (2.8, 4.0)])
def test_breakaway_from_ramps(level: float, rate: float) -> None:
    found = breakaway(ramps(level, rate, 1))
    for name in ("breakaway_plus", "breakaway_minus"):
        low, high = found.intervals[name]
        assert low <= level <= high, name
        assert high - low < 0.1 * level
        assert found.values[name] == pytest.approx(level, rel=0.03)
    assert len(found.starts) == 6
    assert found.problems == ()


def test_breakaway_behind_a_shaft_with_a_gap() -> None:
    ramp = np.concatenate([np.linspace(0.0, 4.0, 4000), np.zeros(3000)])
    recording, truth = lm.rig.record(3, torque_motor=np.concatenate([ramp, -ramp] * 2), dt=DT)
    angle = DT * np.cumsum(recording["speed_motor"])
    found = breakaway(recording.with_signals("derived", angle_motor=angle))
    level = max(truth.drivetrain.frictions[-1].level_at_rest)
    low, high = found.intervals["breakaway_plus"]
    assert low <= level <= high
    assert found.values["breakaway_plus"] == pytest.approx(level, rel=0.01)


def test_one_ramp_and_no_start_are_named() -> None:
    recording = ramps(2.3, 1.0, 1)
    one = breakaway(recording.window(0.0, 4.0))
    assert one.problems[0].got == "one ramp"
    assert one.values["breakaway_minus"] is None
    none = breakaway(recording.window(0.0, 2.0))
    assert none.values == {"breakaway_plus": None, "breakaway_minus": None}
    assert none.at_rest == pytest.approx(2.0, abs=0.01)


# Ladder of speeds

CURVE = lm.Friction(2.0, 0.0175, stribeck=((0.0, 0.3), (0.4, 0.154), (0.8, 0.079), (1.6, 0.021), (3.0, 0.0)))


def ladder(speeds: list[float], seed: int, hold: float = 1.0) -> Recording:
    """Plateaus as a perfect speed controller would hold them, with torque noise."""
    reference = np.repeat(speeds, round(hold / DT))
    noise = np.random.default_rng(seed).standard_normal((2, reference.size))
    torque = np.repeat([CURVE.torque(w) for w in speeds], round(hold / DT))
    return Recording(
        DT * np.arange(reference.size),
        {
            "speed_reference": reference,
            "speed_motor": reference + 0.01 * noise[0],
            "torque_motor": torque + 0.05 * noise[1],
        },
    )


def holds_rise(interval: tuple[float, float], truth: float) -> bool:
    return interval[0] <= truth <= interval[1]


SPEEDS = [0.15, 0.3, 0.5, 0.8, 1.2, 2.0, 4.0, 8.0, 16.0, 32.0]


def test_stribeck_from_a_ladder() -> None:
    found = friction_ladder(ladder([s * w for s in (1.0, -1.0) for w in SPEEDS], 1))
    for name, truth in (("coulomb", 2.0), ("viscous", 0.0175), ("offset", 0.0)):
        low, high = found.intervals[name]
        assert low <= truth <= high, name
    assert found.values["stribeck"] == pytest.approx(0.3, rel=0.15)
    assert holds_rise(found.intervals["stribeck"], 0.3)
    assert found.exponent == 1.0
    for w in (0.15, 0.8, 4.0, -16.0):
        assert float(found.curve(w)) == pytest.approx(CURVE.torque(w), abs=0.02)
    # Fit for a drivetrain: the polyline follows the curve.
    friction = found.friction()
    assert friction.torque(0.5) == pytest.approx(float(found.curve(0.5)), abs=0.02)


def test_no_stribeck_rise_is_claimed_where_the_ladder_begins_too_fast() -> None:
    found = friction_ladder(ladder([4.0, 8.0, 12.0, 16.0, 24.0, 32.0], 2))
    assert found.values["stribeck"] is None
    assert found.sources["stribeck"] == "not excited"
    assert found.values["coulomb"] == pytest.approx(2.0, abs=0.03)
    assert "offset" not in found.values


def test_plateaus_that_slip_and_stick_are_left_out() -> None:
    recording = ladder(SPEEDS, 3)
    speed = np.array(recording["speed_motor"])
    speed[:1000] *= 1.0 + np.sign(np.sin(60.0 * recording.time[:1000]))
    found = friction_ladder(recording.with_signals("measured", speed_motor=speed))
    assert not found.steady[0]
    assert found.steady[1:].all()
    assert "scatters" in found.problems[0].got


def test_too_few_plateaus_give_no_number() -> None:
    found = friction_ladder(ladder([1.0, 2.0], 4))
    assert set(found.values.values()) == {None}
    assert "2 steady plateaus" in found.problems[-1].got
    with pytest.raises(InvalidInput, match="no friction"):
        found.friction()


def test_plateaus_are_found_from_the_motion_alone() -> None:
    """Levels behind ramps, with noise and a standstill; ramps and slow waves are no plateaus."""
    speeds = [2.0, 4.0, 8.0, 16.0, 0.0, -3.0, -9.0, -15.0]
    levels = np.repeat(speeds, 1500)
    ramps = np.convolve(np.r_[np.zeros(600), levels], np.full(601, 1.0 / 601.0), "valid")
    noise = np.random.default_rng(5).standard_normal((2, ramps.size))
    torque = INERTIA * np.gradient(ramps, DT) + COULOMB * np.sign(ramps) + VISCOUS * ramps
    time = DT * np.arange(ramps.size)
    signals = {"speed_motor": ramps + 0.05 * noise[0], "torque_motor": torque + 0.05 * noise[1]}
    found = friction_ladder(Recording(time, signals), stribeck=False)
    assert found.speed == pytest.approx([w for w in speeds if w], rel=0.01)
    for name, truth in (("coulomb", COULOMB), ("viscous", VISCOUS), ("offset", 0.0)):
        low, high = found.intervals[name]
        assert low <= truth <= high, name
    for wave in (0.1 * time, 5.0 + 4.0 * np.sin(2.0 * np.pi * time / 3.0)):
        assert friction_ladder(Recording(time, signals | {"speed_motor": wave})).speed.size == 0


def test_without_stribeck_two_plateaus_less_are_needed() -> None:
    recording = ladder([4.0, 8.0, 16.0, 32.0], 2)
    found = friction_ladder(recording, stribeck=False)
    assert found.values["coulomb"] == pytest.approx(2.0, abs=0.05)
    assert found.values["stribeck"] is None
    slow = friction_ladder(ladder(SPEEDS, 1), stribeck=False)
    assert slow.values["stribeck"] is None and slow.values["coulomb"] is not None
    assert slow.values["coulomb"] > 2.05  # a straight line through what rises towards rest
