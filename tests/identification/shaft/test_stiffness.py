"""Shaft stiffness and torque delay: synthetic shafts with known values, and the measured rig."""

from __future__ import annotations

import numpy as np
import pytest
from measured_shaft import measured

from lostmotion.errors import InvalidInput
from lostmotion.identification.shaft.stiffness import ShaftStiffness, shaft_stiffness
from lostmotion.recording import Recording

STIFFNESS, DELAY, DT = 110.0, 3.7e-4, 1e-3


def shaft(
    seed: int,
    *,
    speed_noise: float = 0.05,
    torque_noise: float = 0.02,
    inertia: float = 0.0,
    damping: float = 0.0,
    duration: float = 12.0,
    run_out: float = 0.0,
) -> Recording:
    """Random torsion with a mode at 28 Hz; derivative, delay and torque are exact in the frequency domain."""
    random = np.random.default_rng(seed)
    n = 2 * round(duration / DT)  # twice as long as what is recorded, so that nothing is periodic in it
    f = np.fft.rfftfreq(n, DT)
    w = 2.0 * np.pi * f
    shape = 1.0 / np.sqrt((1.0 - (f / 28.0) ** 2) ** 2 + (0.3 * f / 28.0) ** 2) / (1.0 + f / 10.0)
    spectrum = shape * ((f > 0.5) & (f < 200.0)) * (random.standard_normal((2, f.size)).T @ [1.0, 1j])
    spectrum *= 0.01 / np.fft.irfft(spectrum, n).std()
    middle = slice(n // 4, n // 4 + n // 2)
    rate = np.fft.irfft(1j * w * spectrum, n)[middle]
    law = (STIFFNESS + 1j * w * damping - inertia * w**2) * np.exp(-1j * w * DELAY)
    torque = np.fft.irfft(law * spectrum, n)[middle]
    time = np.arange(rate.size) * DT
    noise = random.standard_normal((3, rate.size))
    return Recording(
        time,
        {
            "speed_motor": 200.0 + 0.3 * rate + speed_noise * noise[0],
            "speed_load": 200.0 - 0.7 * rate + run_out * np.sin(200.0 * time) + speed_noise * noise[1],
            "torque_shaft": 10.0 + torque + torque_noise * noise[2],
        },
    )


def inside(found: ShaftStiffness, name: str, truth: float) -> bool:
    low, high = found.intervals[name]
    return low <= truth <= high


@pytest.mark.parametrize(("speed_noise", "torque_noise"), [(0.05, 0.02), (0.5, 0.0), (0.01, 0.3)])
def test_truth_lies_in_the_intervals_under_noise(speed_noise: float, torque_noise: float) -> None:
    found = [shaft_stiffness(shaft(s, speed_noise=speed_noise, torque_noise=torque_noise)) for s in range(20)]
    for name, truth in (("stiffness", STIFFNESS), ("torque_delay", DELAY), ("inertia_between", 0.0)):
        assert sum(inside(f, name, truth) for f in found) >= 17, name
    # An interval that always holds the truth could also be one that says nothing.
    widths = [f.intervals["stiffness"][1] - f.intervals["stiffness"][0] for f in found]
    assert np.median(widths) < 0.2 * STIFFNESS


def test_clean_signals_give_stiffness_and_delay_without_half_a_sample() -> None:
    found = shaft_stiffness(shaft(1, speed_noise=0.0, torque_noise=0.0))
    assert found.values["stiffness"] == pytest.approx(STIFFNESS, rel=1e-3)
    # A running sum would be off by DT/2 = 0.5 ms, an uncorrected trapezoid by about 1 % at 60 Hz.
    assert found.values["torque_delay"] == pytest.approx(DELAY, abs=2e-6)
    assert found.values["inertia_between"] == pytest.approx(0.0, abs=1e-6)
    assert found.problems == ()
    assert found.sources["stiffness"] == "identified"
    assert not found.torque_reverses


def test_what_swings_between_the_sensors_does_not_bias_the_stiffness() -> None:
    found = shaft_stiffness(shaft(2, inertia=1e-4))
    assert inside(found, "stiffness", STIFFNESS)
    assert found.values["inertia_between"] == pytest.approx(1e-4, rel=0.15)


def test_damping_needs_the_true_delay() -> None:
    recording = shaft(3, damping=0.02)
    apparent = shaft_stiffness(recording)
    assert apparent.values["damping"] is None
    assert inside(apparent, "torque_delay", DELAY - 0.02 / STIFFNESS)
    known = shaft_stiffness(recording, torque_delay=DELAY)
    assert known.values["torque_delay"] == DELAY and known.sources["torque_delay"] == "nameplate"
    assert inside(known, "damping", 0.02)
    assert known.intervals["damping"][0] > 0.0
    np.testing.assert_allclose(known.fitted(known.frequency), apparent.fitted(apparent.frequency), rtol=1e-12)


def test_run_out_at_the_turning_frequency_is_left_out() -> None:
    recording = shaft(4, run_out=2.0)
    found = shaft_stiffness(recording)
    assert not found.used[np.argmin(np.abs(found.frequency - 200.0 / (2.0 * np.pi)))]
    assert inside(found, "stiffness", STIFFNESS)
    assert found.values["stiffness"] == pytest.approx(STIFFNESS, rel=5e-3)


def test_arrays_for_plots_show_the_fit() -> None:
    found = shaft_stiffness(shaft(5))
    assert found.frequency.shape == found.response.shape == found.coherence.shape == found.used.shape
    assert found.frequency[0] >= 3.0
    assert found.frequency[-1] <= 60.0
    error = np.abs(found.response - found.fitted(found.frequency))[found.used]
    assert np.median(error) < 0.02 * STIFFNESS


def test_wrong_sign_is_a_problem_and_no_negative_stiffness() -> None:
    recording = shaft(6)
    turned = recording.with_signals("measured", torque_shaft=-recording["torque_shaft"])
    found, right = shaft_stiffness(turned), shaft_stiffness(recording)
    assert found.values["stiffness"] == pytest.approx(right.values["stiffness"], rel=1e-12)
    assert [p.got for p in found.problems] == ["torque and twist of opposite sign"]


def test_a_wholly_negative_inertia_is_no_value() -> None:
    """A torque whose filter leads: the stiffness seems to rise with frequency."""
    found = shaft_stiffness(shaft(6, inertia=-1e-3))
    assert found.values["inertia_between"] is None and "inertia_between" not in found.intervals
    assert [p.got.split(",")[0] for p in found.problems] == ["a stiffness that rises with frequency"]
    assert found.values["stiffness"] is not None


def test_unrelated_torque_gives_no_number() -> None:
    recording = shaft(7)
    noise = 10.0 + 0.1 * np.random.default_rng(7).standard_normal(len(recording))
    found = shaft_stiffness(recording.with_signals("measured", torque_shaft=noise))
    assert found.values["stiffness"] is None
    assert found.intervals == {}
    assert found.sources["stiffness"] == "not excited"
    assert len(found.problems) == 1
    with pytest.raises(InvalidInput, match="fitted"):
        found.fitted(found.frequency)


def test_short_recording_gives_no_number() -> None:
    found = shaft_stiffness(shaft(8, duration=2.0), torque_delay=DELAY)
    assert found.values["stiffness"] is None
    assert found.values["damping"] is None
    assert "3 segments" in found.problems[0].got


def test_a_number_that_hangs_on_one_event_is_not_given() -> None:
    recording = shaft(10, speed_noise=0.0, torque_noise=0.0)
    # One large kick, of another stiffness than the faint rest, in the middle of one segment: coherent, alone.
    kick = np.exp(-0.5 * ((recording.time - 6.0) / 0.003) ** 2)
    found = shaft_stiffness(
        recording.with_signals(
            "measured",
            speed_motor=0.02 * recording["speed_motor"] + np.gradient(kick, DT),
            speed_load=0.02 * recording["speed_load"],
            torque_shaft=0.02 * recording["torque_shaft"] + 10.0 * kick,
        )
    )
    assert np.count_nonzero(found.used) > 20
    assert found.values["stiffness"] is None
    assert found.intervals == {}
    assert "95 % interval" in found.problems[-1].got


def test_reversing_torque_is_named_as_a_risk() -> None:
    recording = shaft(9)
    found = shaft_stiffness(recording.with_signals("measured", torque_shaft=recording["torque_shaft"] - 10.0))
    assert found.torque_reverses
    assert "reverses" in found.problems[0].got


@pytest.mark.parametrize("band", [(0.0, 60.0), (60.0, 3.0), (3.0, 600.0)])
def test_impossible_band_is_refused(band: tuple[float, float]) -> None:
    with pytest.raises(InvalidInput, match="band"):
        shaft_stiffness(shaft(1, duration=2.0), band=band)


@pytest.mark.parametrize("name", ["step_sensor.csv", "sin_sensor.csv"])
def test_measured_rig(name: str) -> None:
    found = shaft_stiffness(measured(name))
    assert found.values["stiffness"] is not None
    assert 0.98 * 109.0 <= found.values["stiffness"] <= 1.02 * 113.0
    assert found.values["torque_delay"] is not None
    assert 0.33e-3 <= found.values["torque_delay"] <= 0.40e-3
    # Towards low frequency, where nothing swings between the sensors, the modulus itself reads 112 Nm/rad.
    assert inside(found, "stiffness", 112.5)
    assert found.values["damping"] is None
    assert not found.torque_reverses
    assert found.problems == ()


def test_measured_recordings_agree_with_each_other() -> None:
    step, sine = (shaft_stiffness(measured(n)) for n in ("step_sensor.csv", "sin_sensor.csv"))
    for name in ("stiffness", "torque_delay", "inertia_between"):
        assert inside(step, name, sine.values[name])
        assert inside(sine, name, step.values[name])
