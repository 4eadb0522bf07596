"""The command line as a user calls it: exit codes, messages, nothing lost."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

import lostmotion as lm
from lostmotion.io.storage.written_files import MANIFEST

GOOD = """
[nameplate]
inertia_motor = 0.02
[[recording]]
file = "short.csv"
time = {{ column = 0, unit = "s" }}
channels.speed_motor = {{ column = 1, unit = "{unit}" }}
"""


def call(*arguments: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "lostmotion", *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, timeout=300, cwd=cwd, check=False)


def write_recording(folder: Path, rows: int = 300, bad: str = "") -> None:
    lines = [f"{k * 1e-3:.3f},{k % 7}" for k in range(rows)]
    if bad:
        lines[rows // 2] = bad
    (folder / "short.csv").write_text("\n".join(lines) + "\n")


def test_version() -> None:
    done = call("--version")
    assert done.returncode == 0
    assert done.stdout.strip() == f"lostmotion {lm.__version__}"


def test_help_states_the_exit_codes() -> None:
    for arguments in (["--help"], ["run", "--help"], ["check", "--help"]):
        done = call(*arguments)
        assert done.returncode == 0
        assert "Exit codes" in done.stdout
        assert "130" in done.stdout


def test_exit_codes_promise_an_untouched_output_of_a_run_alone() -> None:
    texts = {c: " ".join(call(c, "--help").stdout.replace("│", " ").split()) for c in ("run", "identify")}
    assert "nothing was written" in texts["run"]
    assert "nothing was written" not in texts["identify"]


def test_simulate_names_both_files(tmp_path: Path) -> None:
    plant = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.3)
    lm.save_drivetrain(plant, tmp_path / "plant.toml")
    done = call("simulate", "plant.toml", "--duration", "0.1", "--out", "a.csv", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "written: a.csv, a.png" in done.stdout
    assert {p.name for p in tmp_path.iterdir()} == {"plant.toml", "a.csv", "a.png", MANIFEST}


def test_simulate_variants_writes_a_row_for_each(tmp_path: Path) -> None:
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.3, backlash=0.01
    )
    lm.save_drivetrain(plant, tmp_path / "plant.toml")
    options = ("--duration", "0.5", "--variants", "12", "--spread", "0.1", "--seed", "3", "--out", "a.csv")
    done = call("simulate", "plant.toml", *options, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "12 of 12 variants" in done.stdout and "written: a.csv, a.png" in done.stdout
    assert {p.name for p in tmp_path.iterdir()} == {
        "plant.toml",
        "a.csv",
        "a.png",
        MANIFEST,
    }  # chunks are cleared away
    assert len((tmp_path / "a.csv").read_text().splitlines()) == 13


@pytest.mark.parametrize(
    "options",
    [
        ("--spread", "1.5"),
        ("--spread", "nan"),
        ("--variants", "0"),
        ("--dt", "0"),
        ("--duration", "nan"),
        ("--seed", "-1"),
    ],
)
def test_options_out_of_their_range_are_wrong_usage(tmp_path: Path, options: tuple[str, str]) -> None:
    lm.save_drivetrain(
        lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6e3, damping=0.3),
        tmp_path / "plant.toml",
    )
    refused = call("simulate", "plant.toml", "--variants", "3", "--duration", "0.1", *options, cwd=tmp_path)
    assert refused.returncode == 2 and options[0] in refused.stderr
    assert [p.name for p in tmp_path.iterdir()] == ["plant.toml"]


@pytest.mark.parametrize(
    "arguments",
    [
        ["--dt", "0"],
        ["--duration", "nan"],
        ["--torque-limit", "-1"],
        ["--speed-limit", "0"],
        ["--encoder-bits", "-3"],
        ["--encoder-bits", "99"],
    ],
)
def test_excite_refuses_impossible_numbers(tmp_path: Path, arguments: list[str]) -> None:
    done = call("excite", "--out", tmp_path / "x", *arguments)
    assert done.returncode == 2
    assert "Traceback" not in done.stderr
    assert not list(tmp_path.iterdir())


def test_wrong_usage() -> None:
    assert call("run", "--sed", "3").returncode == 2
    assert call("frobnicate").returncode == 2


def test_missing_file_is_one_clear_error(tmp_path: Path) -> None:
    done = call("run", tmp_path / "no.toml", "--out", tmp_path / "out")
    assert done.returncode == 1
    assert "no.toml" in done.stderr
    assert "remedy" in done.stderr
    assert "Traceback" not in done.stderr
    assert not (tmp_path / "out").exists()


def test_init_check_and_no_overwriting(tmp_path: Path) -> None:
    target = tmp_path / "rig.toml"
    assert call("init", target).returncode == 0
    written = target.read_text()
    again = call("init", target)
    assert again.returncode == 1
    assert "--force" in again.stderr
    assert target.read_text() == written
    assert call("init", target, "--force").returncode == 0


def test_init_writes_the_schema_beside_it_and_refers_to_it(tmp_path: Path) -> None:
    assert call("init", "rig.toml", "--schema", cwd=tmp_path).returncode == 0
    assert json.loads((tmp_path / "lostmotion.schema.json").read_text()) == lm.io.configuration_schema()
    first, rest = (tmp_path / "rig.toml").read_text().split("\n", 1)
    assert first == "#:schema ./lostmotion.schema.json" and rest == lm.io.template()
    assert lm.io.read_configuration(tmp_path / "rig.toml").nameplate["stiffness"] == 6000.0
    (tmp_path / "lostmotion.schema.json").write_text("mine")
    again = call("init", "other.toml", "--schema", cwd=tmp_path)
    assert again.returncode == 1 and "lostmotion.schema.json" in again.stderr
    assert (tmp_path / "lostmotion.schema.json").read_text() == "mine" and not (
        tmp_path / "other.toml"
    ).exists()


@pytest.mark.parametrize(
    ("unit", "bad", "expected"),
    [
        ("furlong", "", "furlong"),
        ("rad/s", "0.150,nan", "nan"),
        ("rad/s", "0.150,abc", "abc"),
        ("rad/s", "0.190,3", "time"),
    ],
)
def test_check_names_what_is_wrong(tmp_path: Path, unit: str, bad: str, expected: str) -> None:
    write_recording(tmp_path, bad=bad)
    (tmp_path / "rig.toml").write_text(GOOD.format(unit=unit))
    done = call("check", tmp_path / "rig.toml", "--json")
    assert done.returncode == 1, done.stderr
    problems = json.loads(done.stdout)
    assert any(expected in str(p).lower() and p["severity"] == "error" for p in problems)


def test_check_of_a_good_file(tmp_path: Path) -> None:
    write_recording(tmp_path)
    (tmp_path / "rig.toml").write_text(GOOD.format(unit="rpm"))
    done = call("check", tmp_path / "rig.toml")
    assert done.returncode == 0, done.stderr
    assert "readable" in done.stdout


def test_recording_without_torque_still_gives_a_report(tmp_path: Path) -> None:
    write_recording(tmp_path)
    (tmp_path / "rig.toml").write_text(GOOD.format(unit="rad/s"))
    done = call("run", tmp_path / "rig.toml", "--out", tmp_path / "out", "--json")
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    results = json.loads(done.stdout)
    assert results["fits"]["prediction error"] == {"skipped": "no torque_motor in the recording"}
    assert results["parameters"]["inertia_motor"]["source"] == "nameplate"
    assert results["parameters"]["backlash"]["value"] is None
    assert (tmp_path / "out" / "report.html").exists()


def test_quiet_says_nothing(tmp_path: Path) -> None:
    write_recording(tmp_path)
    (tmp_path / "rig.toml").write_text(GOOD.format(unit="rad/s"))
    done = call("run", tmp_path / "rig.toml", "--out", tmp_path / "out", "--quiet")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.mark.skipif(os.name == "nt", reason="signals as on POSIX systems")
def test_ctrl_c_keeps_the_previous_output(tmp_path: Path) -> None:
    write_recording(tmp_path)
    (tmp_path / "rig.toml").write_text(GOOD.format(unit="rad/s"))
    assert call("run", tmp_path / "rig.toml", "--out", tmp_path / "out", "-q").returncode == 0
    before = (tmp_path / "out" / "results.json").read_bytes()
    command = [sys.executable, "-m", "lostmotion", "run", "--out", str(tmp_path / "out")]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as process:
        assert process.stderr is not None
        while "identify" not in process.stderr.readline():
            pass
        time.sleep(0.2)
        process.send_signal(signal.SIGINT)
        rest = process.stderr.read()
        assert process.wait(timeout=60) == 130, rest
    assert "Interrupted" in rest
    assert "Traceback" not in rest
    assert (tmp_path / "out" / "results.json").read_bytes() == before
    assert {p.name for p in tmp_path.iterdir()} == {"short.csv", "rig.toml", "out"}


def complete(shell: str, **environment: str) -> str:
    """What the installed command answers a shell that asks by the environment, as completion scripts do."""
    code = "import sys; sys.argv[0] = 'lostmotion'; from lostmotion.cli import main; main()"
    asked = {**os.environ, "_LOSTMOTION_COMPLETE": shell, **environment}
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, env=asked, check=False
    )
    return done.stdout


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish", "powershell"])
def test_a_completion_script_for_each_shell(shell: str) -> None:
    script = complete(f"source_{shell}")
    assert "_LOSTMOTION_COMPLETE" in script and f"complete_{shell}" in script


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("i", ["init", "identify"]),
        ("run --s", ["--seed"]),
        ("init --sch", ["--schema"]),
        ("compare o", ["observers"]),
        ("frf --method H", ["H1", "H2", "Hv"]),
        ("frf --output speed_m", ["speed_motor"]),
        ("excite --kind ", ["levels", "step", "chirp", "multisine", "prbs", "noise"]),
    ],
)
def test_commands_options_and_values_are_completed(typed: str, offered: list[str]) -> None:
    words = f"lostmotion {typed}"
    found = complete("complete_bash", COMP_WORDS=words, COMP_CWORD=str(len(words.split(" ")) - 1))
    assert found.split() == offered


def test_the_kinds_that_are_offered_are_all_that_there_are() -> None:
    from lostmotion.cli.options import KINDS
    from lostmotion.rig import excitation

    assert set(KINDS) == set(excitation.KINDS)
