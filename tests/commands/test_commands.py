"""The commands beside the main job: files in, JSON and picture out."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.commands.certify import certify_file
from lostmotion.commands.excite import excitation_file
from lostmotion.commands.frf import frequency_response_file
from lostmotion.commands.identify import identify_file
from lostmotion.commands.outputs import check_writable, outputs, save_picture
from lostmotion.commands.recordings import RecordingFile, read_drive, toml_or_rig
from lostmotion.commands.simulate import simulate_file
from lostmotion.commands.simulate_variants import chunk_folder, simulate_variants
from lostmotion.io import load_json
from lostmotion.plot import recording_overview
from lostmotion.simulation import variants


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
    written = load_json(tmp_path / "frf.json", "frequency_response")
    assert max(written["response"]["frequency_hz"]) <= 200.0
    assert "those of the gap as it moved here" in written["note"]


@pytest.mark.usefixtures("fit_alone")
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
    assert np.array_equal(again["speed_load"], recording["speed_load"])
    assert is_picture(tmp_path / "run.png")


def test_a_nameplate_that_says_too_little_is_refused(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(
        '[nameplate]\ninertia_motor = 0.02\n[[recording]]\nfile = "x.csv"\nchannels.speed_motor = { column = 1 }\n'
        "time = { column = 0 }\n"
    )
    with pytest.raises(lm.InvalidInput, match="inertia_load, stiffness"):
        excitation_file(
            tmp_path / "rig.toml", tmp_path / "y", kind="noise", duration=2.0, dt=1e-4, torque_limit=5.0,
            speed_limit=5.0,
        )  # fmt: skip


TOML = """
[nameplate]
inertia_motor = 0.02
[[recording]]
file = "short.csv"
time = { column = 0, unit = "s" }
channels.speed_motor = { column = 1, unit = "rad/s" }
"""
#: In the place of [[recording]]: a nameplate that is right, so that the rehearsals of a design are short.
WELL_KNOWN = """inertia_load = 0.1
stiffness = 5000
damping = 0.3
backlash = "0.5 deg"
coulomb = 2.0
viscous = 0.01
[law]
torque_limit = 30.0
[[recording]]"""


def test_one_recording_is_used_whole_and_its_warnings_go_on(tmp_path: Path) -> None:
    stuck = [f"{k * 1e-3:.3f},{0 if k < 900 else k % 7}" for k in range(1000)]
    (tmp_path / "short.csv").write_text("\n".join(stuck) + "\n")
    (tmp_path / "rig.toml").write_text(TOML)
    material = toml_or_rig(tmp_path / "rig.toml").material(None)
    assert len(material.identify) == 1000
    recording, warnings = toml_or_rig(tmp_path / "rig.toml").recording(None)
    assert len(recording) == 1000
    assert warnings == material.problems != ()
    result = frequency_response_file(
        tmp_path / "rig.toml", tmp_path / "frf", input="speed_motor", output="speed_motor"
    )
    assert all(warning.as_dict() in result["problems"] for warning in warnings)


def plant_file(folder: Path) -> Path:
    plant = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.3)
    lm.save_drivetrain(plant, folder / "plant.toml")
    return folder / "plant.toml"


@pytest.mark.parametrize("name", ["run", "run.csv", "run.png", "run.json"])
def test_an_ending_of_the_files_is_left_out_of_their_name(tmp_path: Path, name: str) -> None:
    plant = plant_file(tmp_path)
    simulate_file(plant, tmp_path / name, duration=0.1)
    law = tmp_path / "law.json"
    lm.save_law(lm.controllers.pi(dt=1e-4), law)
    certify_file(plant, tmp_path / "proofs" / name, law)
    found = {p.relative_to(tmp_path).as_posix() for p in tmp_path.rglob("[!.]*.*")}
    assert found - {"plant.toml", "law.json"} == {
        "run.csv",
        "run.png",
        "proofs/run.json",
        "proofs/run_verify.py",
    }


@pytest.mark.parametrize("name", ["v1.2", "run.txt", ".json"])
def test_another_ending_belongs_to_the_name(tmp_path: Path, name: str) -> None:
    simulate_file(plant_file(tmp_path), tmp_path / name, duration=0.1)
    assert (tmp_path / f"{name}.csv").exists() and (tmp_path / f"{name}.png").exists()
    assert len(list(tmp_path.glob("*.???"))) == 2 and not (tmp_path / name).exists()


def test_an_interrupted_batch_of_variants_goes_on(tmp_path: Path) -> None:
    plant, out = plant_file(tmp_path), tmp_path / "run.csv"
    arguments = dict(count=250, spread=0.1, duration=0.2, seed=2)

    def interrupt(done: int, everything: int, remaining: float) -> None:
        assert everything == 250
        if done >= 100:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        simulate_variants(plant, out, **arguments, progress=interrupt)
    assert not out.exists() and len(list(chunk_folder(out).glob("*.npz"))) >= 1
    calls: list[int] = []
    made = simulate_variants(plant, out, **arguments, progress=lambda done, a, b: calls.append(done))
    assert calls[0] > 100 and calls[-1] == 250
    assert not chunk_folder(out).exists() and is_picture(out.with_suffix(".png"))
    with out.open() as file:
        rows = list(csv.DictReader(file))
    assert [int(row["variant"]) for row in rows] == list(range(250))
    assert float(rows[7]["peak_speed_load [rad/s]"]) == pytest.approx(made.peak["speed_load"][7], rel=1e-8)
    assert {"lag [s]", "breakaway_1 [Nm]", "breakaway_2 [Nm]"} <= set(rows[0])
    inertias = np.array([float(row["inertia_2 [kg m2]"]) for row in rows])
    assert 0.09 <= inertias.min() < 0.092 and 0.108 < inertias.max() <= 0.11


def test_the_picture_of_variants_resolves_the_torsional_mode(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of a long run the 200 times of the quantiles lie apart: drawn over the whole of it, they would alias."""
    from lostmotion import plot

    drawn, real = [], plot.quantile_bands

    def seen(time: np.ndarray, *arguments: object, **keywords: object) -> object:
        drawn.append(time)
        return real(time, *arguments, **keywords)

    monkeypatch.setattr(plot, "quantile_bands", seen)
    plant = plant_file(tmp_path)
    simulate_variants(plant, tmp_path / "run.csv", count=3, duration=3.0)
    (time,) = drawn
    assert np.max(np.diff(time)) * lm.load_drivetrain(plant).pole_frequency < 0.11


def test_every_number_that_varies_has_a_column(tmp_path: Path) -> None:
    frictions = (lm.Friction(0.2, 0.01), lm.Friction(0.5, 0.02, breakaway=0.8))
    plant = lm.Drivetrain((0.02, 0.1), (lm.Shaft(6e3, 0.3, 0.01),), frictions, lm.Actuator(lag=2e-3))
    lm.save_drivetrain(plant, tmp_path / "plant.toml")
    simulate_variants(tmp_path / "plant.toml", tmp_path / "run.csv", count=4, duration=0.1)
    with (tmp_path / "run.csv").open() as file:
        rows = list(csv.DictReader(file))
    for i, variant in enumerate(variants(plant, 4)):
        assert float(rows[i]["lag [s]"]) == pytest.approx(variant.actuator.lag, rel=1e-8)
        assert float(rows[i]["breakaway_2 [Nm]"]) == pytest.approx(variant.frictions[1].breakaway, rel=1e-8)
        assert rows[i]["breakaway_1 [Nm]"] == rows[i]["coulomb_1 [Nm]"]  # none given: that of the sliding


@pytest.mark.parametrize("dt", [0.0, np.nan, -1e-4])
def test_impossible_sample_times_are_refused(tmp_path: Path, dt: float) -> None:
    with pytest.raises(lm.InvalidInput, match="dt"):
        simulate_file(plant_file(tmp_path), tmp_path / "run.csv", duration=1.0, dt=dt)


def test_places_that_cannot_be_written_are_refused(tmp_path: Path) -> None:
    (tmp_path / "ex.csv").write_text("")
    (tmp_path / "dd.png").mkdir()
    for place in (tmp_path / "ex.csv" / "x", Path(), Path(".."), tmp_path / "a\0b", tmp_path / ("n" * 5000)):
        with pytest.raises(lm.InvalidInput, match="expected"), outputs(place, ".json"):
            pytest.fail("the work was started")
    with pytest.raises(lm.InvalidInput, match=r"dd\.png"), outputs(tmp_path / "dd", ".json", ".png"):
        pytest.fail("the work was started")
    with pytest.raises(lm.InvalidInput, match=r"ex\.csv"):
        check_writable(tmp_path / "ex.csv" / "deep" / "x.csv")
    recording = lm.Recording(np.arange(3.0), {"speed_motor": np.zeros(3)})
    with pytest.raises(lm.InvalidInput, match=r"dd\.png"):
        save_picture(recording_overview(recording, title="x"), tmp_path / "dd.png")
    assert {p.name for p in tmp_path.iterdir()} == {"ex.csv", "dd.png"}


def test_the_place_is_checked_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def computed(*_: object, **__: object) -> None:
        raise AssertionError("computed before the place was checked")

    from lostmotion.commands import excite, simulate

    monkeypatch.setattr(RecordingFile, "material", computed)
    monkeypatch.setattr(RecordingFile, "recording", computed)
    monkeypatch.setattr(excite, "design_excitation", computed)
    monkeypatch.setattr(simulate, "simulate", computed)
    plant = plant_file(tmp_path)
    for name in ("x.json", "x.png", "x.csv"):
        (tmp_path / name).mkdir()
    limits = {"kind": "step", "duration": 1.0, "dt": 1e-3, "torque_limit": 1.0, "speed_limit": 1.0}
    for command in (
        lambda: identify_file(None, tmp_path / "x"),
        lambda: frequency_response_file(None, tmp_path / "x"),
        lambda: excitation_file(None, tmp_path / "x", **limits),
        lambda: simulate_file(plant, tmp_path / "x.csv"),
    ):
        with pytest.raises(lm.InvalidInput, match="name of a file"):
            command()


def test_a_toml_of_the_main_job_can_be_simulated(tmp_path: Path) -> None:
    more = "inertia_load = 0.1\nstiffness = 5000\nbacklash = '0.5 deg'\n[[recording]]"
    (tmp_path / "rig.toml").write_text(TOML.replace("[[recording]]", more))
    recording = simulate_file(tmp_path / "rig.toml", tmp_path / "rec.csv", duration=0.2)
    assert np.ptp(recording["twist"]) > np.radians(0.5) and is_picture(tmp_path / "rec.png")
    (tmp_path / "rig.toml").write_text(TOML)
    with pytest.raises(lm.InvalidInput, match="inertia_load, stiffness"):
        simulate_file(tmp_path / "rig.toml", tmp_path / "rec.csv", duration=0.2)
    (tmp_path / "broken.toml").write_text("kind = 'something'\n")
    with pytest.raises(lm.InvalidInput, match="something"):
        simulate_file(tmp_path / "broken.toml", tmp_path / "rec.csv", duration=0.2)


def test_a_recording_is_never_written_over(tmp_path: Path) -> None:
    """The template names the measurement excitation.csv, and a command may be told the same name."""
    whole = TOML.replace("[[recording]]", "inertia_load = 0.1\nstiffness = 5000\n[[recording]]")
    (tmp_path / "rig.toml").write_text(whole)
    (tmp_path / "short.csv").write_text("measured")
    more = {"kind": "noise", "duration": 2.0, "dt": 1e-4, "torque_limit": 5.0, "speed_limit": 5.0}
    with pytest.raises(lm.InvalidInput, match=r"short\.csv.*reads"):
        excitation_file(tmp_path / "rig.toml", tmp_path / "short", **more)
    with pytest.raises(lm.InvalidInput, match=r"short\.csv.*reads"):
        simulate_file(tmp_path / "rig.toml", tmp_path / "short.csv", duration=0.2)
    assert (tmp_path / "short.csv").read_text() == "measured"


def tomls_read(monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """The TOMLs that are read from now on."""
    from lostmotion.io.storage import toml_files

    read: list[Path] = []
    whole = toml_files.read_bytes
    monkeypatch.setattr(
        toml_files, "read_bytes", lambda path, **more: read.append(path) or whole(path, **more)
    )
    return read


def test_a_toml_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is protected and what is worked on are of one version of the file."""
    (tmp_path / "rig.toml").write_text(TOML)
    (tmp_path / "short.csv").write_text("\n".join(f"{k * 1e-3:.3f},{k % 7}" for k in range(1000)))
    read = tomls_read(monkeypatch)
    identify_file(tmp_path / "rig.toml", tmp_path / "found")
    assert read == [tmp_path / "rig.toml"]
    frequency_response_file(
        tmp_path / "rig.toml", tmp_path / "frf", input="speed_motor", output="speed_motor"
    )
    assert read == [tmp_path / "rig.toml"] * 2


@pytest.mark.usefixtures("fit_alone")
def test_a_drive_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is protected, the drivetrain and its limit are of one version of the file."""
    (tmp_path / "rig.toml").write_text(TOML.replace("[[recording]]", WELL_KNOWN))
    (tmp_path / "short.csv").write_text("measured")
    read = tomls_read(monkeypatch)
    drive = read_drive(tmp_path / "rig.toml")
    assert drive.reads == (tmp_path / "rig.toml", tmp_path / "short.csv")
    wanted = {"kind": "levels", "duration": 2.0, "dt": 1e-4, "torque_limit": None, "speed_limit": 50.0}
    assert excitation_file(tmp_path / "rig.toml", tmp_path / "x", **wanted)["limits"]["torque"] == 30.0
    assert read == [tmp_path / "rig.toml"] * 2


@pytest.mark.usefixtures("fit_alone")
def test_the_torque_limit_of_the_toml_holds(tmp_path: Path) -> None:
    (tmp_path / "rig.toml").write_text(TOML.replace("[[recording]]", WELL_KNOWN))
    wanted = {"kind": "levels", "duration": 2.0, "dt": 1e-4, "torque_limit": None, "speed_limit": 50.0}
    result = excitation_file(tmp_path / "rig.toml", tmp_path / "x", **wanted)
    assert result["peaks"]["torque"] <= result["limits"]["torque"] == 30.0
    (tmp_path / "rig.toml").write_text(
        TOML.replace("[[recording]]", WELL_KNOWN.replace("torque_limit = 30.0", ""))
    )
    with pytest.raises(lm.InvalidInput, match=r"--torque-limit, or torque_limit in \[law\]"):
        excitation_file(tmp_path / "rig.toml", tmp_path / "y", **wanted)
