"""lostmotion certify: what it writes, from which files, and what it refuses."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from typer.testing import CliRunner

import lostmotion as lm
from lostmotion.certificates import ObserverError, observer_headline
from lostmotion.cli import app
from lostmotion.commands.certify import certify_file
from lostmotion.commands.certify_observer import certify_observer
from lostmotion.errors import InvalidInput


@pytest.fixture
def drivetrain(tmp_path: Path) -> Path:
    """Files of a drivetrain and of a PI law beside it."""
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
        viscous=0.0175,
    )  # fmt: skip
    lm.save_drivetrain(plant, tmp_path / "drivetrain.toml")
    lm.save_law(lm.controllers.pi(dt=1e-4), tmp_path / "law.json")
    return tmp_path / "drivetrain.toml"


def verified(folder: Path, *files: str) -> tuple[int, str]:
    command = [sys.executable, "-I", "-S", "certificate_verify.py", *files]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def test_the_law_beside_the_drivetrain_is_proved_and_verified(drivetrain: Path) -> None:
    result = certify_file(drivetrain, drivetrain.with_name("certificate"), delay=1)
    assert result["proved"] and result["speed_from"] <= 0.02
    assert "the torque acts one sample later" in result["conditions"]
    assert {state: each["stable"] for state, each in result["margins"].items()} == {
        "running, gap closed": True, "running, gap open": True, "load held, gap closed": True,
        "load held, gap open": True,
    }  # fmt: skip
    code, said = verified(drivetrain.parent, "certificate.json", "law.json")
    assert code == 0 and said.startswith("PROVED")


def test_simulations_stand_beside_the_proof(drivetrain: Path) -> None:
    lm.save_law(lm.controllers.pi(dt=1e-3), drivetrain.with_name("law.json"))
    result = certify_file(drivetrain, drivetrain.with_name("certificate"), simulate=20, fastest=2.0)
    assert result["proved"]
    variants, worst = result["simulated"]
    assert variants.startswith("0 of 20 simulated variants within ±10 % do not settle")
    assert worst.startswith("The worst of ") and "beyond the proof" in worst


def test_what_is_not_proved_is_written_as_such(drivetrain: Path) -> None:
    shaky = drivetrain.with_name("shaky.json")
    lm.save_law(lm.controllers.pi(dt=1e-4, kp=400.0), shaky)
    result = certify_file(drivetrain, drivetrain.with_name("certificate"), law=shaky)
    assert not result["proved"]
    assert result["headline"].startswith("Stability is not proved: the loop is not stable")
    assert json.loads(drivetrain.with_name("certificate.json").read_text())["claim"] is None
    code, said = verified(drivetrain.parent, "certificate.json")
    assert code == 1 and "claims nothing" in said


def test_a_longer_delay_is_another_loop(drivetrain: Path) -> None:
    certify_file(drivetrain, drivetrain.with_name("certificate"))
    file = drivetrain.with_name("certificate.json")
    content = json.loads(file.read_text())
    content["delay"] = 40
    file.write_text(json.dumps(content))
    code, said = verified(drivetrain.parent, "certificate.json")
    assert code == 1 and said.startswith("NOT PROVED")


def test_a_filter_and_a_missing_law_are_refused(drivetrain: Path) -> None:
    plant = lm.load_drivetrain(drivetrain)
    filter_ = drivetrain.with_name("filter.json")
    lm.save_law(lm.observers.extended_kalman(plant, measured=("speed_motor",), dt=1e-4), filter_)
    out = drivetrain.with_name("certificate")
    with pytest.raises(InvalidInput, match="DiscreteSystem"):
        certify_file(drivetrain, out, law=filter_)
    drivetrain.with_name("law.json").unlink()
    with pytest.raises(InvalidInput, match="--law"):
        certify_file(drivetrain, out)
    assert not out.with_name("certificate.json").exists()


def test_an_observer_alone_is_refused(drivetrain: Path) -> None:
    plant = lm.load_drivetrain(drivetrain)
    lm.save_law(lm.observers.kalman(plant, dt=1e-4), drivetrain.with_name("law.json"))
    with pytest.raises(InvalidInput, match="torque_motor"):
        certify_file(drivetrain, drivetrain.with_name("certificate"))


def test_the_bound_of_an_observer_is_proved_and_verified(drivetrain: Path) -> None:
    done = CliRunner().invoke(
        app, ["certify", str(drivetrain), "--out", str(drivetrain.with_name("certificate")),
              "--observer", "torque_shaft", "--observer", "speed_motor"],
    )  # fmt: skip
    assert done.exit_code == 0 and "Proved: whatever the drive does" in done.output
    code, said = verified(drivetrain.parent, "certificate.json")
    assert code == 0 and "PROVED: during every motion" in said
    proof = certify_observer(drivetrain, drivetrain.with_name("wrong"), ["speed_motor"], force=True)
    assert "while its parameters are right" in observer_headline(proof)
    assert "No bound" in observer_headline(ObserverError(None, None, None, "nothing found"))
