"""Ring-down: synthetic ones with known frequency and damping, recordings without, and the measured rig."""

from __future__ import annotations

import numpy as np
import pytest
from measured_shaft import measured

from lostmotion.errors import InvalidInput
from lostmotion.identification.shaft.ring_down import ring_down
from lostmotion.recording import Recording

DT = 1e-3


def ringing(
    seed: int,
    *,
    frequency: float = 28.0,
    ratio: float = 0.04,
    noise: float = 0.1,
    line: float = 0.0,
    steps: tuple[tuple[float, float], ...] = ((4.0, 1.0), (8.0, -1.0)),
) -> Recording:
    """Step responses of one oscillator, with white noise and a foreign line at 22.3 Hz."""
    random = np.random.default_rng(seed)
    t = np.arange(12_000) * DT
    y = noise * random.standard_normal(t.size) + line * np.sin(2.0 * np.pi * (22.3 * t + random.random()))
    for start, height in steps:
        u = np.maximum(t - start - random.uniform(-0.2, 0.2), 0.0)
        w = 2.0 * np.pi * frequency
        swing = np.exp(-ratio * w * u) * np.cos(w * np.sqrt(1.0 - ratio**2) * u)
        y += height * (u > 0.0) * (1.0 - swing)
    return Recording(t, {"torque_shaft": y})


@pytest.mark.parametrize(
    ("frequency", "ratio", "line"),
    [(28.0, 0.04, 0.0), (28.0, 0.04, 0.15), (12.0, 0.04, 0.0), (50.0, 0.1, 0.0), (100.0, 0.02, 0.0)],
)
def test_truth_lies_in_the_intervals(frequency: float, ratio: float, line: float) -> None:
    found = [ring_down(ringing(s, frequency=frequency, ratio=ratio, line=line)) for s in range(10)]
    for name, truth in (("frequency", frequency), ("damping_ratio", ratio)):
        hits = [f.intervals[name][0] <= truth <= f.intervals[name][1] for f in found]
        assert sum(hits) >= 8, name
        width = np.median([f.intervals[name][1] - f.intervals[name][0] for f in found])
        assert width < {"frequency": 0.05, "damping_ratio": 1.0}[name] * truth


def test_clean_ring_down_is_exact() -> None:
    found = ring_down(ringing(1, noise=0.0))
    assert found.values["frequency"] == pytest.approx(28.0, rel=1e-9)
    assert found.values["damping_ratio"] == pytest.approx(0.04, rel=1e-7)
    assert found.explained == pytest.approx(1.0)
    assert set(found.sources.values()) == {"identified"}


@pytest.mark.parametrize("begin", [0.1, 0.2])
def test_a_recording_may_begin_inside_the_decay(begin: float) -> None:
    recording = ringing(1, noise=0.02, steps=((4.0, 1.0),)).window(4.2 + begin)
    found = ring_down(recording)
    assert found.steps == (recording.time[0],)
    for name, truth in (("frequency", 28.0), ("damping_ratio", 0.04)):
        low, high = found.intervals[name]
        assert low <= truth <= high, name
        assert high - low < {"frequency": 0.05, "damping_ratio": 0.8}[name] * truth


def test_finds_the_steps_and_gives_windows_for_plots() -> None:
    found = ring_down(ringing(2, noise=0.05, steps=((4.0, 1.0), (8.0, -0.8), (10.0, 0.1))))
    assert found.steps == pytest.approx((4.0, 8.0), abs=0.25)  # the third is too small beside them
    assert len(found.windows) == 2
    for time, signal, fit in found.windows:
        assert time.shape == signal.shape == fit.shape
        assert np.std(signal - fit) < 0.07


def test_same_seed_same_intervals() -> None:
    recording = ringing(3)
    assert ring_down(recording, seed=5).intervals == ring_down(recording, seed=5).intervals
    assert ring_down(recording, seed=5).intervals != ring_down(recording, seed=6).intervals


def _signals() -> dict[str, np.ndarray]:
    t = np.arange(12_000) * DT
    noise = 0.02 * np.random.default_rng(4).standard_normal(t.size)
    return {
        "constant": np.ones_like(t),
        "noise": noise,
        "sine": np.sin(2.0 * np.pi * 31.4 * t) + noise,
        "bare step": (t > 5.0) + noise,
        "clean step": (t > 11.0).astype(float),
        "creep": np.where(t > 5.0, 1.0 - np.exp(-(t - 5.0) / 0.1), 0.0) + noise,
        "step under a steady line": (t > 5.0) + np.sin(2.0 * np.pi * 22.3 * t) + 5.0 * noise,
        "step with a buried swing": ringing(8, noise=0.3, steps=((4.0, 0.3),))["torque_shaft"] + (t > 4.0),
        "step at the end": (t > 11.85) * (1.0 - np.cos(2.0 * np.pi * 28.0 * (t - 11.85))) + noise,
    }


@pytest.mark.parametrize("name", list(_signals()))
def test_without_a_ring_down_no_number_is_made_up(name: str) -> None:
    found = ring_down(Recording(np.arange(12_000) * DT, {"torque_shaft": _signals()[name]}))
    assert found.values["frequency"] is None
    assert found.values["damping_ratio"] is None
    assert found.intervals == {}
    assert set(found.sources.values()) == {"not excited"}
    assert len(found.problems) == 1


def test_a_mode_outside_the_band_is_not_reported() -> None:
    assert ring_down(ringing(5, frequency=28.0), band=(35.0, 60.0)).values["frequency"] is None


def test_misuse_is_refused() -> None:
    with pytest.raises(InvalidInput, match="band"):
        ring_down(ringing(1), band=(3.0, 900.0))
    with pytest.raises(InvalidInput, match="no such signal"):
        ring_down(ringing(1), signal="speed_load")


def test_measured_load_step() -> None:
    found = ring_down(measured("step_sensor.csv"))
    assert found.values["frequency"] == pytest.approx(28.2, rel=0.03)
    assert found.values["damping_ratio"] is not None
    assert 0.035 <= found.values["damping_ratio"] <= 0.05
    low, high = found.intervals["frequency"]
    assert low < 28.2 < high
    assert high - low < 1.0
    assert found.steps == pytest.approx((4.67, 9.83), abs=0.05)


def test_speeds_agree_with_the_torque_or_say_nothing() -> None:
    recording = measured("step_sensor.csv")
    torque, load = ring_down(recording), ring_down(recording, signal="speed_load", band=(3.0, 60.0))
    assert torque.values["frequency"] is not None
    assert load.intervals["frequency"][0] < torque.values["frequency"] < load.intervals["frequency"][1]
    assert load.explained < 0.2 < torque.explained  # mostly noise, and so the wider interval
    assert np.diff(load.intervals["damping_ratio"]) > np.diff(torque.intervals["damping_ratio"])
    assert ring_down(recording, signal="speed_motor").values["frequency"] is None  # held by its controller


@pytest.mark.parametrize("signal", ["torque_shaft", "speed_motor", "speed_load"])
def test_measured_sine_load_has_no_ring_down(signal: str) -> None:
    assert ring_down(measured("sin_sensor.csv"), signal=signal).values["frequency"] is None
