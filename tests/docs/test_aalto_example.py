"""The example for the measured rig: it is valid, and reading it gives what the documentation says."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from lostmotion.identification.backlash.torque_reversals import backlash_excited
from lostmotion.identification.shaft.ring_down import ring_down
from lostmotion.identification.shaft.stiffness import shaft_stiffness
from lostmotion.io.configuration.read import load_recordings, read_configuration

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "aalto.toml"
DATA = Path(os.environ.get("LOSTMOTION_DATA", ROOT / ".." / "shared" / "data")).resolve()


def test_measured_rig_from_its_example(monkeypatch: pytest.MonkeyPatch) -> None:
    if not (DATA / "aalto").is_dir():
        pytest.skip(f"no {DATA / 'aalto'}: set LOSTMOTION_DATA to the folder of measured data")
    monkeypatch.setenv("LOSTMOTION_DATA", str(DATA))
    (use_step, step), (use_sine, sine) = load_recordings(read_configuration(EXAMPLE))
    assert (use_step, use_sine) == ("identify", "validate")
    for recording in (step, sine):
        assert set(recording.names) == {"speed_motor", "speed_load", "torque_shaft"}
        assert recording.dt == pytest.approx(0.996e-3, rel=1e-4)
        assert shaft_stiffness(recording).values["stiffness"] == pytest.approx(113.0, rel=0.01)
        assert backlash_excited(recording).excited is False
    assert ring_down(step).values["frequency"] == pytest.approx(28.2, rel=0.03)
    assert ring_down(sine).values["frequency"] is None
