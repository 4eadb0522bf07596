"""Lost motion between two encoders: simulated shafts with and without a gap, and a measured robot axis without one."""

from __future__ import annotations

import os
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

import lostmotion as lm
from lostmotion.errors import InvalidInput
from lostmotion.identification import LostMotion, lost_motion
from lostmotion.recording import Recording

DATA = Path(os.environ.get("LOSTMOTION_DATA", Path(__file__).parents[3] / ".." / "shared" / "data"))
DT, DELAY = 1e-3, 3.2e-3
COMPLIANCE = 1.0 / 6285.9


@cache
def shaft(backlash: float, seed: int) -> Recording:
    """A motor with friction drives a load with friction; the load's encoder, of 16 bit like the motor's, is late."""
    random = np.random.default_rng(seed)
    drivetrain = lm.Drivetrain.two_mass(
        inertia_motor=0.0182,
        inertia_load=0.111,
        stiffness=6285.9,
        damping=0.397,
        backlash=backlash,
        coulomb=2.0,
        viscous=0.0175,
        coulomb_motor=0.3,
        contact="physical",
    )
    t = np.arange(15000) * DT
    phase = random.uniform(0.0, 2.0 * np.pi, 2)
    torque = 8.0 * np.sin(2.0 * np.pi * 0.7 * t + phase[0]) + 4.0 * np.sin(2.0 * np.pi * 0.26 * t + phase[1])
    run = lm.simulate(drivetrain, dt=DT, torque_motor=torque)
    count = 2.0 * np.pi / 2**16

    def encoder(angle: np.ndarray) -> np.ndarray:
        return np.asarray(np.floor(angle / count + random.uniform()) * count)

    return Recording(
        t,
        {
            "torque_motor": run["torque_motor"],
            "torque_shaft": run["torque_shaft"] + 0.1 * random.standard_normal(t.size),
            "angle_motor": encoder(run["angle_motor"]),
            "angle_load": encoder(CubicSpline(t, run["angle_load"])(t - DELAY)),
        },
    )


def holds(found: LostMotion, name: str, truth: float) -> bool:
    low, high = found.intervals[name]
    return low <= truth <= high


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("way", ["shaft", "motor"])
def test_a_gap_is_claimed_with_its_interval(seed: int, way: str) -> None:
    recording = shaft(0.003, seed)
    more = {} if way == "shaft" else {"torque": "torque_motor", "inertia_motor": 0.0182}
    found = lost_motion(recording, **more)
    assert found.values["delay"] == pytest.approx(DELAY, rel=2e-3)
    assert found.values["backlash"] == pytest.approx(0.003, rel=0.05)
    assert holds(found, "backlash", 0.003)
    assert found.sources["backlash"] == "identified"
    assert found.values["compliance"] == pytest.approx(COMPLIANCE, rel=0.35)
    assert found.problems == ()


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_no_gap_is_claimed_where_there_is_hysteresis_only(seed: int) -> None:
    found = lost_motion(shaft(0.0, seed), torque="torque_motor", inertia_motor=0.0182)
    assert found.values["backlash"] is None
    assert found.intervals["backlash"][1] < 1e-4
    assert found.values["delay"] == pytest.approx(DELAY, rel=2e-3)
    # Friction before the shaft: both directions lie 2·friction/stiffness apart.
    assert found.values["hysteresis"] is not None
    assert found.values["hysteresis"] > 0.5 * 2.0 * 0.3 * COMPLIANCE
    assert "no dead zone is reported" in found.problems[-1].got


def test_the_delay_hides_nothing() -> None:
    found = lost_motion(shaft(0.003, 0))
    apparent = shaft(0.003, 0)["angle_motor"] - shaft(0.003, 0)["angle_load"]
    # Most of what the encoders show apart is delay.
    assert np.ptp(found.twist) < 0.25 * np.ptp(apparent)
    used = np.isfinite(found.fitted)
    assert np.median(np.abs(found.twist - found.fitted)[used]) < 1e-4


def test_without_a_torque_nothing_is_claimed() -> None:
    found = lost_motion(shaft(0.003, 1).only("angle_motor", "angle_load"))
    assert found.values["backlash"] is None
    assert found.torque_signal is None
    assert found.values["delay"] is not None
    assert found.problems[0].got == "no torque"


def test_too_short_a_recording_is_refused() -> None:
    with pytest.raises(InvalidInput, match="at least 200"):
        lost_motion(shaft(0.003, 1).window(0.0, 0.1))


@pytest.mark.parametrize("name", ["data_A.mat", "data_B.mat"])
def test_measured_robot_axis_has_a_late_encoder_and_no_dead_zone(name: str) -> None:
    path = DATA / "kuka" / name
    if not path.exists():
        pytest.skip(f"no {path}: set LOSTMOTION_DATA to the folder of measured data")
    for axis in range(3):
        channels = {
            "angle_motor": {"column": f"rec.act_pos_mot_deg[{axis}]", "unit": "deg"},
            "angle_load": {"column": f"rec.act_pos_se_deg[{axis}]", "unit": "deg"},
            "torque_motor": {"column": f"rec.act_torque_abs_nm[{axis}]", "unit": "Nm"},
        }
        found = lost_motion(lm.read_recording(path, time={"sample_time": "4 ms"}, channels=channels))
        assert found.values["backlash"] is None
        assert 2.6e-3 <= found.values["delay"] <= 3.2e-3
        if axis == 2:
            assert 1e-4 <= found.values["hysteresis"] <= 2e-4
            assert "not excited" in found.problems[-1].got
