"""lostmotion loop: its files, its verdict, what it refuses, and that an interruption leaves no process."""

from __future__ import annotations

import contextlib
import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.commands import loop
from lostmotion.commands.loop import loop_file, rig_around, same_bits, set_points
from lostmotion.errors import InvalidInput


@pytest.fixture
def files(tmp_path: Path) -> tuple[Path, Path]:
    lm.save_law(lm.controllers.pi(dt=1e-3, torque_limit=40.0), tmp_path / "law.json")
    lm.save_drivetrain(PAPER, tmp_path / "drivetrain.toml")
    return tmp_path / "law.json", tmp_path / "drivetrain.toml"


def test_in_lock_step_it_compares_and_writes(files: tuple[Path, Path], tmp_path: Path) -> None:
    result = loop_file(*files, tmp_path / "loop", seconds=0.3)
    assert result.equal is True
    content = json.loads((tmp_path / "loop.json").read_text())
    assert content["equals_simulation"] is True and content["samples"] == 300 and content["law"] == "pi"
    assert 0.0 < content["round_trip"]["median"] <= content["round_trip"]["largest"]
    assert (tmp_path / "loop.png").read_bytes()[1:4] == b"PNG"
    reference = result.run.recording["speed_reference"]
    assert (reference[149], reference[150]) == (-2.0, 2.0)


def test_a_difference_from_the_simulation_is_told(
    files: tuple[Path, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    honest = loop.run_loop

    def louder(law: Any, *args: Any, **kwargs: Any) -> Any:
        return honest(lm.controllers.pi(dt=1e-3, torque_limit=40.0, kp=10.000001), *args, **kwargs)

    monkeypatch.setattr(loop, "run_loop", louder)
    assert loop_file(*files, tmp_path / "loop", seconds=0.2, code="python").equal is False


def test_bits_are_compared_not_values() -> None:
    time_axis = np.arange(3.0)
    one, other = (lm.Recording(time_axis, {"twist": np.array([0.0, zero, 1.0])}) for zero in (0.0, -0.0))
    assert same_bits(one, one) and not same_bits(one, other)


def test_the_rig_has_the_parameters_of_the_drivetrain() -> None:
    plant = rig_around(PAPER, 1)
    assert len(plant.drivetrain.inertias) == 4
    assert plant.drivetrain.inertia_total == pytest.approx(PAPER.inertia_total)
    assert max(shaft.backlash for shaft in plant.drivetrain.shafts) == PAPER.backlash
    assert rig_around(plant.drivetrain, 1).drivetrain is plant.drivetrain
    with pytest.raises(InvalidInput, match="one inertia"):
        rig_around(lm.Drivetrain((0.1,)), 1)


@pytest.mark.parametrize(
    ("law", "samples", "said"),
    [
        (lm.observers.kalman(PAPER, dt=1e-3), 100, "Connect observer and controller"),
        (lm.controllers.pole_placement(PAPER, dt=1e-3), 100, "twist_elastic_estimated"),
        (lm.controllers.pi(dt=1e-3), 1, "2 or more"),
    ],
)
def test_what_no_rig_can_serve_is_refused_before_a_process_starts(law: Any, samples: int, said: str) -> None:
    with pytest.raises(InvalidInput, match=said):
        set_points(law, samples, 2.0)


@pytest.mark.skipif(not Path("/proc/self/stat").exists(), reason="processes as Linux lists them")
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGKILL])
def test_an_interruption_leaves_no_process_and_no_file(
    files: tuple[Path, Path], tmp_path: Path, number: signal.Signals
) -> None:
    command = [sys.executable, "-m", "lostmotion", "loop", "law.json", "--paced", "--seconds", "60"]
    with subprocess.Popen(
        [*command, "--code", "python"], cwd=tmp_path, stderr=subprocess.PIPE, text=True
    ) as process:
        assert process.stderr is not None
        for line in process.stderr:
            if line.startswith("loop"):
                break
        laws = children_of(process.pid)
        assert len(laws) == 1
        process.send_signal(number)
        rest = process.communicate(timeout=60)[1]
    assert process.returncode == (-number if number == signal.SIGKILL else 128 + number), rest
    assert "Traceback" not in rest
    until = time.monotonic() + 10.0
    while (left := is_running(laws[0])) and time.monotonic() < until:
        time.sleep(0.05)
    assert not left
    if number != signal.SIGKILL:
        assert sorted(path.name for path in tmp_path.iterdir()) == ["drivetrain.toml", "law.json"]


def children_of(parent: int) -> list[int]:
    found = []
    for stat in Path("/proc").glob("[0-9]*/stat"):
        with contextlib.suppress(OSError):
            # After the name in brackets: state, then the parent.
            if int(stat.read_text().rpartition(")")[2].split()[1]) == parent:
                found.append(int(stat.parent.name))
    return found


def is_running(process: int) -> bool:
    """A zombie, which nobody has waited for, is none."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
