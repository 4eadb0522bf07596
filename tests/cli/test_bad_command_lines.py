"""Sixty command lines that cannot be right: an exit code of 1 or 2, the cause, a remedy, and nothing written."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import cli

#: Arguments, exit code, words of the message.
LINES = """
check                                          | 2 | Missing argument
check no.toml                                  | 1 | no such file
check .                                        | 1 | Name the file in it
check rig.npz                                  | 1 | A recording is named in a TOML
check law.json                                 | 1 | '.json' that is no TOML
check drivetrain.toml                          | 1 | simulate and excite take a drivetrain
check empty.toml                               | 1 | Add a [[recording]]
check rig.toml extra                           | 2 | unexpected extra argument
check --jason rig.toml                         | 2 | No such option
run no.toml                                    | 1 | no such file
run empty.toml                                 | 1 | Add a [[recording]]
run drivetrain.toml                            | 1 | a drivetrain, which a run writes
run rig.toml --out rig.csv                     | 1 | Choose another name for the output
run rig.toml --out .                           | 1 | the working folder
run rig.toml --out ..                          | 1 | or one above it
run rig.toml --out mine                        | 1 | keep.txt
run rig.toml --seed -1                         | 2 | --seed
run rig.toml --seed x                          | 2 | --seed
run rig.toml --out                             | 2 | requires an argument
run a b                                        | 2 | unexpected extra argument
simulate drivetrain.toml --spread 0.5          | 2 | does nothing without --variants
simulate drivetrain.toml --torque rig.csv --dt 1 | 2 | does nothing beside --torque
certify drivetrain.toml --box-speed 5          | 2 | does nothing without --box
certify drivetrain.toml --box 5 --simulate 5   | 2 | does nothing beside --box
certify drivetrain.toml --observer twist --box 5 | 2 | does nothing beside --observer
identify no.toml                               | 1 | no such file
identify rig.csv                               | 1 | A recording is named in a TOML
identify rig.toml --out rig                    | 1 | Choose another name or folder
identify rig.toml --seed 1.5                   | 2 | --seed
run rig.toml --seed 99999999999999999999       | 1 | 18 digits at most
frf rig.npz --low nan                          | 1 | a finite number
frf rig.npz --low 100 --high 1                 | 1 | low < high
frf rig.npz --high -5                          | 1 | low < high
frf rig.npz --low fast                         | 2 | --low
frf rig.npz --input torque                     | 1 | no such signal
frf rig.npz --output nothing                   | 1 | no such signal
frf rig.npz --reference nothing                | 1 | no such signal
frf rig.npz --method H3                        | 2 | none of H1, H2, Hv
frf no.npz                                     | 1 | no such file
frf law.json                                   | 1 | that is no TOML
excite --duration 0                            | 2 | above 0
excite --duration -1                           | 2 | above 0
excite --duration inf                          | 2 | a finite number
excite --dt nan                                | 2 | above 0
excite --dt 1e-9                               | 1 | of memory are needed
excite --duration 1e12                         | 1 | Take fewer
excite --duration 1e-3                         | 1 | expected
excite --kind noisy                            | 1 | multisine
excite --torque-limit 0                        | 2 | above 0
excite --torque-limit nan                      | 2 | above 0
excite --speed-limit -1                        | 2 | above 0
excite --angle-limit 0                         | 2 | above 0
excite --encoder-bits 0                        | 2 | --encoder-bits
excite --encoder-bits 12.5                     | 2 | --encoder-bits
excite no.toml                                 | 1 | no such file
excite rig.csv                                 | 1 | A run writes one, drivetrain.toml
simulate                                       | 2 | Missing argument
simulate no.toml                               | 1 | no such file
simulate law.json                              | 1 | A run writes one, drivetrain.toml
simulate rig.toml                              | 1 | inertia_load
simulate drivetrain.toml --out rig.csv         | 1 | has not written
simulate drivetrain.toml --torque no.csv       | 1 | no such file
simulate drivetrain.toml --torque law.json     | 1 | expected
simulate drivetrain.toml --torque speed.csv    | 1 | a column torque_motor
simulate drivetrain.toml --duration 1e9        | 1 | of memory are needed
simulate drivetrain.toml --dt 1e-12            | 1 | Take fewer
simulate drivetrain.toml --dt 0                | 2 | above 0
simulate drivetrain.toml --variants 0          | 2 | --variants
simulate drivetrain.toml --variants 1000000000 | 1 | Take fewer
simulate drivetrain.toml --variants 2 --spread 1 | 2 | 0.2 is 20 %
loop                                           | 2 | Missing argument
loop no.json                                   | 1 | no such file
loop drivetrain.toml                           | 1 | expected
loop observer.json                             | 1 | Connect observer and controller
loop law.json no.toml                          | 1 | no such file
loop law.json --seconds 0                      | 2 | above 0
loop law.json --seconds 1e-3                   | 1 | Lengthen the run
loop law.json --seconds 1e9                    | 1 | of memory are needed
loop law.json --speed nan                      | 2 | above 0
loop law.json --code fortran                   | 2 | none of c, python
loop law.json --port 70000                     | 2 | --port
loop law.json --out rig                        | 1 | has not written
init rig.toml                                  | 1 | an existing file
init .                                         | 1 | an existing file
init no/where/x.toml                           | 1 | folder
--memory-limit lots check rig.toml             | 1 | "4GB" or "500MB"
--memory-limit -1 check rig.toml               | 1 | a size such as
--memory-limit 1kB check rig.toml              | 1 | a size such as
compare observers --seeds 0                    | 2 | --seeds
compare everything                             | 2 | No such command
frobnicate                                     | 2 | No such command
"""


def lines() -> list[tuple[str, int, str]]:
    cut = [line.rsplit("|", 2) for line in LINES.strip().splitlines()]
    return [(arguments.strip(), int(code), words.strip()) for arguments, code, words in cut]


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("user") / "here"
    (folder / "mine").mkdir(parents=True)
    (folder / "mine" / "keep.txt").write_text("mine")
    plant = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6e3, damping=0.4)
    lm.save_drivetrain(plant, folder / "drivetrain.toml")
    torque = np.random.default_rng(1).normal(size=3000)
    recording = lm.simulate(plant, torque_motor=torque, dt=1e-3)
    lm.save_recording(recording, folder / "rig.npz")
    lm.save_law(lm.controllers.pi(dt=1e-3), folder / "law.json")
    lm.save_law(lm.observers.kalman(plant, dt=1e-3), folder / "observer.json")
    lm.io.write_csv(folder / "rig.csv", recording)
    lm.io.write_csv(folder / "speed.csv", recording, names=("speed_motor",))
    (folder / "rig.toml").write_text('[nameplate]\ninertia_motor = 0.02\n[[recording]]\nfile = "rig.csv"\n')
    (folder / "empty.toml").write_text("")
    (folder / "rig.json").write_text("mine")
    return folder


def said_by(
    arguments: list[str], monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> tuple[int, str]:
    """Exit code and standard error of a command."""
    monkeypatch.setattr(sys, "argv", ["lostmotion", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    text = capsys.readouterr().err
    return int(ended.value.code or 0), " ".join(text.replace("│", " ").split())


@pytest.mark.parametrize(("arguments", "code", "words"), lines())
def test_what_is_said(
    place: Path, arguments: str, code: int, words: str, monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(place)
    monkeypatch.setenv("COLUMNS", "300")
    monkeypatch.setenv("LOSTMOTION_MEMORY_LIMIT", "1GB")
    before = {path: path.stat().st_mtime_ns for path in place.rglob("*")}
    found, text = said_by(arguments.split(), monkeypatch, capsys)
    assert found == code, text
    assert words in text
    if code == 1:
        assert "got" in text and "expected" in text and "remedy" in text
    assert {path: path.stat().st_mtime_ns for path in place.rglob("*")} == before


@pytest.mark.parametrize("name", ["n" * 5000, "n" * 300], ids=["5000", "300"])
@pytest.mark.parametrize(
    "command",
    ["check {}", "run {}", "run rig.toml --out {}", "identify {}", "identify rig.toml --out {}", "frf {}",
     "frf rig.npz --out {}", "excite {}", "simulate {}", "simulate drivetrain.toml --torque {}",
     "simulate drivetrain.toml --out {}.csv", "init {}"],
)  # fmt: skip
def test_names_that_no_file_can_have(
    place: Path, command: str, name: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(place)
    before = set(place.iterdir())
    code, text = said_by([part.format(name) for part in command.split()], monkeypatch, capsys)
    assert code == 1 and "remedy" in text and len(text) < 4000
    assert set(place.iterdir()) == before
