"""lostmotion certify --box: written, verified, interrupted and gone on with; where the proof stops, a simulation."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.commands.certify_box import certify_box


@pytest.fixture
def drivetrain(tmp_path: Path) -> Path:
    """Files of the paper's drivetrain and of a PI law beside it."""
    lm.save_drivetrain(PAPER, tmp_path / "drivetrain.toml")
    lm.save_law(lm.controllers.pi(dt=1e-4), tmp_path / "law.json")
    return tmp_path / "drivetrain.toml"


def verified(folder: Path) -> tuple[int, str]:
    command = [sys.executable, "-I", "-S", "certificate_verify.py", "certificate.json", "law.json"]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    return done.returncode, done.stdout


def test_an_interrupted_box_goes_on(drivetrain: Path) -> None:
    names = ("inertia_load", "coulomb")

    def stop(share: float, text: str) -> None:
        if 0.0 < share < 1.0:
            raise KeyboardInterrupt

    out = drivetrain.with_name("certificate")
    first = certify_box(drivetrain, out, 25.0, parameters=names, progress=stop)
    assert first["not_proved"] == "interrupted" and "% of the box, are proved" in first["headline"]
    assert verified(drivetrain.parent)[0] == 1
    told: list[float] = []
    second = certify_box(
        drivetrain, out, 25.0, parameters=names, progress=lambda share, text: told.append(share)
    )
    assert second["proved"] and second["cells"] > first["cells"] > 0
    assert min(share for share in told if share) >= first["share_of_the_box"], "it goes on from there"
    code, said = verified(drivetrain.parent)
    assert (
        code == 0
        and said.startswith("For inertia_load times 0.75 to 1.25,\nFor coulomb times")
        and "PROVED" in said
    )
    assert "±25 % of load inertia, Coulomb friction" in second["headline"]


def test_where_the_proof_stops_a_simulation_tells_which_of_the_two_fails(drivetrain: Path) -> None:
    out = drivetrain.with_name("certificate")
    shaky = drivetrain.with_name("shaky.json")
    lm.save_law(lm.controllers.pi(dt=1e-4, kp=400.0), shaky)
    result = certify_box(drivetrain, out, 5.0, law=shaky)
    assert not result["proved"] and result["simulated"].endswith("the loop itself fails")
    assert json.loads(out.with_suffix(".json").read_text())["claim"] is None
    # Observer 1 settles, but with more friction than its law knows the sector allows what does not.
    parts = [lm.observers.kalman(PAPER, dt=1e-4), lm.controllers.pole_placement(PAPER, dt=1e-4)]
    observer = drivetrain.with_name("observer.json")
    lm.save_law(lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",)), observer)
    slow = certify_box(drivetrain, out, 10.0, law=observer, speed=0.2)
    assert not slow["proved"] and slow["stops_at"] is not None
    assert slow["simulated"].endswith("the proof stops, not the loop")
