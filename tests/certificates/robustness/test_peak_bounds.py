"""Bounds of all motions: loops whose peaks are known, simulations that stay within, and how far above them they are."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER, TABLE_I

import lostmotion as lm
from lostmotion.certificates import (
    PeakBounds,
    continuous_observer_feedback,
    continuous_pi,
    peak_bounds,
    worst_reference,
)
from lostmotion.certificates.continuous.continuous_law import ContinuousLaw
from lostmotion.certificates.robustness import level_set_search
from lostmotion.certificates.robustness.peak_outputs import sampled_peak_loop
from lostmotion.errors import InvalidInput

SAMPLED = lm.controllers.pi(dt=1e-4)
SIGNALS = ("twist", "speed_motor", "speed_load", "torque_motor")
RIGID = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=4.0, viscous=0.0175
)


def ratios(bounds: PeakBounds, simulated: dict[str, float]) -> np.ndarray:
    return np.array([getattr(bounds, name) / simulated[name] for name in SIGNALS])


def test_a_linear_loop_stays_below_the_bound_and_near_it() -> None:
    """Without gap and friction the worst set-point is known: at its limit, with the sign of the impulse response."""
    bounds = peak_bounds(RIGID, continuous_pi(), 1.0)
    step = lm.simulate(RIGID, law=SAMPLED, dt=1e-4, speed_reference=np.r_[np.zeros(5), np.ones(4000)])
    response = np.diff(step["speed_motor"])
    peak = np.abs(response).sum()
    assert peak < bounds.speed_motor < 1.4 * peak
    assert np.isclose(
        peak_bounds(RIGID, continuous_pi(), 2.0).speed_motor, 2.0 * bounds.speed_motor, rtol=1e-3
    )


@pytest.mark.parametrize(("reference", "law", "acts"), [(0.5, SAMPLED, False), (5.0, continuous_pi(), None)])
def test_no_simulation_exceeds_the_bounds_and_they_are_not_far_off(
    reference: float, law: lm.DiscreteSystem | ContinuousLaw, acts: bool | None
) -> None:
    """The torque limit of 73.5 Nm cannot act at 0.5 rad/s, and may at 5 rad/s."""
    bounds = peak_bounds(PAPER.with_parameters(torque_limit=73.5), law, reference)
    worst = {
        name: worst_reference(PAPER, SAMPLED, reference, name, starts=1, duration=0.1).peak
        for name in SIGNALS
    }
    ratio = ratios(bounds, worst)
    assert np.all(ratio >= 1.0) and np.all(ratio <= 2.5), ratio
    assert bounds.limit_acts is acts


def test_how_far_it_may_hunt_at_standstill() -> None:
    """Every motion ends in the gap, or in contact with at most the Coulomb torque: 6.32 mrad."""
    bounds = peak_bounds(PAPER, continuous_pi())
    run = lm.simulate(
        PAPER,
        law=SAMPLED,
        dt=1e-4,
        speed_reference=np.zeros(5000),
        state=(0.02, 3.0, -1.0),
    )
    settled = {name: float(np.max(np.abs(run[name][-2000:]))) for name in SIGNALS}
    assert all(getattr(bounds, name) >= settled[name] for name in SIGNALS)
    assert 6.31e-3 < bounds.twist < 7.0e-3 and bounds.speed_motor < 0.5 and bounds.torque_motor < 5.0


@pytest.mark.parametrize("delay", [0, 2])
def test_the_torque_limit_is_left_out_of_the_loop(delay: int) -> None:
    """The drivetrain's and the law's own, with its anti-windup: what is left is the loop without a limit."""
    plain = sampled_peak_loop(PAPER, SAMPLED, delay)
    for plant, law in (
        (PAPER.with_parameters(torque_limit=73.5), SAMPLED),
        (PAPER, lm.controllers.pi(dt=1e-4, torque_limit=73.5)),
    ):
        found = sampled_peak_loop(plant, law, delay)
        assert found.limit == 73.5 and plain.limit == np.inf
        for name in ("A", "E", "Z", "S", "S_w", "S_v", "R"):
            difference = getattr(found.loop, name) - getattr(plain.loop, name)
            assert np.max(np.abs(difference.astype(float)), initial=0.0) < 1e-12, name


def test_what_is_not_bounded_is_refused() -> None:
    with pytest.raises(InvalidInput, match="stable"):
        peak_bounds(PAPER, continuous_pi(kp=-10.0))
    with pytest.raises(InvalidInput, match="lag"):
        peak_bounds(PAPER.with_parameters(lag=1e-3), continuous_pi())
    with pytest.raises(InvalidInput, match="substeps"):
        peak_bounds(PAPER, lm.controllers.pi(dt=1e-4), substeps=0)


def test_a_linear_loop_with_an_observer_is_bounded_near_its_peak() -> None:
    """No set-point moves the observer's errors: the level sets are flat. The worst set-point is known, as above."""
    plant = lm.Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.0, "coulomb": 0.0})
    bounds = peak_bounds(plant, continuous_observer_feedback(plant), 0.5)
    parts = [lm.observers.kalman(plant, dt=1e-4), lm.controllers.pole_placement(plant, dt=1e-4)]
    law = lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))
    step = lm.simulate(plant, law=law, dt=1e-4, speed_reference=np.r_[np.zeros(5), np.full(4000, 0.5)])
    peak = np.abs(np.diff(step["speed_motor"])).sum()
    assert peak < bounds.speed_motor < 1.5 * peak


def test_a_loop_with_an_observer_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """After one round, with one decay: the gain over the level is far from 1, and the solver must scale it."""
    monkeypatch.setattr(level_set_search, "ROUNDS", 1)
    monkeypatch.setattr(level_set_search, "DECAYS", (0.75,))
    bounds = peak_bounds(PAPER, continuous_observer_feedback(PAPER), 0.5)
    assert 0.5 < bounds.speed_motor < 20.0 and bounds.twist < 0.1 and bounds.torque_motor < 400.0
