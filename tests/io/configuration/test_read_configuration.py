"""The TOML: every key, every problem with its line, file paths, loading of the recordings."""

from __future__ import annotations

import dataclasses
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InputProblems, Problem
from lostmotion.io.configuration.read import (
    Configuration,
    IdentifySettings,
    LawSettings,
    RecordingSource,
    RunSettings,
    load_recordings,
    read_configuration,
    template,
)
from lostmotion.io.recordings.torque_and_speed import inertia_shown
from lostmotion.io.storage.drivetrain_files import save_drivetrain
from lostmotion.io.tables.channels import Channel
from lostmotion.recording import Recording

Problems = Callable[[Callable[[], object]], tuple[Problem, ...]]
MINIMAL = '[[recording]]\nfile = "rig.csv"\n'
DOCUMENT = Path(__file__).parents[3] / "docs" / "configuration.md"


def read(folder: Path, text: str) -> Configuration:
    path = folder / "rig.toml"
    path.write_text(text, encoding="utf-8")
    return read_configuration(path)


def uncommented(text: str) -> str:
    return re.sub(r"(?m)^# ([a-z_.]+ = )", r"\1", text)


def test_outline(tmp_path: Path) -> None:
    found = read(
        tmp_path,
        """
        [nameplate]
        inertia_motor = "180 kgcm2"
        inertia_load = 0.1
        stiffness = 6000
        [[recording]]
        file = "step_sensor.csv"
        use = "validate"
        window = [2.0, "9 s"]
        resample = true
        speed_from_counts = false
        time = { column = 0, unit = "s" }
        channels.speed_motor = 1
        channels.torque_motor = { column = "Iq [A]", scale = 1.9, unit = "Nm", sign = -1 }
        [identify]
        fixed = ["stiffness"]
        load_torque = true
        [law]
        sample_time = "0.1 ms"
        torque_limit = 73.5
        poles = [-400, -300.5, -400]
        kp = 10
        ki = 200
        [run]
        seed = 7
        """,
    )
    assert dict(found.nameplate) == {"inertia_motor": 180 * 1e-4, "inertia_load": 0.1, "stiffness": 6000.0}
    (source,) = found.recordings
    assert source == RecordingSource(
        tmp_path / "step_sensor.csv",
        "validate",
        Channel(0, "s"),
        {"speed_motor": Channel(1), "torque_motor": Channel("Iq [A]", "Nm", 1.9, -1)},
        (2.0, 9.0),
        True,
        False,
    )
    assert found.identify == IdentifySettings(("stiffness",), True)
    assert found.law == LawSettings(1e-4, 73.5, (-400.0, -300.5, -400.0), 10.0, 200.0)
    assert found.run == RunSettings(7)


def test_defaults(tmp_path: Path) -> None:
    found = read(tmp_path, MINIMAL)
    assert dict(found.nameplate) == {}
    assert found.recordings == (RecordingSource(tmp_path / "rig.csv"),)
    assert found.identify == IdentifySettings()
    assert found.law == LawSettings(None, None, None, None, None)
    assert found.run == RunSettings(1)


def test_template_is_valid_as_it_stands_and_with_every_comment_removed(tmp_path: Path) -> None:
    plain, full = read(tmp_path, template()), read(tmp_path, uncommented(template()))
    assert [r.use for r in plain.recordings] == ["identify", "validate"]
    assert full.law.kp == 10.0 and full.recordings[0].window == (2.0, 9.0) and len(full.nameplate) == 10
    assert plain.law.kp is None and plain.recordings[0].window is None


def keys() -> list[str]:
    from lostmotion.io.configuration.models import (
        IdentifyModel,
        LawModel,
        NameplateModel,
        RecordingModel,
        RunModel,
    )

    models = (NameplateModel, RecordingModel, IdentifyModel, LawModel, RunModel)
    return [k for m in models for k in m.model_fields] + [f.name for f in dataclasses.fields(Channel)]


@pytest.mark.parametrize("key", keys())
def test_every_key_is_in_the_template_and_in_the_documentation(key: str) -> None:
    assert re.search(rf"(?<![\w]){key}\b[\w.]* = ", template())
    assert f"`{key}" in DOCUMENT.read_text(encoding="utf-8")


def test_the_examples_of_the_documentation_are_valid(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("RIG_DATA", raising=False)
    examples = re.findall(r"```toml\n(.*?)```", DOCUMENT.read_text(encoding="utf-8"), re.DOTALL)
    assert len(examples) >= 3
    for example in examples:
        read(tmp_path, example if "[[recording]]" in example else MINIMAL + example)


@pytest.mark.parametrize(
    ("text", "where", "got"),
    [
        (
            "[nameplate]\ninertia_lod = 1\n" + MINIMAL,
            "line 2, nameplate.inertia_lod",
            "unknown key 'inertia_lod'",
        ),
        ("[nameplate]\nstiffness = -5\n" + MINIMAL, "line 2, nameplate.stiffness", "-5"),
        ("[nameplate]\nbacklash = '12 mrd'\n" + MINIMAL, "line 2, nameplate.backlash", "unknown unit 'mrd'"),
        ("[nameplate]\ninertia_motor = '1 Nm'\n" + MINIMAL, "line 2, nameplate.inertia_motor", "'1 Nm'"),
        ("[nameplate]\ncoulomb = nan\n" + MINIMAL, "line 2, nameplate.coulomb", "nan"),
        ("[nameplate]\ncoulomb = true\n" + MINIMAL, "line 2, nameplate.coulomb", "True"),
        (MINIMAL + "use = 'train'", "line 3, recording[0].use", "'train'"),
        (MINIMAL + MINIMAL + "us = 'identify'", "line 5, recording[1].us", "unknown key 'us'"),
        (MINIMAL + "window = [3, 2]", "line 3, recording[0].window", "[3.0, 2.0]"),
        (MINIMAL + "window = [1]", "line 3, recording[0].window", "[1], a list of 1"),
        (MINIMAL + "window = 1", "line 3, recording[0].window", "1"),
        ("recording = 'x'", "line 1, recording", "'x'"),
        ("recording = [1]", "line 1, recording", "[1]"),
        ("law = 3\n" + MINIMAL, "line 1, law", "3"),
        (MINIMAL + "[law]\npoles = -1e9", "line 4, law.poles", "-1000000000.0, which is no list"),
        (MINIMAL + "[law]\npoles = [-1, -2, -1e9]", "line 4, law.poles", "[-1, -2, -1000000000.0]"),
        (MINIMAL + f"[law]\nkp = {'9' * 400}\nki = 1", "line 4, law.kp", "99999"),
        (MINIMAL + f"[run]\nseed = 0x{'f' * 9000}", "line 4, run.seed", "a number of thousands of digits"),
        ("[nameplate]\nstiffness = " + "9" * 400 + "\n" + MINIMAL, "line 2, nameplate.stiffness", "99999"),
        (
            MINIMAL.replace("rig.csv", "~nobody-of-this-name/rig.csv"),
            "line 2, recording[0].file",
            "the home folder",
        ),
        ("[nameplate]\nstiffness = '٣'\n" + MINIMAL, "line 2, nameplate.stiffness", "'٣'"),
        ("a = " + "[" * 5000, "rig.toml", "broken TOML: hundreds of brackets"),
        (MINIMAL + "resample = '1 Nm'", "line 3, recording[0].resample", "'1 Nm'"),
        (MINIMAL + "resample = -1", "line 3, recording[0].resample", "-1"),
        (MINIMAL + "speed_from_counts = 1", "line 3, recording[0].speed_from_counts", "1"),
        (MINIMAL + "time = { sample_time = 0 }", "line 3, recording[0].time", "0"),
        (
            MINIMAL + "time = { sample_time = 1, unit = 's' }",
            "line 3, recording[0].time",
            "keys 'sample_time', 'unit'",
        ),
        (MINIMAL + "channels = 3", "line 3, recording[0].channels", "3"),
        (
            MINIMAL + "channels.speed_motr = 1",
            "line 3, recording[0].channels.speed_motr",
            "unknown signal 'speed_motr'",
        ),
        (
            MINIMAL + "channels.twist = { column = 1, sing = 1 }",
            "recording[0].channels.twist",
            "unknown key 'sing'",
        ),
        ("[[recording]]\nfile = 3", "line 2, recording[0].file", "3"),
        ("[[recording]]\nuse = 'identify'", "line 1, recording[0].file", "nothing"),
        ("[recording]\nfile = 'a'", "line 1, recording", "a table [recording]"),
        ("recording = []", "line 1, recording", "none"),
        ("", "rig.toml, recording", "nothing"),
        (MINIMAL + '[identify]\nfixed = ["inertia"]', "line 4, identify.fixed", "unknown parameter"),
        (MINIMAL + '[identify]\nfixed = ["lag"]', "line 4, identify.fixed", "lag, which has no value"),
        (MINIMAL + '[identify]\nfixed = "lag"', "line 4, identify.fixed", "'lag'"),
        (MINIMAL + "[law]\npoles = [-1, -2]", "line 4, law.poles", "[-1, -2]"),
        (MINIMAL + "[law]\npoles = [-1, -2, 3]", "line 4, law.poles", "[-1, -2, 3]"),
        (MINIMAL + "[law]\ntorque_limit = 0", "line 4, law.torque_limit", "0"),
        (MINIMAL + "[law]\nkp = 3", "line 3, law", "kp alone"),
        (MINIMAL + "[law]\nki = 3", "line 3, law", "ki alone"),
        ("a = " + "9" * 5000, "rig.toml", "broken TOML: Exceeds the limit (4300 digits)"),
        (MINIMAL + "[law]\nkp = '3'\nki = 1", "line 4, law.kp", "'3'"),
        (MINIMAL + "[law]\nkp = 0\nki = 1", "line 4, law.kp", "0"),
        (MINIMAL + "[law]\nkp = 3\nki = -1", "line 5, law.ki", "-1"),
        (MINIMAL + "[run]\nseed = 1.5", "line 4, run.seed", "1.5"),
        (MINIMAL + "[run]\nseed = -1", "line 4, run.seed", "-1"),
        ("bogus = 1\n" + MINIMAL, "line 1, bogus", "unknown key 'bogus'"),
        ("a = = 3", "rig.toml", "broken TOML"),
        (
            MINIMAL.replace("rig.csv", "${NOT_SET_ANYWHERE}/rig.csv"),
            "line 2, recording[0].file",
            "the environment",
        ),
    ],
)
def test_problems_point_at_line_and_key(
    tmp_path: Path, text: str, where: str, got: str, problems_of: Problems
) -> None:
    (problem,) = problems_of(lambda: read(tmp_path, text))
    assert problem.where.endswith(where) and problem.got.startswith(got)
    assert problem.severity == "error" and problem.expected and problem.remedy


def parameters() -> list[tuple[str, float, float]]:
    from lostmotion.io.configuration.values import PLAUSIBLE

    return [(name, low, high) for name, (low, high) in PLAUSIBLE.items()]


@pytest.mark.parametrize(("name", "low", "high"), parameters())
def test_absurd_nameplate_values_are_refused(
    tmp_path: Path, name: str, low: float, high: float, problems_of: Problems
) -> None:
    for good in (low, high):
        assert read(tmp_path, f"[nameplate]\n{name} = {good}\n" + MINIMAL).nameplate[name] == good
    for bad in (1e-300, 0.9 * low, 1.1 * high, 1e300):
        text = f"[nameplate]\n{name} = {bad!r}\n" + MINIMAL
        (problem,) = problems_of(lambda text=text: read(tmp_path, text))
        assert problem.where.endswith(f"line 2, nameplate.{name}") and problem.got == repr(bad)
        assert f"{low:g} to {high:g} " in problem.expected and "unit" in problem.remedy


@pytest.mark.parametrize(("name", "low", "high"), parameters())
def test_zero_and_the_bounds_are_as_documented(
    tmp_path: Path, name: str, low: float, high: float, problems_of: Problems
) -> None:
    text = f"[nameplate]\n{name} = 0\n" + MINIMAL
    zero = ""
    if name in ("inertia_motor", "inertia_load", "stiffness"):
        assert problems_of(lambda: read(tmp_path, text))[0].got == "0"
    else:
        assert read(tmp_path, text).nameplate[name] == 0.0
        zero = "0, "
    assert re.search(
        rf"\| `{name}` \| [^|]+ \| {re.escape(f'{zero}{low:g} to {high:g}')} \|",
        DOCUMENT.read_text(encoding="utf-8"),
    )


def test_a_controller_without_integral_part_is_allowed(tmp_path: Path) -> None:
    assert read(tmp_path, MINIMAL + "[law]\nkp = 3\nki = 0").law.ki == 0.0


def test_all_problems_come_together_with_suggestions(tmp_path: Path, problems_of: Problems) -> None:
    text = (
        "[nameplate]\nstifness = 1\ndamping = -1\n"
        + MINIMAL
        + "channels.speed_mot = 1\nchannels.torque_motr = 2\n"
    )
    problems = problems_of(lambda: read(tmp_path, text))
    assert len(problems) == 4
    remedies = " ".join(p.remedy for p in problems)
    assert all(f"'{name}'" in remedies for name in ("stiffness", "speed_motor", "torque_motor"))


def test_missing_configuration(tmp_path: Path, problems_of: Problems) -> None:
    (problem,) = problems_of(lambda: read_configuration(tmp_path / "none.toml"))
    assert "none.toml" in problem.where and problem.got == "no such file"


def test_a_configuration_that_is_not_utf_8(tmp_path: Path, problems_of: Problems) -> None:
    (tmp_path / "rig.toml").write_bytes("# Prüfstand".encode("cp1252"))
    (problem,) = problems_of(lambda: read_configuration(tmp_path / "rig.toml"))
    assert problem.got == "text that is not UTF-8"


def test_files_are_relative_to_the_toml_and_take_environment_variables(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("RIG_DATA", str(tmp_path / "data"))
    monkeypatch.delenv("RIG_OTHER", raising=False)
    text = "".join(
        f'[[recording]]\nfile = "{file}"\n'
        for file in (
            "a.csv",
            "${RIG_DATA}/a.csv",
            "${RIG_OTHER:-../x}/a.csv",
            "${RIG_DATA:-../x}/a.csv",
            "/abs/a.csv",
        )
    )
    files = [source.file for source in read(tmp_path, text).recordings]
    data = tmp_path / "data" / "a.csv"
    assert files == [tmp_path / "a.csv", data, tmp_path / "../x/a.csv", data, Path("/abs/a.csv")]


def test_recordings_are_loaded_and_the_problems_of_all_files_come_together(
    tmp_path: Path, problems_of: Problems
) -> None:
    table = np.column_stack([0.01 * np.arange(200), np.sin(np.arange(200)), np.cos(np.arange(200))])
    np.savetxt(tmp_path / "a.csv", table, delimiter=";", header="t;n [rpm];M [Nm]", comments="")
    np.savetxt(tmp_path / "b.csv", table, delimiter=",")
    good = """
        [[recording]]
        file = "a.csv"
        channels.speed_motor = "n"
        window = [0.5, 1.8]
        [[recording]]
        file = "b.csv"
        use = "validate"
        time = { sample_time = "5 ms" }
        channels.torque_motor = { column = 2, sign = -1 }
        """
    (use, first), (other, second) = load_recordings(read(tmp_path, good))
    assert (use, other) == ("identify", "validate")
    np.testing.assert_allclose(first["speed_motor"], table[50:180, 1] * np.pi / 30, rtol=1e-12)
    np.testing.assert_allclose(second["torque_motor"], -table[:, 2], rtol=1e-12)
    assert second.dt == pytest.approx(5e-3)
    broken = good.replace('"n"', '"m"').replace("b.csv", "c.csv")
    problems = problems_of(lambda: load_recordings(read(tmp_path, broken)))
    assert [p.got for p in problems] == ["no column 'm'", "no such file"]


def test_warnings_of_a_good_file_are_shown_with_the_errors_of_another(
    tmp_path: Path, problems_of: Problems
) -> None:
    table = np.column_stack([0.01 * np.arange(200), np.full(200, 2.5)])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,speed_load", comments="")
    text = '[[recording]]\nfile = "a.csv"\n[[recording]]\nfile = "none.csv"\n'
    problems = problems_of(lambda: load_recordings(read(tmp_path, text)))
    found = [(p.severity, p.got) for p in problems]
    assert ("warning", "the constant 2.5") in found and ("error", "no such file") in found


def test_pydantic_is_loaded_only_when_a_toml_is_read() -> None:
    code = "import sys; from lostmotion.io import RecordingSource; print('pydantic' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], check=True, capture_output=True, text=True)
    assert done.stdout.strip() == "False"


def test_a_drivetrain_instead_of_a_job_is_one_error_that_says_so(tmp_path: Path) -> None:
    plant = Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6e3, damping=0.3)
    save_drivetrain(plant, tmp_path / "drivetrain.toml")
    with pytest.raises(InputProblems) as caught:
        read_configuration(tmp_path / "drivetrain.toml")
    (problem,) = caught.value.problems
    assert "a drivetrain" in problem.got and "recordings" in problem.expected
    assert "lostmotion simulate" in problem.remedy


@pytest.mark.parametrize(
    ("name", "content"),
    [("a.csv", b"time,speed_motor\n0,1\n"), ("a.mat", b"MATLAB\xff\xfe"), ("a.npz", b"PK\xff")],
)
def test_a_recording_instead_of_a_job_is_said_to_be_none(tmp_path: Path, name: str, content: bytes) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputProblems) as caught:
        read_configuration(tmp_path / name)
    (problem,) = caught.value.problems
    assert repr(name[1:]) in problem.got and "[[recording]]" in problem.remedy and name in problem.remedy


INERTIA = 0.1
SLIP = """
[nameplate]
inertia_motor = 0.04
inertia_load = {load}
[[recording]]
file = "log.csv"
time = {{ column = "t", unit = "s" }}
channels.torque_motor = {{ column = "u", unit = "{torque}" }}
channels.speed_motor = {{ column = "w", unit = "{speed}" }}
"""


@pytest.mark.parametrize(
    ("load", "torque", "speed", "told"),
    [
        (0.06, "Nm", "rad/s", False),
        (0.12, "Nm", "rad/s", False),
        (60.0, "Nm", "rad/s", True),
        (0.06, "mNm", "rad/s", True),
        (0.06, "Nm", "rpm", True),
    ],
)
def test_an_acceleration_that_is_not_the_nameplates(
    tmp_path: Path, load: float, torque: str, speed: str, told: bool
) -> None:
    """A wrong unit is seen although neither file nor TOML contradicts itself; the right one is the remedy."""
    time = 1e-3 * np.arange(4000)
    force = 3.0 * np.sin(2.0 * np.pi * 0.7 * time) + np.random.default_rng(1).normal(size=time.size)
    table = np.column_stack([time, force, np.cumsum(force) * 1e-3 / INERTIA])
    np.savetxt(tmp_path / "log.csv", table, delimiter=",", header="t,u,w", comments="", fmt="%.9g")
    (tmp_path / "rig.toml").write_text(SLIP.format(load=load, torque=torque, speed=speed))
    ((_, recording),) = load_recordings(read_configuration(tmp_path / "rig.toml"))
    found = [p for p in recording.meta["problems"] if "an acceleration as of" in p.got]
    assert bool(found) == told
    assert all("Check unit and scale in the channels of torque and speed" in p.remedy for p in found)


def test_an_inertia_is_shown_only_where_torque_and_acceleration_agree() -> None:
    rng = np.random.default_rng(3)
    time = 1e-3 * np.arange(4000)
    force = 3.0 * np.sin(2.0 * np.pi * 0.7 * time) + 0.3 * rng.normal(size=time.size)
    drive = Recording(time, {"torque_motor": force, "speed_motor": np.cumsum(force) * 1e-3 / INERTIA})
    assert inertia_shown(drive) == pytest.approx(INERTIA, rel=0.05)
    turned = Recording(time, {"torque_motor": -force, "speed_motor": drive["speed_motor"]})
    assert inertia_shown(turned) == pytest.approx(-INERTIA, rel=0.05)
    unrelated = Recording(time, {"torque_motor": force, "speed_motor": rng.normal(size=4000)})
    assert inertia_shown(unrelated) is None
    assert inertia_shown(Recording(time, {"torque_motor": force})) is None
