"""What becomes of a fit beside candidates that predict better."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.identification.prediction_error.contact_switching.estimate import Estimate
from lostmotion.identification.prediction_error.contact_switching.filter import ContactFilter
from lostmotion.identification.prediction_error.contact_switching.likelihood import Candidate
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import NAMES
from lostmotion.identification.prediction_error.contact_switching.told import told_vector
from lostmotion.identification.prediction_error.contact_switching.verdict import APART, Fit
from lostmotion.identification.prediction_error.gain_schedule import LADDER, Stage, bandwidth_for
from lostmotion.identification.prediction_error.identifiability import Told
from lostmotion.identification.prediction_error.innovations import NAMES as TOLD
from lostmotion.identification.prediction_error.innovations import Predictor, to_theta
from lostmotion.identification.statistics.levenberg_marquardt import Fit as Minimum

DT = 1e-4
PLANT = PAPER.with_parameters(lag=3e-4)
THETA = to_theta([getattr(PLANT, name) for name in TOLD], DT)
HALF = 0.02
CORE = ["inertia_motor", "inertia_load", "stiffness", "backlash"]


@pytest.fixture(scope="module")
def fit() -> Fit:
    """A fit at the truth of a recording of noise, every value known to 2 %."""
    torque, speed = np.random.default_rng(1).standard_normal((2, 500))
    predictor = Predictor(torque, speed, DT, False, PLANT, skip=0)
    bandwidth = bandwidth_for(PLANT, LADDER[-1])
    residual = predictor.residual(THETA, bandwidth)
    stage = Stage(Minimum(THETA, residual, float(residual @ residual), 1, True), bandwidth, list(range(8)), 1)
    told = Told(THETA.copy(), 1e-4 * np.eye(8), np.full(8, HALF))
    return Fit(predictor, stage, told, PLANT.with_parameters(stiffness=9000.0))


def away(fit: Fit, **factors: float) -> Candidate:
    """A candidate whose values differ from the fit's by these factors."""
    flt = ContactFilter.of(fit.predictor, 100.0)
    values = {name: value for name, value in PLANT.parameters().items() if name in NAMES}
    theta = flt.theta(values | {name: factor * values[name] for name, factor in factors.items()})
    return Candidate("elsewhere", theta, 0.0, flt, [])


def test_a_candidate_within_the_intervals_changes_nothing(fit: Fit):
    _, stage, told, problems = fit.with_room_for([away(fit, stiffness=1.01)], chance=None)
    assert stage is fit.stage and told is fit.told and problems == []


def test_a_fit_is_surer_by_narrower_intervals_of_the_drive(fit: Fit):
    """Of friction, damping and lag another matter."""
    wide = np.where(np.isin(TOLD, CORE), 0.5 * HALF, 10.0)
    assert not fit.surer_than(wide)
    for name in CORE:
        assert fit.surer_than(np.where(np.array(TOLD) == name, 1.1 * HALF, wide))


def test_an_interval_has_room_for_a_candidate_beside_it(fit: Fit):
    _, stage, told, problems = fit.with_room_for([away(fit, stiffness=1.1)], chance=np.zeros(8))
    wider = dict(zip((TOLD[i] for i in stage.free), told.half, strict=True))
    assert wider.pop("stiffness") == pytest.approx(np.hypot(HALF, np.log(1.1)), rel=1e-6)
    assert len(wider) == 7 and set(wider.values()) == {HALF}
    assert [problem.where for problem in problems] == ["stiffness"]


def test_what_is_three_times_off_the_nameplate_is_beyond_it(fit: Fit):
    assert not fit.beyond_nameplate()
    assert replace(fit, start=PLANT.with_parameters(stiffness=3.1 * PLANT.stiffness)).beyond_nameplate()
    assert not replace(fit, start=PLANT.with_parameters(coulomb=4.0 * PLANT.coulomb)).beyond_nameplate()


def test_a_stiffness_far_from_the_nameplate_is_that_of_a_wrong_minimum(fit: Fit):
    def found(factor: float, half: float = 0.01) -> Estimate:
        theta = fit.told.theta.copy()
        theta[TOLD.index("stiffness")] = np.log(factor * 9000.0)
        return Estimate(theta, np.full(8, half), np.eye(8), away(fit))

    for factor in (11.0, 1.0 / 11.0):
        assert fit.wrong_minimum(found(factor)) is None
    for factor in (13.0, 1.0 / 13.0):
        wrong = fit.wrong_minimum(found(factor))
        assert wrong is not None and wrong.where == "stiffness" and "9000 Nm/rad" in wrong.expected
        assert "scale and unit" in wrong.remedy
    assert fit.wrong_minimum(found(13.0, np.inf)) is None  # it is not identified anyway


def test_of_two_that_agree_on_the_drive_the_one_that_knows_it_better_is_taken(fit: Fit):
    """Not friction: the fit has no constant torque, so that it knows a wrong one well."""

    def found(half: float, **factors: float) -> Estimate:
        best = away(fit, **factors)
        halves = np.where(np.isin(TOLD, CORE), half, 3.0 * HALF)
        return Estimate(told_vector(best), halves, np.eye(8), best)

    assert fit.knows_less_than(found(0.5 * HALF, stiffness=1.01, viscous=3.0))
    assert not fit.knows_less_than(found(1.5 * HALF, stiffness=1.01))
    assert not fit.knows_less_than(found(0.5 * HALF, stiffness=1.1))


def test_another_estimate_may_tell_the_drive_alone(fit: Fit):
    """Inertias, stiffness, damping and backlash are its own where it has them; friction and lag stay the fit's."""
    best = away(fit, inertia_motor=1.01, stiffness=0.99, damping=1.5, coulomb=1.3)
    half = np.full(8, 0.001)
    half[TOLD.index("backlash")] = np.inf
    found = Estimate(told_vector(best), half, 1e-7 * np.eye(8), best)
    predictor, stage, told, problems = fit.with_the_drive_of(found)
    assert predictor is fit.predictor and stage.free == fit.stage.free and problems == []
    for i, name in enumerate(TOLD):
        its = name in ("inertia_motor", "inertia_load", "stiffness", "damping")
        assert told.theta[i] == pytest.approx((found if its else fit.told).theta[i])
        assert told.half[i] == (0.001 if its else HALF)
        assert told.covariance[i, i] == pytest.approx(1e-7 if its else 1e-4)
    assert stage.fit.theta == pytest.approx(told.theta)
    assert fit.told.half == pytest.approx(np.full(8, HALF))  # the fit itself is as it was


def test_another_estimate_contradicts_by_what_it_tells(fit: Fit):
    """A backlash that it does not tell may be anywhere, as on rigs 4, 9, 10 and 20 in closed loop."""

    def found(lost: str | None, **factors: float) -> Estimate:
        best = away(fit, **factors)
        half = np.where(np.isin(TOLD, [lost]), np.inf, HALF)
        return Estimate(told_vector(best), half, np.eye(8), best)

    assert not fit.contradicts(found(None, stiffness=1.01, coulomb=2.0))
    assert fit.contradicts(found(None, stiffness=1.1))
    assert fit.contradicts(found(None, backlash=1.1))
    assert not fit.contradicts(found("backlash", backlash=1.1))
    assert fit.contradicts(found("backlash", backlash=1.1, stiffness=1.1))


def test_the_other_estimate_brings_its_likeliest_friction_along(fit: Fit):
    """Motor friction is always its own: beside the nameplate's at the load the two would not belong together."""
    best = away(fit, stiffness=1.3, viscous=2.0, lag=1.5)
    known = np.where(np.isin(TOLD, ["inertia_motor", "inertia_load"]), HALF, np.inf)
    predictor, stage, told, _ = fit.replaced_by(Estimate(told_vector(best), known, np.eye(8), best))
    model = predictor.drivetrain(told.theta)
    assert [TOLD[i] for i in stage.free] == ["inertia_motor", "inertia_load"]
    assert model.viscous == pytest.approx(2.0 * PLANT.viscous)
    assert model.lag == pytest.approx(1.5 * PLANT.lag)
    assert model.stiffness == pytest.approx(9000.0)  # the nameplate's


def test_what_is_fixed_keeps_the_nameplates_value(fit: Fit):
    """The line through a friction that rises towards rest is not the level that was fixed."""
    known = np.where(np.isin(TOLD, CORE), HALF, np.inf)
    best = away(fit, coulomb=2.0, viscous=2.0)
    fixed = replace(fit, stage=replace(fit.stage, free=[i for i in range(8) if TOLD[i] != "coulomb"]))
    predictor, _, told, _ = fixed.replaced_by(Estimate(told_vector(best), known, np.eye(8), best))
    model = predictor.drivetrain(told.theta)
    assert (model.coulomb, model.viscous) == pytest.approx((PLANT.coulomb, 2.0 * PLANT.viscous))


def test_where_nothing_explains_the_recording_only_the_core_is_told(fit: Fit):
    """Friction, damping and lag make up for what the model lacks."""
    _, stage, told, _ = fit.with_room_for([away(fit, backlash=0.9)], chance=None)
    assert [TOLD[i] for i in stage.free] == CORE
    assert told.covariance.shape == (4, 4) and told.half.shape == (4,)


def test_values_too_far_apart_leave_nothing(fit: Fit):
    _, stage, told, problems = fit.with_room_for(
        [away(fit, backlash=np.exp(1.1 * APART))], chance=np.zeros(8)
    )
    assert stage.free == [] and told.half.size == 0 and len(problems) == 1
    assert np.exp(stage.fit.theta[TOLD.index("stiffness")]) == pytest.approx(9000.0)


def test_a_friction_that_may_be_anything_is_not_told(fit: Fit):
    _, stage, _, _ = fit.with_room_for([away(fit, viscous=4.0)], chance=np.zeros(8))
    assert [name for name in TOLD if TOLD.index(name) not in stage.free] == ["viscous"]


def test_an_inertia_that_is_hardly_known_is_not_told_either(fit: Fit):
    """As wide as the other estimator's may be, and not wider; it may be the only one."""
    for half, names in ((0.9 * APART, []), (1.1 * APART, ["inertia_motor"])):
        halves = np.where(np.arange(8) == TOLD.index("inertia_motor"), half, HALF)
        unsure = replace(fit, told=replace(fit.told, half=halves, gap_bound=0.1))
        _, stage, told, _ = unsure.with_room_for([], chance=np.zeros(8))
        assert [name for name in TOLD if TOLD.index(name) not in stage.free] == names
        assert told.half.size == 8 - len(names)


def test_a_friction_is_known_no_better_than_chance_allows(fit: Fit):
    """Where it may be at either end, the fit, which has it at the load alone, is too sure of it."""
    chance = np.where(np.isin(TOLD, ["coulomb", "lag"]), 10.0 * HALF, 0.0)
    chance[TOLD.index("viscous")] = np.inf
    _, stage, told, problems = fit.with_room_for([], chance)
    half = dict(zip((TOLD[i] for i in stage.free), told.half, strict=True))
    assert half == {name: chance[TOLD.index(name)] or HALF for name in TOLD if name != "viscous"}
    assert problems[0].where == "coulomb, viscous, lag"
    # Of inertias, stiffness and backlash the candidates themselves say more.
    assert fit.with_room_for([], np.where(np.isin(TOLD, CORE), np.inf, 0.0))[2] is fit.told
