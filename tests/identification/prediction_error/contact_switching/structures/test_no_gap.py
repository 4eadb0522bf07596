"""A drive without a gap: up to which size the recording would not show one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.estimate import told
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Box, Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX, NAMES
from lostmotion.identification.prediction_error.contact_switching.structures.no_gap import (
    bare,
    gap_bound,
    without_gap,
)
from lostmotion.identification.prediction_error.innovations import Predictor

DT = 2e-4
FREE = [INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness", "damping", "coulomb", "lag")]


def candidate(plant: lm.Drivetrain, gap: float, seed: int = 1) -> tuple[Candidate, Box]:
    """The true values of a drive with this gap (rad), which has a small one in the model, too."""
    drive = plant.with_parameters(backlash=gap)
    torque = lm.signals.excitation(1.0, DT, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(drive, torque_motor=torque, dt=DT)
    speed = run["speed_motor"] + 0.01 * np.random.default_rng(seed).standard_normal(torque.size)
    flt = ContactFilter.of(Predictor(torque, speed, DT, False, drive, skip=0), 100.0)
    true = {name: value for name, value in drive.parameters().items() if name in NAMES}
    theta = flt.theta(true | {"backlash": max(gap, 1e-6), "motor_rate": 3.0, "load_rate": 1.0})
    free = sorted([*FREE, INDEX["backlash"]])
    return Candidate("truth", theta, flt.run(theta).cost, flt, free), Box.around(flt, theta, 100.0)


def test_without_a_gap_the_bound_is_small(plant: lm.Drivetrain):
    best, box = candidate(plant, 0.0)
    gapless = without_gap(best, box)
    assert gapless is not None and np.isinf(gapless.theta[INDEX["backlash"]])
    bound = gap_bound(gapless, 1.0, box)
    assert bound is not None and 0.0 < bound < 0.02 * 0.012
    # Intervals that are twice as wide make it larger.
    wider = gap_bound(gapless, 2.0, box)
    assert wider is not None and bound < wider < 3.0 * bound


def test_the_bound_holds_for_gaps_about_as_large(plant: lm.Drivetrain):
    """Once and three times what would not show: the bound is above them, or the gap is seen. One in six may miss."""
    holds = []
    for seed in (1, 2, 3):
        none, box = candidate(plant, 0.0, seed)
        without = gap_bound(bare(none), 1.0, box)
        assert without is not None
        for gap in (without, 3.0 * without):
            small, box = candidate(plant, gap, seed)
            gapless = without_gap(small, box)
            above = gap_bound(gapless, 1.0, box) if gapless else None
            holds.append(above is None or above > gap)
    assert sum(holds) >= len(holds) - 1


def test_a_gap_that_shows_is_not_left_out(plant: lm.Drivetrain):
    best, box = candidate(plant, 0.012)
    assert without_gap(best, box) is None


def test_no_bound_where_the_filter_diverges_with_a_gap(plant: lm.Drivetrain, monkeypatch: pytest.MonkeyPatch):
    gapless, run = bare(candidate(plant, 0.0)[0]), ContactFilter.run

    def diverging(flt: ContactFilter, theta: np.ndarray, *rest: object) -> object:
        done = run(flt, theta, *rest)
        if np.isfinite(theta[INDEX["backlash"]]):
            done = replace(done, weighted=np.full_like(done.weighted, np.nan))
        return done

    box = Box.around(gapless.flt, gapless.theta, 100.0)
    monkeypatch.setattr(ContactFilter, "run", diverging)
    assert gap_bound(gapless, 1.0, box) is None


def test_a_constant_torque_that_held_the_gap_on_one_side_goes_with_it(plant: lm.Drivetrain):
    best, box = candidate(plant, 0.0)
    theta = best.flt.changed(best.theta, torque_offset=3.0, torque_rate=1e-3, backlash=1e-9)
    held = replace(
        best, theta=theta, cost=best.flt.run(best.theta).cost, free=[*best.free, INDEX["torque_offset"]]
    )
    gapless = without_gap(held, box)
    assert gapless is not None and gapless.values["torque_offset"] == 0.0


def test_the_bound_is_above_the_gaps_of_what_predicts_as_well(plant: lm.Drivetrain):
    best, box = candidate(plant, 0.0)
    gapless = without_gap(best, box)
    assert gapless is not None
    wide = replace(best, theta=best.flt.changed(best.theta, backlash=0.005), cost=gapless.cost)
    # A likelihood e^20 times lower is outside of any interval.
    worse = replace(wide, cost=gapless.cost + 20.0 / best.flt.rows)
    alone, beside, apart = (
        told(best, others, np.zeros(8), np.zeros(8), box, ())
        for others in ([best], [best, wide], [best, worse])
    )
    assert alone.gap_bound is not None and alone.gap_bound < 0.001
    assert beside.gap_bound == pytest.approx(0.005)
    assert apart.gap_bound == alone.gap_bound
