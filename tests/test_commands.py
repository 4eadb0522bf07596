"""The commands beside the main job: files in, JSON and picture out."""

from __future__ import annotations

from pathlib import Path

import pytest

import lostmotion as lm
from lostmotion.commands.excite import excitation_file
from lostmotion.commands.frf import frequency_response_file
from lostmotion.commands.identify import identify_file
from lostmotion.commands.simulate import simulate_file
from lostmotion.io import load_json


def is_picture(path: Path) -> bool:
    return path.read_bytes().startswith(b"\x89PNG")


def test_identify(tmp_path: Path) -> None:
    result = identify_file(None, tmp_path / "new" / "found", seed=2)
    written = load_json(tmp_path / "new" / "found.json", "identification")
    assert written["parameters"] == result["parameters"]
    assert result["parameters"]["backlash"]["source"] == "identified"
    assert is_picture(tmp_path / "new" / "found.png")


def test_frf_of_the_rig_lies_below_the_linear_zero_and_pole(tmp_path: Path) -> None:
    """The gap lowers zero and pole of the closed-gap drivetrain (38 and 100 Hz)."""
    result = frequency_response_file(None, tmp_path / "frf")
    values = result["two_mass_fit"]["values"]
    assert 10.0 < values["zero"] < 37.0
    assert values["zero"] < values["pole"] < 99.0
    assert is_picture(tmp_path / "frf.png")
    assert max(load_json(tmp_path / "frf.json", "frequency_response")["response"]["frequency_hz"]) <= 200.0


def test_excite_then_simulate_what_it_wrote(tmp_path: Path) -> None:
    result = excitation_file(
        None, tmp_path / "test", kind="noise", duration=2.0, dt=1e-4, torque_limit=10.0, speed_limit=40.0
    )
    assert result["peaks"]["torque"] <= 10.0
    assert result["peaks"]["speed"] <= 40.0
    assert is_picture(tmp_path / "test.png")
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.3, backlash=0.01
    )
    lm.save_drivetrain(plant, tmp_path / "plant.toml")
    recording = simulate_file(tmp_path / "plant.toml", tmp_path / "run.csv", torque=tmp_path / "test.csv")
    assert len(recording) == 20_000
    assert len(recording.events) > 0
    again = lm.read_recording(tmp_path / "run.csv")
    assert again["speed_load"] == pytest.approx(recording["speed_load"], rel=1e-8, abs=1e-9)  # 9 digits
    assert is_picture(tmp_path / "run.png")


def test_a_nameplate_that_says_too_little_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(
        '[nameplate]\ninertia_motor = 0.02\n[[recording]]\nfile = "x.csv"\nchannels.speed_motor = { column = 1 }\n'
        "time = { column = 0 }\n"
    )
    with pytest.raises(lm.InvalidInput, match="inertia_load, stiffness"):
        excitation_file(
            tmp_path / "rig.toml", tmp_path / "x", kind="noise", duration=2.0, dt=1e-4, torque_limit=5.0,
            speed_limit=5.0,
        )  # fmt: skip
