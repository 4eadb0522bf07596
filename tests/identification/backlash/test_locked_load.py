"""Locked-load backlash on a plant finer than the estimator: elastic chain, friction at the motor, encoder counts."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.identification import LockedBacklash, locked_backlash
from lostmotion.identification.statistics.quantised_regression import compatible_range, count_fit
from lostmotion.recording import Recording
from lostmotion.rig.nominal import nominal_rig

DT = 1e-3
BACKLASH = 0.012
STIFFNESS = 1.0 / sum(1.0 / shaft.stiffness for shaft in nominal_rig().drivetrain.shafts)


@cache
def locked(
    coulomb_motor: float = 0.3,
    amplitude: float = 15.0,
    period: float = 4.0,
    shape: str = "ramp",
    backlash: float = BACKLASH,
) -> Recording:
    """The virtual rig with its brakes closed: four inertias, the last one held by friction that nothing overcomes."""
    chain = nominal_rig().drivetrain
    shafts = (*chain.shafts[:-1], replace(chain.shafts[-1], backlash=backlash))
    frictions = (lm.Friction(coulomb_motor), *chain.frictions[1:-1], lm.Friction(1000.0))
    t = np.arange(round(3.0 * period / DT)) * DT
    if shape == "ramp":
        torque = amplitude * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * t / period))
    elif shape == "sine":
        torque = amplitude * np.sin(2.0 * np.pi * t / period)
    else:  # plateaus, approached slowly from both sides
        level = amplitude * np.array([0.3, 0.6, 1.0, 0.6, 0.3, -0.3, -0.6, -1.0, -0.6, -0.3] * 3)
        torque = np.interp(t, np.arange(60) * period / 20.0, np.repeat(level, 2))
    return lm.simulate(replace(chain, shafts=shafts, frictions=frictions), dt=DT, torque_motor=torque)


def seen(run: Recording, bits: int, phase: float = 0.3, noise: float = 0.0, seed: int = 0) -> Recording:
    """Motor torque, and the motor angle in counts; the lock holds the encoder at some phase of a count."""
    count = 2.0 * np.pi / 2**bits
    angle = run["angle_motor"] + phase * count + noise * np.random.default_rng(seed).standard_normal(len(run))
    return Recording(
        run.time, {"torque_motor": run["torque_motor"], "angle_motor": np.floor(angle / count) * count}
    )


def off_by(found: LockedBacklash, truth: float = BACKLASH) -> float:
    assert found.values["backlash"] is not None
    return abs(found.values["backlash"] / truth - 1.0)


def holds(found: LockedBacklash, name: str, truth: float) -> bool:
    low, high = found.intervals[name]
    return low <= truth <= high


@pytest.mark.parametrize("phase", [0.0, 0.23, 0.5, 0.77])
def test_sixteen_bit(phase: float) -> None:
    found = locked_backlash(seen(locked(), 16, phase))
    assert off_by(found) < 3e-3
    assert holds(found, "backlash", BACKLASH)
    assert found.intervals["backlash"][1] - found.intervals["backlash"][0] < 3e-3 * BACKLASH
    assert found.values["stiffness"] == pytest.approx(STIFFNESS, rel=0.01)
    assert found.values["coulomb_motor"] == pytest.approx(0.3, abs=0.03)
    assert found.resolution == pytest.approx(2.0 * np.pi / 2**16)
    assert found.problems == ()
    assert found.sources["backlash"] == "identified"


@pytest.mark.parametrize("phase", [0.0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875])
def test_twelve_bit(phase: float) -> None:
    found = locked_backlash(seen(locked(), 12, phase))
    assert off_by(found) < 0.03
    assert holds(found, "backlash", BACKLASH)


def test_friction_at_the_motor_does_not_bias_and_the_wind_up_is_removed() -> None:
    found = [locked_backlash(seen(locked(friction), 16)) for friction in (0.0, 0.3, 0.8)]
    assert max(off_by(f) for f in found) < 3e-3
    # The free angle between +15 and −15 Nm, read off the encoder, would be 40 % too large.
    swing = np.ptp(found[0].angle)
    assert swing > 1.35 * BACKLASH


@pytest.mark.parametrize("bits", [14, 16])
def test_plateaus(bits: int) -> None:
    found = locked_backlash(seen(locked(shape="plateaus", period=8.0), bits))
    assert off_by(found) < 3e-3
    assert holds(found, "backlash", BACKLASH)


def test_noise_of_the_encoder_and_other_gaps() -> None:
    noisy = [locked_backlash(seen(locked(), 16, noise=1e-4, seed=s)) for s in range(5)]
    assert max(off_by(f) for f in noisy) < 3e-3
    small = locked_backlash(seen(locked(backlash=0.002), 16))
    assert off_by(small, 0.002) < 0.01


def test_without_counts_the_fit_is_least_squares() -> None:
    run = locked()
    found = locked_backlash(Recording(run.time, {n: run[n] for n in ("torque_motor", "angle_motor")}))
    assert found.resolution == 0.0
    assert off_by(found) < 1e-3


def test_no_gap_is_said_so() -> None:
    found = locked_backlash(seen(locked(backlash=0.0), 16))
    assert found.intervals["backlash"][0] <= 0.0 <= found.intervals["backlash"][1]
    assert found.intervals["backlash"][1] < 0.01 * BACKLASH
    assert "no backlash found" in found.problems[-1].got


def test_torque_too_small_to_cross() -> None:
    found = locked_backlash(seen(locked(coulomb_motor=2.0, amplitude=1.5), 16))
    assert found.values["backlash"] is None
    assert found.sources["backlash"] == "not excited"
    assert "too small to cross" in found.problems[0].remedy
    with pytest.raises(InvalidInput, match="no backlash"):
        found.fitted(np.ones(3), 1.0, 1.0)


def test_torque_that_never_reverses() -> None:
    run = locked()
    found = locked_backlash(seen(run.window(0.0, 1.9), 16))
    assert found.values["backlash"] is None
    assert "never reverses" in found.problems[0].got


def test_fast_sines_bounce_and_give_no_number() -> None:
    found = locked_backlash(seen(locked(shape="sine", period=0.1), 16))
    assert found.values["backlash"] is None
    assert "fast sines bounce" in found.problems[0].remedy


def test_flanks_loaded_one_way_only_leave_friction_unknown() -> None:
    run = seen(locked(), 16)
    # From −15 Nm up to zero and from zero up to +15 Nm: rising on both flanks is enough; rising on one and falling
    # on the other is not.
    rising = locked_backlash(run.window(3.0, 5.0))
    assert off_by(rising) < 3e-3
    time = run.time[:2000]
    torque, angle = run["torque_motor"], run["angle_motor"]
    joined = Recording(
        time,
        {
            "torque_motor": np.concatenate([torque[4000:5000], torque[6000:7000]]),
            "angle_motor": np.concatenate([angle[4000:5000], angle[6000:7000]]),
        },
    )
    found = locked_backlash(joined)
    assert "one direction only" in found.problems[0].got
    assert found.values["coulomb_motor"] is None and found.sources["coulomb_motor"] == "not excited"
    # What the problem says: 2·friction/stiffness too small.
    assert found.values["backlash"] == pytest.approx(BACKLASH - 2.0 * 0.3 / STIFFNESS, rel=3e-3)


def test_one_edge_on_each_flank_is_named_and_the_interval_holds() -> None:
    run = locked(amplitude=12.0)
    found = [locked_backlash(seen(run, 12, phase)) for phase in np.arange(0.0, 1.0, 0.1)]
    named = [f for f in found if any("one edge" in p.got for p in f.problems)]
    assert 0 < len(named) < len(found)
    assert all(holds(f, "backlash", BACKLASH) for f in named)
    widths = [np.ptp(f.intervals["backlash"]) for f in named]
    assert min(widths) > 0.02 * BACKLASH


# The fit of counts itself


def line(n: int, noise: float, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    random = np.random.default_rng(seed)
    sweep = np.tile(np.linspace(-1.0, 1.0, n), 6)
    columns = np.stack([np.ones(6 * n), sweep])
    groups = np.repeat(np.arange(6), n)
    return columns, np.floor(0.37 + 1.7 * sweep + noise * random.standard_normal(6 * n)), groups


def test_counts_have_no_bias_where_least_squares_has_one() -> None:
    columns, counts, groups = line(400, 0.0, 1)
    fit = count_fit(columns, counts, 1.0, groups)
    assert fit.values[1] == pytest.approx(1.7, abs=0.01)
    plain = count_fit(columns, counts, 0.0, groups)
    assert abs(plain.values[1] - 1.7) > 5.0 * abs(fit.values[1] - 1.7)


def test_intervals_of_noisy_counts_hold_the_truth() -> None:
    hits = 0
    for seed in range(30):
        fit = count_fit(*_with_resolution(line(60, 0.4, seed)))
        hits += abs(fit.values[1] - 1.7) <= fit.margins[1]
    assert hits >= 25


def _with_resolution(
    made: tuple[np.ndarray, np.ndarray, np.ndarray],
) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
    return made[0], made[1], 1.0, made[2]


def test_compatible_range_holds_the_truth_and_respects_bounds() -> None:
    columns, counts, _ = line(400, 0.0, 1)
    low, high = compatible_range(columns, counts, 1.0, bounds={})
    assert low[1] <= 1.7 <= high[1]
    assert high[1] - low[1] < 0.2
    _, bounded = compatible_range(columns, counts, 1.0, bounds={1: (None, 1.7)})
    assert bounded[1] == pytest.approx(1.7)
    scattered = line(400, 2.0, 1)
    assert np.isnan(compatible_range(scattered[0], scattered[1], 1.0, bounds={})[0]).all()
