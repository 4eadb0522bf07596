"""Which candidate is clearly better, and which are alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter, Run
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.likelihood_ratio import (
    CHANCE_RIGID,
    LEAST_RISE,
    alike,
    clearly_better,
    simplest,
)
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX
from lostmotion.identification.prediction_error.contact_switching.sensor.rounding import cost_as_gaussian


def at(flt: ContactFilter, values: dict[str, float], **changes: float) -> Candidate:
    theta = flt.theta(values | changes)
    return Candidate("here", theta, flt.run(theta).cost, flt, [INDEX["stiffness"]])


def test_rows_add_up_to_the_cost(flt: ContactFilter, values: dict[str, float]):
    run = flt.run(flt.theta(values))
    mean = float(np.mean(run.rows))
    cost = cost_as_gaussian(mean) if flt.rounded else mean
    assert run.cost == pytest.approx(cost, abs=1e-12)


def test_the_truth_is_clearly_better_than_another_stiffness(flt: ContactFilter, values: dict[str, float]):
    truth, other = at(flt, values), at(flt, values, stiffness=1.3 * values["stiffness"])
    assert clearly_better(truth, other) and not clearly_better(other, truth)
    assert not clearly_better(truth, truth) and alike(truth, truth)


def test_parts_that_hardly_raise_the_likelihood_are_superfluous(flt: ContactFilter, values: dict[str, float]):
    """A third inertia that is not there predicts a little better, and leaves all others more room."""
    two = at(flt, values)
    three = replace(two, free=[*two.free, INDEX["share"]])
    rise = LEAST_RISE / flt.counting.size
    best, lower = (replace(three, cost=two.cost - part * rise) for part in (0.9, 0.8))
    assert simplest([best, two, lower]) is two
    assert simplest([best, replace(two, cost=two.cost + 0.2 * rise), lower]) is best


def of_rows(flt: ContactFilter, rows: np.ndarray, monkeypatch: pytest.MonkeyPatch) -> Candidate:
    """A candidate whose rows cost so much, whatever its parameters."""
    known = replace(flt)
    cost = float(np.mean(rows))
    run = Run(rows, cost, cost, np.empty((0, rows.size)), rows, np.ones(rows.size), rows.size)
    monkeypatch.setitem(vars(known), "run", lambda theta, free=(): run)
    return Candidate("here", np.zeros(1), run.cost, known, [])


def test_a_single_event_decides_nothing(flt: ContactFilter, monkeypatch: pytest.MonkeyPatch):
    """A rise of the likelihood that all comes from one moment may be an accident; the same over all rows is none."""
    rng = np.random.default_rng(1)
    base = 0.1 + 0.01 * rng.standard_normal(20_000)
    moment = base.copy()
    moment[5000:5100] += 20.0
    even = base + np.mean(moment - base)
    best = of_rows(flt, base, monkeypatch)
    assert clearly_better(best, of_rows(flt, even, monkeypatch))
    assert not clearly_better(best, of_rows(flt, moment, monkeypatch))


@pytest.mark.parametrize(
    ("usual", "moments"),
    [(0.03, {2: 1.3, 9: 0.9, 16: 1.0, 0: -0.14}), (-0.01, {0: 0.7, 1: 0.8, 12: 0.9, 13: 3.0, 14: 1.0, 15: 0.06})],
    ids=["most blocks rise", "the rest falls a little"],
)  # fmt: skip
def test_a_rigid_drive_is_excluded_by_few_moments_that_agree(
    flt: ContactFilter, monkeypatch: pytest.MonkeyPatch, usual: float, moments: dict[int, float]
):
    """By Student's test it "predicted as well" on two drives: the large rises made the deviation."""
    rises = np.full(20, usual)
    rises[list(moments)] = list(moments.values())
    base = np.full(20_000, 0.1)
    best, rigid = (of_rows(flt, rows, monkeypatch) for rows in (base, base + np.repeat(rises, 1000)))
    assert clearly_better(best, rigid, CHANCE_RIGID) and not clearly_better(rigid, best, CHANCE_RIGID)


def test_what_is_infinitely_unlikely_is_worse(flt: ContactFilter, values: dict[str, float]):
    truth = at(flt, values)
    lost = replace(truth, cost=float("inf"))
    assert clearly_better(truth, lost) and not clearly_better(lost, truth) and not alike(lost, truth)


def test_where_nothing_explains_the_recording_little_decides_nothing(
    flt: ContactFilter, values: dict[str, float]
):
    """Of 1.0 that is unexplained, a third less makes no candidate better."""
    truth = at(flt, values)
    assert alike(replace(truth, cost=1.3), replace(truth, cost=1.0))
    assert not alike(replace(truth, cost=1.4), replace(truth, cost=1.0))
    assert not alike(replace(truth, cost=0.11), replace(truth, cost=0.01))
