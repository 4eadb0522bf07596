"""Innovations of the contact-switching filter, and the likelihood that they stand for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import (
    PARAMETERS,
    ContactFilter,
    white_noise,
)


def test_the_true_parameters_leave_the_sensors_noise(flt: ContactFilter, values: dict[str, float]):
    run = flt.run(flt.theta(values))
    assert run.cost == pytest.approx(0.0, abs=0.06)
    # White: neighbours are not correlated.
    w = run.weighted[200:]
    assert abs(np.mean(w[1:] * w[:-1]) / np.mean(w**2)) < 0.1


@pytest.mark.parametrize("name", ["inertia_motor", "stiffness", "backlash", "coulomb"])
def test_wrong_parameters_cost_more(flt: ContactFilter, values: dict[str, float], name: str):
    own = flt.run(flt.theta(values)).cost
    for factor in (0.8, 1.25):
        assert flt.run(flt.theta(values | {name: factor * values[name]})).cost > own + 1e-3


def test_costs_under_different_noise_levels_compare(flt: ContactFilter, values: dict[str, float]):
    """A filter that counts on ten times the noise predicts no better: its cost says so, by a likelihood."""
    theta = flt.theta(values)
    assert flt.run(theta).cost < replace(flt, level=10.0 * flt.floor).run(theta).cost


def test_the_filter_starts_anew_with_each_piece(flt: ContactFilter, values: dict[str, float]):
    """The same recording twice: the second half's innovations are those of the first, but for the angle's rounding."""
    theta, n = flt.theta(values), flt.rows
    offset = flt.measured[-1] if flt.counted else 0.0
    twice = replace(
        flt, torque=np.tile(flt.torque, 2), measured=np.r_[flt.measured, flt.measured + offset], bounds=(0, n, 2 * n)
    )  # fmt: skip
    weighted = twice.run(theta).weighted
    assert weighted[n : n + 500] == pytest.approx(weighted[:500], abs=1e-4)
    through = replace(twice, bounds=(0, 2 * n)).run(theta).weighted
    assert through[n] != pytest.approx(weighted[n], abs=1e-2)


def test_values_survive_the_parameter_vector(flt: ContactFilter):
    some = {name: 0.1 * (i + 1.0) for i, name in enumerate(PARAMETERS)}
    assert flt.values(flt.theta(some)) == pytest.approx(list(some.values()))


def test_noise_of_a_smooth_signal_is_seen():
    time = np.arange(20_000) * 1e-4
    noise = 1e-3 * np.random.default_rng(3).standard_normal(time.size)
    assert white_noise(10.0 * np.sin(30.0 * time) + noise) == pytest.approx(1e-3, rel=0.05)
