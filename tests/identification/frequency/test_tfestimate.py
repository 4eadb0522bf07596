"""tfestimate and mscohere: Octave's numbers with explicit arguments, MATLAB's documented defaults without."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InvalidInput
from lostmotion.identification.frequency.tfestimate import mscohere, tfestimate

FIXTURE = Path(__file__).parents[2] / "fixtures" / "octave_spectra.csv"


@pytest.fixture(scope="module")
def octave():
    lines = FIXTURE.read_text().splitlines()
    return {name: np.array([float(v) for v in rest]) for name, *rest in (line.split(",") for line in lines)}


@pytest.mark.parametrize("case", [1, 2])
def test_equals_octave(octave, case):
    window = octave["window"] if case == 1 else octave["window"][:101]
    arguments = (window, 96, 256, 1000.0) if case == 1 else (window, 0, 101, 2.0)
    response, frequency = tfestimate(octave["x"], octave["y"], *arguments)
    coherence, same = mscohere(octave["x"], octave["y"], *arguments)
    expected = octave[f"real{case}"] + 1j * octave[f"imag{case}"]
    np.testing.assert_allclose(response, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(coherence, octave[f"coherence{case}"], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(frequency, octave[f"f{case}"], rtol=1e-12)
    np.testing.assert_array_equal(frequency, same)


def test_matlab_defaults(octave):
    """Hamming window, eight half-overlapping segments, nfft = max(256, 2^p), frequencies in rad/sample."""
    x, y = octave["x"], octave["y"]
    found, frequency = tfestimate(x, y)
    length = int(600 / 4.5)
    explicit, _ = tfestimate(x, y, np.hamming(length), length // 2, 256, 2.0 * np.pi)
    np.testing.assert_array_equal(found, explicit)
    assert frequency[-1] == pytest.approx(np.pi)
    assert frequency.size == 129
    long = np.resize(x, 4000)
    assert mscohere(long, np.resize(y, 4000))[1].size == 1024 // 2 + 1
    by_length, _ = tfestimate(x, y, 100, None, None, 50.0)
    np.testing.assert_array_equal(by_length, tfestimate(x, y, np.hamming(100), 50, 256, 50.0)[0])


def test_overlap_alone_sets_the_length_for_eight_segments(octave):
    found, _ = tfestimate(octave["x"], octave["y"], None, 10)
    np.testing.assert_array_equal(found, tfestimate(octave["x"], octave["y"], (600 + 70) // 8, 10)[0])


def test_short_fft_wraps_the_segment(octave):
    """Every second line of a long FFT: wrapping is what sampling the spectrum more coarsely means."""
    x, y = octave["x"], octave["y"]
    full, _ = tfestimate(x, y, 128, 64, 128)
    half, _ = tfestimate(x, y, 128, 64, 64)
    np.testing.assert_allclose(half, full[::2], rtol=1e-9)


def test_h2_over_h1_is_the_inverse_coherence(octave):
    x, y = octave["x"], octave["y"]
    ratio = tfestimate(x, y, estimator="H2")[0] / tfestimate(x, y)[0]
    np.testing.assert_allclose(ratio, 1.0 / mscohere(x, y)[0], rtol=1e-9)


@pytest.mark.parametrize(
    "arguments",
    [
        (np.zeros(5), np.zeros(6)),
        (np.ones(50) * 1j, np.ones(50)),
        (np.full(50, np.nan), np.ones(50)),
        (np.ones(50), np.ones(50), 60),
        (np.ones(50), np.ones(50), 20, 20),
    ],
)
def test_misuse_is_refused(arguments):
    with pytest.raises(InvalidInput):
        tfestimate(*arguments)


def test_default_lengths_are_those_of_matlab():
    """MATLAB Central answer 58211: 8064 samples give 8 half-overlapping segments of 1792, nfft 2048, 1025 lines."""
    x, y = np.random.default_rng(0).standard_normal((2, 8064))
    found, _ = mscohere(x, y)
    assert found.shape == (1025,)
    np.testing.assert_array_equal(found, mscohere(x, y, 1792, 896, 2048)[0])
