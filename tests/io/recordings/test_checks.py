"""Warnings about recordings: what is warned of, and what is not."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from lostmotion.cli import app
from lostmotion.identification.prediction_error.identify import MIN_ROWS, MIN_TIME
from lostmotion.io.recordings.checks import (
    IDENTIFIABLE_ROWS,
    IDENTIFIABLE_TIME,
    check_identifiable,
    check_recording,
)
from lostmotion.io.recordings.torque_and_speed import column_order, torque_agreement
from lostmotion.recording import Recording

DT = 1e-3
TIME = DT * np.arange(8000)


def drive(torque: np.ndarray, gap: float = 0.0, lag: int = 0, noise: float = 0.0) -> np.ndarray:
    """Motor speed of a two-mass drivetrain (zero 38 Hz, pole 101 Hz) with friction, by small steps."""
    inertia_motor, inertia_load, stiffness, damping = 0.0182, 0.111, 6285.9, 0.397
    twist = motor = wheel = 0.0
    speeds = np.empty(torque.size)
    substeps = 10
    delayed = np.roll(torque, lag)
    for k in range(torque.size):
        speeds[k] = motor
        for _ in range(substeps):
            shaft = stiffness * (twist - min(max(twist, -gap / 2), gap / 2)) + damping * (motor - wheel)
            friction = 2.0 * np.tanh(wheel / 0.05)
            motor += DT / substeps * (delayed[k] - shaft) / inertia_motor
            wheel += DT / substeps * (shaft - friction) / inertia_load
            twist += DT / substeps * (motor - wheel)
    return speeds + noise * np.random.default_rng(2).normal(size=speeds.size)


def recording(torque: np.ndarray, speed: np.ndarray) -> Recording:
    return Recording(TIME[: torque.size], {"torque_motor": torque, "speed_motor": speed})


def excitation(seed: int = 1) -> np.ndarray:
    rng = np.random.default_rng(seed)
    return 15.0 * np.repeat(rng.normal(size=2000), 4) + 5.0 * np.sin(9.0 * TIME)


@pytest.mark.parametrize(
    ("gap", "lag", "noise"), [(0.0, 0, 0.0), (0.012, 0, 0.05), (0.012, 1, 0.05), (0.05, 2, 0.2)]
)
def test_sign_is_told_for_a_two_mass_drivetrain(gap: float, lag: int, noise: float) -> None:
    torque = excitation()
    speed = drive(torque, gap, lag, noise)
    right, wrong = recording(torque, speed), recording(-torque, speed)
    assert torque_agreement(right) > 0.6 and torque_agreement(wrong) == pytest.approx(
        -torque_agreement(right)
    )
    assert check_recording(right) == ()
    (warning,) = check_recording(wrong)
    assert warning.severity == "warning" and "opposite sign" in warning.got and "sign = -1" in warning.remedy


def test_nothing_is_said_of_signals_that_have_nothing_to_do_with_each_other() -> None:
    rng = np.random.default_rng(5)
    for _ in range(20):
        unrelated = recording(rng.normal(size=8000), rng.normal(size=8000))
        assert check_recording(unrelated) == () and torque_agreement(unrelated) == 0.0


def test_load_steps_against_a_speed_controller_are_no_wrong_sign() -> None:
    # The load brakes, the controller answers: torque up while the speed goes down, with the right sign.
    rng = np.random.default_rng(3)
    load = 10.0 * np.repeat(rng.normal(size=16), 500)
    speed, torques, speeds = 0.0, [], []
    for k in range(8000):
        torque = -2.0 * speed
        torques.append(torque)
        speeds.append(speed)
        speed += DT * (torque - load[k]) / 0.13
    assert check_recording(recording(np.array(torques), np.array(speeds))) == ()


def test_constant_channel_and_torque_that_never_reverses() -> None:
    torque = 5.0 + np.sin(50 * TIME) + 0.1 * np.random.default_rng(0).normal(size=TIME.size)
    torque[17] = -3.0  # one outlier is no reversal
    rec = Recording(
        TIME,
        {"torque_shaft": torque, "speed_load": np.full(TIME.size, 2.5), "torque_motor": -torque},
        meta={"file": "a.csv"},
    )
    shaft, constant, motor = check_recording(rec)
    assert (
        shaft.where == "a.csv, torque_shaft" and "never reverses" in shaft.got and "backlash" in shaft.remedy
    )
    assert constant.where == "a.csv, speed_load" and constant.got == "the constant 2.5"
    assert "never reverses" in motor.got
    assert {p.severity for p in (shaft, constant, motor)} == {"warning"}


@pytest.mark.parametrize("resolution", [0.0, 0.06, 0.6])
@pytest.mark.parametrize(("value", "warned"), [(None, True), (0.0, False)])
def test_a_sensor_that_hangs_is_told_and_a_standstill_is_not(
    resolution: float, value: float | None, warned: bool
) -> None:
    time, rng = 1e-4 * np.arange(20_000), np.random.default_rng(3)
    torque = 3.0 * rng.normal(size=time.size)
    speed = 20.0 * np.sin(30.0 * time) + 0.02 * np.cumsum(torque) + 3.0
    if resolution:
        speed = resolution * np.round(speed / resolution)
    speed[9000:13_000] = speed[9000] + 3.0 * resolution if value is None else value
    found = [p for p in check_recording(Recording(time, {"speed_motor": speed})) if "on end" in p.got]
    assert len(found) == warned
    if warned:
        assert "from 0.9 s on" in found[0].got and "window" in found[0].remedy


def test_a_torque_in_both_directions_is_not_warned_of() -> None:
    rec = Recording(
        TIME, {"torque_shaft": np.sin(TIME) + 0.9, "torque_motor": np.where(TIME < 7.9, 1.0, -0.1)}
    )
    assert check_recording(rec) == ()


def test_the_limits_are_those_of_the_identification() -> None:
    assert (IDENTIFIABLE_ROWS, IDENTIFIABLE_TIME) == (MIN_ROWS, MIN_TIME)


@pytest.mark.parametrize(
    ("rows", "dt", "short"),
    [(1000, 1e-3, False), (999, 1e-3, True), (4000, 1e-4, True), (5001, 1e-4, False)],
)
def test_too_short_to_identify_from(rows: int, dt: float, short: bool) -> None:
    moving = np.sin(np.arange(rows))
    found = check_identifiable(
        Recording(dt * np.arange(rows), {"speed_motor": moving, "torque_motor": moving})
    )
    assert [p.got for p in found] == ([f"{rows} rows, {rows * dt:g} s"] if short else [])


@pytest.mark.parametrize(
    ("missing", "words"),
    [
        ("torque_motor", "no torque_motor|no observer, no controller|the motor's current will do"),
        ("speed_motor", "no speed_motor|an angle will do"),
    ],
)
def test_a_recording_that_cannot_be_identified_from_is_told(missing: str, words: str) -> None:
    torque = excitation()
    whole = recording(torque, drive(torque))
    assert check_identifiable(whole) == ()
    (warning,) = check_identifiable(whole.only(*(name for name in whole if name != missing)))
    assert warning.severity == "warning" and all(part in str(warning) for part in words.split("|"))


@pytest.mark.parametrize(
    ("value", "share", "refused"), [(7.5, 0.3, True), (0.0, 0.6, False), (7.5, 0.2, False)]
)
def test_a_motor_speed_that_hangs_in_a_large_part_is_refused(
    value: float, share: float, refused: bool
) -> None:
    torque = excitation()
    speed = drive(torque)
    speed[: int(share * speed.size)] = value
    found = [p for p in check_identifiable(recording(torque, speed)) if p.severity == "error"]
    assert len(found) == refused
    if refused:
        assert "7.5 in 2400 of 8000 rows" in found[0].got and "window" in found[0].remedy
    (constant,) = check_identifiable(recording(torque, np.zeros(8000)))
    assert constant.severity == "error" and constant.got.startswith("0 in 8000 of 8000 rows")


@pytest.mark.parametrize(("use", "warned"), [("identify", True), ("validate", False)])
def test_check_warns_of_short_recordings_and_constant_channels(
    tmp_path: Path, use: str, warned: bool
) -> None:
    time = 1e-3 * np.arange(500)
    table = np.column_stack([time, np.zeros(500), np.sin(40 * time)])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,torque_motor,speed_motor", comments="")
    (tmp_path / "rig.toml").write_text(f'[[recording]]\nfile = "a.csv"\nuse = "{use}"\n')
    done = CliRunner().invoke(app, ["check", str(tmp_path / "rig.toml"), "--json"])
    problems = json.loads(done.stdout)
    assert done.exit_code == 0 and {p["severity"] for p in problems} == {"warning"}
    assert "the constant 0.0" in [p["got"] for p in problems]
    assert ("500 rows, 0.5 s" in [p["got"] for p in problems]) is warned


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_swapped_columns_are_told_from_a_wrong_sign(sign: float) -> None:
    torque = excitation()
    speed = drive(torque, 0.012, 1, 0.05)
    follows, followed = column_order(recording(torque, speed))
    assert follows > 0.8 and -0.3 < followed < 0.0
    warnings = check_recording(recording(sign * speed, sign * torque))
    (warning,) = (w for w in warnings if "speed_motor" in w.where)
    assert "swapped" in warning.remedy and "correlation" in warning.got
    assert not any("opposite sign" in w.got for w in warnings)


@pytest.mark.parametrize("rig", [5, 6])
def test_swapped_columns_of_the_rig(rig: int) -> None:
    from lostmotion.rig import record

    right, _ = record(rig)
    swapped = right.with_signals(
        "measured", torque_motor=right["speed_motor"], speed_motor=right["torque_motor"]
    )
    assert check_recording(right.only("torque_motor", "speed_motor")) == ()
    assert any("swapped" in w.remedy for w in check_recording(swapped))


def test_what_moves_as_one_is_not_called_swapped() -> None:
    """Of a sine each column follows the other."""
    torque = np.sin(2.0 * np.pi * TIME)
    speed = -np.cos(2.0 * np.pi * TIME)
    for one, two in ((torque, speed), (speed, torque)):
        assert not any("look swapped" in w.remedy for w in check_recording(recording(one, two)))


@pytest.mark.parametrize(("step", "warned"), [(1e-3, False), (0.01, False), (0.05, True), (1.0, True)])
def test_time_in_ms_is_named(step: float, warned: bool) -> None:
    torque = excitation()
    read = Recording(step * np.arange(8000), {"torque_motor": torque, "speed_motor": drive(torque)})
    said = [w for w in check_recording(read) if w.where.endswith(", time")]
    assert bool(said) == warned
    assert all('unit = "ms"' in w.remedy and "sample time" in w.got for w in said)
