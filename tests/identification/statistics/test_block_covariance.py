"""Covariances from blocks of a recording."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.identification.statistics.block_covariance import (
    BLOCKS,
    Blocks,
    excess,
    growth,
    sandwich,
    shift,
)


def test_sandwich_is_the_usual_covariance_for_white_noise():
    rng = np.random.default_rng(1)
    jacobian = rng.standard_normal((2, 40000)) * np.array([[1.0], [50.0]])
    estimates = np.array([np.diag(sandwich(jacobian, 0.3 * rng.standard_normal(40000))) for _ in range(40)])
    usual = 0.09 * np.diag(np.linalg.inv(jacobian @ jacobian.T))
    assert np.mean(estimates, axis=0) == pytest.approx(usual, rel=0.2)


def test_sandwich_sees_the_colour_of_the_noise():
    """Blue noise averages out of a slow regressor; a white-noise covariance would be far too wide."""
    rng = np.random.default_rng(2)
    n = 40000
    jacobian = np.sin(np.arange(n) / 500.0)[None]
    blue = np.diff(rng.standard_normal(n + 1))
    white_formula = np.var(blue) / np.sum(jacobian**2)
    assert sandwich(jacobian, blue)[0, 0] < 0.01 * white_formula


def test_pulls_are_those_of_a_jackknife():
    """What a block pulls is what the estimate loses without it, however much of a parameter that block tells."""
    rng = np.random.default_rng(7)
    n = 20 * BLOCKS
    columns = rng.standard_normal((2, n)) * np.array([[1.0], [30.0]])
    columns[0, 60:] *= 0.05
    y = columns.T @ np.array([0.3, 0.01]) + 0.1 * rng.standard_normal(n)
    found = np.linalg.lstsq(columns.T, y, rcond=None)[0]
    blocks = Blocks.of(-columns, y - columns.T @ found)
    assert blocks.step == pytest.approx([0.0, 0.0], abs=1e-12)
    for block in (0, 1, 7):
        rest = np.r_[0 : 20 * block, 20 * (block + 1) : n]
        without = np.linalg.lstsq(columns[:, rest].T, y[rest], rcond=None)[0]
        assert blocks.influences[:, block] == pytest.approx(found - without, rel=1e-6)


def test_only_what_is_more_than_chance_counts():
    spread = np.tile([0.1, -0.1], BLOCKS // 2)
    spread = np.array([spread, spread])
    chance = 2.0 * 0.1 * BLOCKS / np.sqrt(BLOCKS - 1)
    assert excess(np.array([0.9 * chance, -1.25 * chance]), spread, 2.0) == pytest.approx(
        [0.0, 0.75 * chance]
    )


def test_growth_tells_one_block_from_all():
    noise = np.random.default_rng(4).standard_normal(20000)
    everywhere, once = 1.1 * noise, noise.copy()
    once[: noise.size // BLOCKS] *= 3.0
    blocks, sure = growth(everywhere, noise)
    assert blocks == pytest.approx(0.21 * BLOCKS, rel=1e-6) and sure > 50.0
    blocks, sure = growth(once, noise)
    assert blocks == pytest.approx(8.0, rel=0.1) and sure == pytest.approx(1.0, rel=1e-6)
    assert growth(noise, noise) == (0.0, 0.0)


def test_shift_is_the_least_squares_step():
    rng = np.random.default_rng(3)
    jacobian = rng.standard_normal((3, 500)) * np.array([[1.0], [1e-3], [40.0]])
    residual = -jacobian.T @ np.array([0.1, -20.0, 0.003])
    assert shift(jacobian, residual) == pytest.approx([0.1, -20.0, 0.003])
