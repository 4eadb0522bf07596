"""Channels of several files, on one clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InvalidInput
from lostmotion.io import aligned, load_recordings, read_configuration
from lostmotion.recording import Recording


def motion(time: np.ndarray) -> np.ndarray:
    return 10.0 * np.sin(2.0 * np.pi * 0.7 * time) + 3.0 * np.sin(2.0 * np.pi * 3.1 * time + 1.0)


def two(shift: float, noise: float = 0.05) -> tuple[Recording, Recording]:
    """A drive's log at 1 kHz, and a measuring card's at 2.3 kHz whose clock is ahead."""
    random = np.random.default_rng(1)
    drive, card = 1e-3 * np.arange(8000), np.arange(0.5, 7.0, 1.0 / 2300.0)
    log = {
        "speed_motor": motion(drive) + noise * random.standard_normal(drive.size),
        "torque_motor": np.cos(drive),
    }
    further = {"speed_motor": motion(card) + noise * random.standard_normal(card.size), "speed_load": card**2}
    return Recording(drive, log), Recording(card + shift, further)


@pytest.mark.parametrize("shift", [0.0, 0.3217, -12.4])
def test_the_clocks_are_shifted_by_what_both_have(shift: float) -> None:
    first, further = two(shift)
    made = aligned(first, further, by="speed_motor")
    assert made.meta["clock_delay"] == pytest.approx(shift, abs=1e-4)
    assert set(made.names) == {"speed_motor", "torque_motor", "speed_load"}
    assert made["speed_load"] == pytest.approx(made.time**2, abs=3e-3)
    assert made.dt == pytest.approx(1e-3) and made.time[0] == pytest.approx(0.5, abs=2e-3)


def test_a_known_delay_is_taken() -> None:
    first, further = two(0.25, noise=0.0)
    made = aligned(first, further, delay=0.25)
    assert made["speed_load"] == pytest.approx(made.time**2, abs=1e-6)
    assert made["speed_motor"] == pytest.approx(motion(made.time))


def test_what_does_not_agree_is_refused() -> None:
    first, further = two(0.0)
    strange = further.with_signals(
        "measured", speed_motor=np.random.default_rng(2).standard_normal(len(further))
    )
    with pytest.raises(InvalidInput, match="at best"):
        aligned(first, strange, by="speed_motor")
    with pytest.raises(InvalidInput, match="rows in common"):
        aligned(first, further, delay=100.0)
    with pytest.raises(InvalidInput, match="a signal that both have"):
        aligned(first, further, by="torque_motor")
    with pytest.raises(InvalidInput, match="one of them"):
        aligned(first, further, by="speed_motor", delay=0.0)


def test_two_files_of_a_toml_are_one_recording(tmp_path: Path) -> None:
    for name, one in zip(("drive", "card"), two(0.3), strict=True):
        columns = np.column_stack([one.time, *(one[signal] for signal in one.names)])
        header = ",".join(["time", *one.names])
        np.savetxt(tmp_path / f"{name}.csv", columns, delimiter=",", header=header, comments="")
    toml = tmp_path / "rig.toml"
    further = '[{ file = "card.csv", by = "speed_motor" }]'
    toml.write_text(f'[[recording]]\nfile = "drive.csv"\nfurther = {further}\n', encoding="utf-8")
    configuration = read_configuration(toml)
    ((use, made),) = load_recordings(configuration)
    assert use == "identify" and made["speed_load"] == pytest.approx(made.time**2, abs=3e-3)
    assert [file.name for file in configuration.recordings[0].files] == ["drive.csv", "card.csv"]
