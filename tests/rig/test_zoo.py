"""The zoo of drives: the same from the same seed, within its ranges, physically plausible, judged by a fixed rule."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import combinations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.rig import Drive, cramer_rao, drive, eigenfrequencies
from lostmotion.rig.zoo import draws
from lostmotion.rig.zoo.draws import Draw
from lostmotion.rig.zoo.plants import Plant, plant
from lostmotion.rig.zoo.truth import ABSENT_IF_RIGID, equivalent

#: Drives that are made whole: rigid (1, 28), two masses (3, 22), chains, a second gap (7).
WHOLE = (1, 3, 7, 22, 23, 27, 28, 49)


@cache
def plants() -> list[Plant]:
    return [plant(Draw(seed)) for seed in range(400)]


@cache
def made(seed: int) -> Drive:
    return drive(seed)


def inside(values: list[float], bounds: tuple[float, float], filled: float = 0.8) -> None:
    """All within the bounds, and most of their logarithmic span is reached."""
    low, high = min(values), max(values)
    assert bounds[0] * (1.0 - 1e-9) <= low and high <= bounds[1] * (1.0 + 1e-9)
    assert np.log(high / low) > filled * np.log(bounds[1] / bounds[0])


def test_the_same_seed_makes_the_same_bytes():
    first, second = drive(23), drive(23)
    assert first.nameplate == second.nameplate
    assert first.truth.drivetrain == second.truth.drivetrain
    assert first.dimensions == second.dimensions
    for name in first.recording.names:
        assert np.array_equal(first.recording[name], second.recording[name])
    assert not np.array_equal(first.recording["speed_motor"][:100], made(22).recording["speed_motor"][:100])


def test_a_draw_depends_on_seed_and_name_alone():
    draw = Draw(5)
    before = draw.uniform("one", 0.0, 1.0)
    draw.uniform("another", 0.0, 1.0)
    assert draw.uniform("one", 0.0, 1.0) == before
    assert Draw(6).uniform("one", 0.0, 1.0) != before


def test_the_sets_of_seeds_are_disjoint():
    assert set(draws.SETS) == {"development", "calibration", "test"}
    for one, other in combinations(draws.SETS.values(), 2):
        assert not set(one) & set(other)
        assert len(one) >= 1000


def test_plants_fill_their_ranges():
    chains = [p for p in plants() if p.windup > 0.0]
    inside([p.drivetrain.inertia_total for p in plants()], draws.INERTIA)
    inside([p.pole for p in plants()], draws.POLE)
    inside([p.rating.acceleration_time for p in plants()], draws.ACCELERATION_TIME)
    sides = [equivalent(replace(p.drivetrain, shafts=one_gap(p)), None, 0.0) for p in chains]
    ratios = [s["inertia_load"] / s["inertia_motor"] for s in sides if s["inertia_motor"]]
    inside(ratios, draws.RATIO)
    gaps = [max(s.backlash for s in p.drivetrain.shafts) / p.windup for p in chains]
    inside([gap for gap in gaps if gap > 0.0], draws.BACKLASH)
    assert 0.05 < np.mean([not p.windup for p in plants()]) < 0.15, "one in ten is rigid"
    assert 0.10 < np.mean([gap == 0.0 for gap in gaps]) < 0.24, "one in six has no gap"
    assert {len(p.drivetrain.inertias) for p in plants()} == {1, 2, 3, 4, 5}
    laws = {s.contact for p in chains for s in p.drivetrain.shafts if s.has_backlash}
    assert laws == set(draws.LAWS)


def one_gap(p: Plant) -> tuple[lm.Shaft, ...]:
    largest = max(s.backlash for s in p.drivetrain.shafts)
    return tuple(s if s.backlash == largest else replace(s, backlash=0.0) for s in p.drivetrain.shafts)


def test_ranges_are_independent():
    """Log-uniform draws of different names do not go together."""
    names = ("inertia", "ratio", "pole", "backlash", "coulomb load", "samples per period")
    values = np.array([[Draw(seed).uniform(name, 0.0, 1.0) for name in names] for seed in range(400)])
    correlation = np.corrcoef(values.T) - np.eye(len(names))
    assert np.max(np.abs(correlation)) < 4.0 / np.sqrt(400)


def test_plants_are_plausible():
    for p in plants():
        chain, rated = p.drivetrain, p.rating
        assert rated.torque * rated.acceleration_time == pytest.approx(chain.inertia_total * rated.speed)
        assert p.windup <= draws.MOST_WIND_UP * (1.0 + 1e-9)
        for friction in chain.frictions:
            assert (
                friction.coulomb_plus + friction.coulomb_minus
                <= 2.0 * draws.COULOMB[1] * rated.torque * 1.001
            )
            assert friction.viscous * rated.speed <= draws.VISCOUS[1] * rated.torque * 1.001
        if len(chain.inertias) > 1:
            assert eigenfrequencies(chain)[1] == pytest.approx(p.pole)


@pytest.mark.parametrize("seed", WHOLE)
def test_a_drive_is_plausible(seed: int):
    d = made(seed)
    x, rows = d.dimensions, len(d.recording)
    periods = rows * d.recording.dt * x["pole"]
    assert periods > 0.98 * draws.LEAST_PERIODS
    assert rows <= draws.MOST_ROWS
    assert draws.SAMPLES_PER_PERIOD[0] <= 1.0 / x["pole_dt"] * 1.0001
    assert 0.001 < np.ptp(d.truth.signals["speed_motor"]) / x["rated_speed"] < 3.1
    assert np.max(np.abs(d.motion.command)) <= x["rated_torque"] * (1.0 + 1e-9)
    assert set(d.recording.names) == {"torque_motor", "speed_motor"}, "nothing of the truth"
    for name, value in d.nameplate.parameters().items():
        truth = equivalent(replace(d.truth.drivetrain, shafts=d.truth.drivetrain.shafts), None, 0.0).get(name)
        if value and truth and name != "lag":
            # A rigid drive's nameplate shares the inertia out.
            factor = 1e9 if d.absent else draws.NAMEPLATE * (1.0 + 1e-9)
            assert 1.0 / factor < value / truth < factor


def test_the_command_is_what_moves_the_drive():
    """Replayed with its delay, the logged set-point moves the true drive as recorded."""
    d = made(27)
    steps, delay = d.motion.steps, d.motion.delay
    assert delay > 0
    acting = np.concatenate([np.zeros(delay), np.repeat(d.motion.command, steps)])[: len(d.recording) * steps]
    again = lm.simulate(d.truth.drivetrain, dt=d.recording.dt / steps, torque_motor=acting)
    exact = d.truth.signals["speed_motor"]
    # Later the two go apart: trajectories with a gap are chaotic.
    early = slice(0, int(np.argmax(np.abs(exact) > 0.05 * np.max(np.abs(exact)))))
    assert again["speed_motor"][::steps][early] == pytest.approx(
        exact[early], abs=1e-9 * np.max(np.abs(exact))
    )
    if d.recording.meta["speed_from_counts"]:
        turned = np.cumsum(d.recording["speed_motor"]) * d.recording.dt
        assert np.ptp(turned - d.truth.signals["angle_motor"]) < 2.0 * d.sensor.resolution


def test_truth_of_two_gaps_and_of_a_soft_clutch():
    shafts = (lm.Shaft(1000.0, 0.1, 0.01), lm.Shaft(5000.0, 0.1, 0.002))
    chain = lm.Drivetrain((1.0, 0.1, 2.0), shafts)
    two = equivalent(chain, None, 0.0)
    assert two["backlash"] == pytest.approx(0.012)
    unjudged = ("inertia_motor", "inertia_load", "stiffness", "damping")
    assert all(two[name] is None for name in unjudged)
    soft = equivalent(replace(chain, shafts=(shafts[0], lm.Shaft(1500.0, 0.1))), None, 0.0)
    assert soft["backlash"] == 0.01 and all(soft[name] is None for name in unjudged)
    one = equivalent(replace(chain, shafts=(shafts[0], lm.Shaft(5000.0, 0.1))), None, 1e-3)
    assert one["inertia_motor"] == 1.0 and one["inertia_load"] == pytest.approx(2.1)
    assert one["lag"] == 1e-3


def test_truth_of_friction_at_both_ends():
    motor, load = lm.Friction((3.0, 1.0), 0.1), lm.Friction(0.5, 0.2)
    chain = lm.Drivetrain((1.0, 2.0), (lm.Shaft(1000.0),), (motor, load))
    speed = np.linspace(-3.0, 9.0, 300)
    exact = lm.Recording(np.arange(300.0), {"speed_motor": speed, "speed_load": 0.0 * speed})
    truth = equivalent(chain, exact, 0.0)
    assert truth["coulomb_motor"] == pytest.approx(2.0) and truth["viscous_motor"] == pytest.approx(0.1)
    assert truth["coulomb"] is None, "a load that never moves tells no friction"


def test_truth_of_a_rigid_drive():
    d = made(1)
    assert d.absent == ABSENT_IF_RIGID
    assert d.truth.parameters["inertia_total"] == d.truth.drivetrain.inertia_total
    assert d.truth.parameters["inertia_motor"] is None
    assert all(d.truth.parameters[name] == 0.0 for name in d.absent)
    assert d.nameplate.stiffness > 0.0


def test_cramer_rao_follows_the_noise():
    d = made(3)
    finer = replace(d, sensor=replace(d.sensor, resolution=0.5 * d.sensor.resolution))
    coarse, fine = cramer_rao(d), cramer_rao(finer)
    assert set(coarse) == {name for name, value in d.truth.parameters.items() if value}
    for name, half in coarse.items():
        assert fine[name] == pytest.approx(0.5 * half, rel=1e-6)


def test_cramer_rao_of_a_rigid_drive_is_that_of_the_regression():
    """Without friction and lag a rigid drive's speed in a window is its first value + impulse / inertia."""
    d = made(1)
    inertia = d.truth.drivetrain.inertia_total
    plain = lm.Drivetrain((inertia,))
    torque = d.motion.signals["torque_motor"][:: d.motion.steps][:4000]
    exact = lm.simulate(plain, dt=d.recording.dt, torque_motor=torque)
    sensor = lm.Sensor("speed_motor", noise=0.01)
    signals = exact.with_signals("simulated", speed_load=exact["speed_motor"])
    one = replace(
        d,
        recording=exact,
        truth=replace(d.truth, drivetrain=plain, signals=signals),
        dimensions={**d.dimensions, "pole": 64.0 / (4000 * d.recording.dt)},
        sensor=sensor,
        motion=replace(d.motion, signals=exact, command=torque, steps=1, delay=0),
    )  # fmt: skip
    impulse = np.cumsum(np.r_[0.0, torque[:-1]]) * d.recording.dt / inertia
    deviation = 0.01 / np.linalg.norm(impulse - impulse.mean())
    assert cramer_rao(one)["inertia_total"] == pytest.approx(1.96 * deviation, rel=1e-3)


def test_cramer_rao_of_a_gap_that_never_opens_is_wide():
    """Seed 14 is pressed to one side of its gap by its load torque."""
    half = cramer_rao(made(14))
    assert half["backlash"] > 1.0 > 0.1 > half["inertia_motor"]
