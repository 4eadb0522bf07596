"""What write_csv writes, read_recording reads."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.io import write_csv


def test_written_and_read_back(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    recording = lm.Recording(
        time=np.arange(5000) * 1e-4,
        signals={"torque_motor": 30.0 * rng.standard_normal(5000), "speed_motor": rng.standard_normal(5000)},
    )
    write_csv(tmp_path / "test.csv", recording, names=("torque_motor",))
    first = (tmp_path / "test.csv").read_text().splitlines()[0]
    assert first == "time [s],torque_motor [Nm]"
    back = lm.read_recording(
        tmp_path / "test.csv", channels={"time": "time [s]", "torque_motor": "torque_motor [Nm]"}
    )
    assert back.names == ("torque_motor",)
    assert np.allclose(back.time, recording.time, atol=1e-12)
    assert np.allclose(back["torque_motor"], recording["torque_motor"], rtol=1e-8)


def test_nothing_is_written_for_a_bad_value(tmp_path: Path) -> None:
    recording = lm.Recording(time=np.arange(3.0), signals={"torque_motor": [0.0, np.nan, 1.0]})
    with pytest.raises(lm.InvalidInput, match="row 1"):
        write_csv(tmp_path / "test.csv", recording)
    assert list(tmp_path.iterdir()) == []
