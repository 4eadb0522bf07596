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
    assert np.array_equal(back.time, recording.time)
    assert np.array_equal(back["torque_motor"], recording["torque_motor"])


def test_a_chain_is_read_back_equal_by_its_numbered_names(tmp_path: Path) -> None:
    rng = np.random.default_rng(2)
    names = (
        "torque_motor",
        "speed_motor",
        "twist_1",
        "twist_2",
        "speed_2",
        "torque_shaft_1",
        "speed_load_estimated",
    )
    signals = {name: rng.standard_normal(300) * 10.0 ** rng.integers(-9, 9) for name in names}
    original = lm.Recording(np.cumsum(rng.uniform(0.98e-5, 1.02e-5, 300)) + 7777.0, signals)
    write_csv(tmp_path / "a.csv", original)
    back = lm.read_recording(tmp_path / "a.csv")
    assert back.names == names and np.array_equal(back.time, original.time)
    assert all(np.array_equal(back[name], original[name]) for name in names)


def test_nothing_is_written_for_a_bad_value(tmp_path: Path) -> None:
    recording = lm.Recording(time=np.arange(3.0), signals={"torque_motor": [0.0, np.nan, 1.0]})
    with pytest.raises(lm.InvalidInput, match="row 1"):
        write_csv(tmp_path / "test.csv", recording)
    assert list(tmp_path.iterdir()) == []
