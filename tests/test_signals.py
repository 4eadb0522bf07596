"""Test signals: values, spectra, seeds."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import signals

DT = 1e-3


def spectrum(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.fft.rfftfreq(x.size, DT), np.abs(np.fft.rfft(x)) / x.size


def test_steps_begin_at_their_sample():
    made = signals.steps((0.003, 0.007), (0.0, 2.0, -1.0), 0.01, DT)
    np.testing.assert_array_equal(made, [0, 0, 0, 2, 2, 2, 2, -1, -1, -1])


def test_noise_and_multisine_stay_in_their_band():
    for made in (
        signals.noise(20, 80, 3.0, 4.0, DT, seed=1),
        signals.multisine(20, 80, 3.0, 4.0, DT, seed=1),
    ):
        frequency, size = spectrum(made)
        outside = (frequency < 20) | (frequency > 80)
        assert np.sqrt(np.mean(made**2)) == pytest.approx(3.0, rel=1e-12)
        assert size[outside].max() < 1e-12
        assert size[~outside].max() > 0.1


def test_multisine_is_flat():
    frequency, size = spectrum(signals.multisine(20, 80, 1.0, 4.0, DT, seed=2))
    inside = size[(frequency >= 20) & (frequency <= 80)]
    np.testing.assert_allclose(inside, inside[0], rtol=1e-9)


def test_chirp_sweeps():
    made = signals.chirp(5.0, 50.0, 2.0, 4.0, DT)
    crossings = np.flatnonzero(np.diff(np.sign(made)))
    assert np.max(np.abs(made)) == pytest.approx(2.0, rel=1e-2)
    # Two crossings in each cycle; cycles in [0, t]: 5 t + 45 t²/8.
    assert np.sum(crossings < 500) == pytest.approx(2 * (2.5 + 45 / 32), abs=1)
    assert crossings.size == pytest.approx(2 * (5 * 4 + 45 * 2), abs=1)


def test_prbs_has_two_values_and_holds_them():
    made = signals.prbs(1.5, 0.01, 2.0, DT, seed=0)
    assert set(np.unique(made)) == {-1.5, 1.5}
    assert np.all(np.flatnonzero(np.diff(made)) % 10 == 9)


def test_excitation_drives_the_levels_and_keeps_the_limit():
    plant = lm.Drivetrain((0.1292,), frictions=(lm.Friction(2.0, 0.0175),))
    made = signals.excitation(seed=1, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    assert np.max(np.abs(made)) <= 40.0
    speed = lm.simulate(plant, torque_motor=made, dt=1e-4)["speed_motor"]
    assert speed.max() > 20.0 and speed.min() < -20.0


def test_same_seed_same_bytes():
    for make in (
        lambda seed: signals.noise(1, 100, 1.0, 1.0, DT, seed=seed),
        lambda seed: signals.multisine(1, 100, 1.0, 1.0, DT, seed=seed),
        lambda seed: signals.prbs(1.0, 0.01, 1.0, DT, seed=seed),
        lambda seed: signals.excitation(1.0, DT, seed=seed, inertia=0.1, coulomb=1.0, viscous=0.0),
    ):
        assert make(4).tobytes() == make(4).tobytes()
        assert make(4).tobytes() != make(5).tobytes()


@pytest.mark.parametrize(
    "make",
    [
        lambda: signals.steps((0.2, 0.1), (0, 1, 2), 1.0, DT),
        lambda: signals.steps((0.1,), (0, 1, 2), 1.0, DT),
        lambda: signals.chirp(1, 2, 1.0, 0.0, DT),
        lambda: signals.chirp(1, 2, 1.0, 1.0, 0.0),
        lambda: signals.chirp(1, 2, 1.0, 1.0, np.nan),
        lambda: signals.chirp(1, 2, 1.0, np.inf, DT),
        lambda: signals.chirp(1, 2, 1.0, 1.0, -DT),
        lambda: signals.multisine(0.1, 0.2, 1.0, 1.0, DT, seed=0),
        lambda: signals.noise(0.1, 0.2, 1.0, 1.0, DT, seed=0),
        lambda: signals.excitation(1.0, 0.1, seed=0, inertia=1.0, coulomb=0.0, viscous=0.0, band=(6.0, 9.0)),
    ],
)
def test_misuse_is_refused(make):
    with pytest.raises(lm.InvalidInput):
        make()
