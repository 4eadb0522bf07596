"""What a command must not replace: a user's file, and its own where it was changed since."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

import lostmotion as lm
from lostmotion.commands.frf import frequency_response_file
from lostmotion.commands.outputs import outputs
from lostmotion.commands.simulate import simulate_file
from lostmotion.io.storage.written_files import MANIFEST

PLANT = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.3)


@pytest.fixture
def plant(tmp_path: Path) -> Path:
    lm.save_drivetrain(PLANT, tmp_path / "plant.toml")
    return tmp_path / "plant.toml"


def test_a_users_recording_is_not_replaced(plant: Path) -> None:
    log = plant.with_name("log.csv")
    log.write_text("time,speed_motor\n0,1\n")
    with pytest.raises(lm.InvalidInput, match=r"1 file that lostmotion has not written.*: log\.csv.*--force"):
        simulate_file(plant, log, duration=0.1)
    assert log.read_text() == "time,speed_motor\n0,1\n" and not log.with_suffix(".png").exists()
    simulate_file(plant, log, duration=0.1, force=True)
    assert log.read_text().startswith("time [s],")


def test_own_files_are_replaced_until_they_are_changed(plant: Path) -> None:
    out = plant.with_name("run.csv")
    for duration in (0.1, 0.2):
        assert len(simulate_file(plant, out, duration=duration)) == round(duration / 1e-4)
    own = out.read_bytes()
    out.write_bytes(own + b"0.3,1,2,3\n")
    with pytest.raises(lm.InvalidInput, match=r"changed since: run\.csv"):
        simulate_file(plant, out, duration=0.1)
    out.write_bytes(own)
    simulate_file(plant, out, duration=0.1)


def test_without_the_manifest_every_file_is_somebody_elses(plant: Path) -> None:
    out = plant.with_name("run.csv")
    simulate_file(plant, out, duration=0.1)
    for damage in ("{", '{"kind": "written_files", "schema_version": 2, "files": {"run.csv": 3}}'):
        plant.with_name(MANIFEST).write_text(damage)
        with pytest.raises(
            lm.InvalidInput, match=r"2 files that lostmotion has not written.*run\.csv, run\.png"
        ):
            simulate_file(plant, out, duration=0.1)


def test_what_an_interrupted_command_has_written_is_its_own(tmp_path: Path) -> None:
    with pytest.raises(KeyboardInterrupt), outputs(tmp_path / "a", ".json", ".png") as (first, _):
        first.write_text("whole")
        raise KeyboardInterrupt
    with outputs(tmp_path / "a", ".json", ".png") as (first, second):
        first.write_text("again")
        second.write_text("picture")
    assert first.read_text() == "again"


def test_a_link_is_not_replaced(tmp_path: Path) -> None:
    (tmp_path / "mine.json").write_text("mine")
    (tmp_path / "a.json").symlink_to("mine.json")
    with pytest.raises(lm.InvalidInput, match=r"a\.json"), outputs(tmp_path / "a", ".json"):
        pytest.fail("the work was started")


def test_the_torque_that_is_played_is_not_replaced(plant: Path) -> None:
    torque = plant.with_name("torque.csv")
    simulate_file(plant, torque, duration=0.1)
    with pytest.raises(lm.InvalidInput, match=r"torque\.csv: got a file that this command reads"):
        simulate_file(plant, torque, torque=torque)


def test_a_saved_recording_is_checked_like_any_other(tmp_path: Path) -> None:
    """Its signals may hold NaN, which no analysis survives."""
    time = [1e-3 * k for k in range(300)]
    lm.save_recording(lm.Recording(time, {"speed_motor": [float("nan")] * 300}), tmp_path / "a.npz")
    with pytest.raises(lm.InputProblems, match="NaN or infinity"):
        frequency_response_file(tmp_path / "a.npz", tmp_path / "frf")


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes in folders here")
def test_beside_a_device_or_a_pipe_nothing_is_written(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(lm.InvalidInput, match="a device or a pipe"), outputs(tmp_path / "pipe", ".csv"):
        pass
    assert [file.name for file in tmp_path.iterdir()] == ["pipe"]


def test_a_torque_file_without_torque_is_named(plant: Path, tmp_path: Path) -> None:
    table = tmp_path / "speed.csv"
    table.write_text("time,speed_motor\n" + "".join(f"{k / 1000},{k % 7}\n" for k in range(200)))
    with pytest.raises(lm.InvalidInput, match=r"speed\.csv: got columns \['speed_motor'\]"):
        simulate_file(plant, tmp_path / "out", table)
