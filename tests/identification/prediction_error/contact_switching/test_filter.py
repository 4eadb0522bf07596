"""Innovations of the contact-switching filter, and the likelihood that they stand for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.identification.prediction_error.contact_switching.filter import LAWS, ContactFilter, Run
from lostmotion.identification.prediction_error.contact_switching.likelihood import fitted_rates
from lostmotion.identification.prediction_error.contact_switching.parameter_vector import INDEX, PARAMETERS
from lostmotion.identification.prediction_error.innovations import Predictor
from lostmotion.kernels.innovations.intermediate_inertia import two_springs


def test_the_true_parameters_leave_the_sensors_noise(flt: ContactFilter, values: dict[str, float]):
    run = flt.run(flt.theta(values))
    assert run.cost == pytest.approx(0.0, abs=0.06)
    # White: neighbours are not correlated.
    w = run.weighted[200:]
    assert abs(np.mean(w[1:] * w[:-1]) / np.mean(w**2)) < 0.1


@pytest.mark.parametrize("law", ["viscoelastic", "dead_zone", "limited", "clipped", "physical"])
def test_each_law_of_the_contact_predicts_its_own_drive_best(
    plant: lm.Drivetrain, values: dict[str, float], law: str
):
    """The shaft's own angle is back long before the next contact: the physical law is the clipped one."""
    damped = plant.with_parameters(damping=4.0 * plant.damping)
    damped = replace(damped, shafts=(replace(damped.shafts[0], contact=law),))
    dt, count = 2e-4, 2.0 * np.pi / 2**20
    torque = lm.signals.excitation(1.0, dt, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    angle = np.floor(lm.simulate(damped, torque_motor=torque, dt=dt)["angle_motor"] / count) * count
    speed = np.diff(angle, prepend=0.0) / dt
    flt = ContactFilter.of(Predictor(torque, speed, dt, True, damped, skip=0), 300.0)
    own = {"damping": damped.shafts[0].damping, "motor_rate": 1.0, "load_rate": 1.0, "impact": 1e-3}
    costs = {each: replace(flt, law=each).run(flt.theta(values | own)).cost for each in LAWS}
    best = min(costs, key=costs.__getitem__)
    assert best == {"physical": "clipped"}.get(law, law)
    assert costs.pop(best) < 0.12 < 0.25 < min(costs.values())


@pytest.mark.parametrize("behind", [False, True], ids=["before the gap", "behind it"])
def test_a_third_inertia_is_followed_on_its_side_of_the_gap(behind: bool):
    """A chain whose two shafts have loss factors of their own; on the other side of the gap it is another drive."""
    values = {
        "inertia_motor": 0.05,
        "inertia_load": 0.08,
        "stiffness": 3000.0,
        "damping": 0.6,
        "backlash": 0.01,
    }
    values |= {"coulomb": 1.0, "share": 0.1, "compliance": 0.3, "loss": 5.0}
    near, far = values["inertia_motor"], values["inertia_load"]
    if behind:
        near, far = far, near
    further, last = two_springs(near, far, values["stiffness"], values["share"], values["compliance"])
    rate = values["damping"] * (1.0 / further + 1.0 / last) / (1.0 + 4.0 * values["compliance"])
    inertias = [(1.0 - values["share"]) * near, values["share"] * near, far]
    shafts = [
        lm.Shaft(further, 5.0 * rate * further),
        lm.Shaft(last, rate * last, backlash=values["backlash"]),
    ]
    order = -1 if behind else 1
    friction = lm.Friction(values["coulomb"])
    chain = lm.Drivetrain(inertias[::order], shafts[::order], (lm.Friction(), lm.Friction(), friction))
    torque = lm.signals.excitation(1.0, 2e-4, seed=3, inertia=0.13, coulomb=1.0, viscous=0.0)
    count = 2.0 * np.pi / 2**20
    angle = np.floor(lm.simulate(chain, torque_motor=torque, dt=2e-4)["angle_motor"] / count) * count
    flt = ContactFilter(
        torque, angle, 2e-4, True, count / np.sqrt(12.0), count / np.sqrt(12.0), 6, (0, torque.size)
    )
    theta = flt.theta(values | {"motor_rate": 3.0, "load_rate": 1.0})
    assert replace(flt, behind=behind).run(theta).cost == pytest.approx(0.0, abs=0.15)
    assert replace(flt, behind=not behind).run(theta).cost > 0.5


@pytest.mark.parametrize("behind", [False, True], ids=["third before the gap", "third behind it"])
@pytest.mark.parametrize("fourth_behind", [False, True], ids=["fourth before the gap", "fourth behind it"])
def test_a_fourth_inertia_is_followed_on_its_side_of_the_gap(
    four_inertias: Callable[[bool, bool], tuple[ContactFilter, dict[str, float]]],
    behind: bool,
    fourth_behind: bool,
):
    """Each of the three shafts has a loss factor of its own; with the fourth elsewhere it is another drive."""
    flt, values = four_inertias(behind, fourth_behind)
    theta = flt.theta(values | {"motor_rate": 3.0, "load_rate": 1.0})
    assert flt.run(theta).cost == pytest.approx(0.0, abs=0.15)
    assert replace(flt, fourth_behind=not fourth_behind).run(theta).cost > 0.3


@pytest.mark.parametrize("name", ["inertia_motor", "stiffness", "backlash", "coulomb"])
def test_wrong_parameters_cost_more(flt: ContactFilter, values: dict[str, float], name: str):
    own = flt.run(flt.theta(values)).cost
    for factor in (0.8, 1.25):
        assert flt.run(flt.theta(values | {name: factor * values[name]})).cost > own + 1e-3


def test_little_doubt_about_the_load_costs_little(plant: lm.Drivetrain, values: dict[str, float]):
    """A gap that is eight times the wind-up, and a filter that takes its load torque for noisier than it is: in the gap
    it loses sight of the load, and finds it again at the next contact."""
    wide = lm.Drivetrain.two_mass(**plant.parameters() | {"backlash": 0.1})
    torque = lm.signals.excitation(2.0, 2e-4, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(wide, torque_motor=torque, dt=2e-4)
    speed = run["speed_motor"] + 0.01 * np.random.default_rng(1).standard_normal(torque.size)
    flt = ContactFilter.of(Predictor(torque, speed, 2e-4, False, wide, skip=0), 100.0)
    true = values | {"backlash": 0.1}
    own = flt.run(flt.theta(true)).cost
    assert own == pytest.approx(0.0, abs=0.05)
    assert flt.run(flt.theta(true | {"load_rate": 10.0 * true["load_rate"]})).cost < own + 0.1
    assert flt.run(flt.theta(true | {"backlash": 0.101})).cost < own + 0.3


def test_a_load_torque_with_a_slope_follows_a_slow_one(plant: lm.Drivetrain, values: dict[str, float]):
    """A sine of 2 s: as a random walk the filter is always behind it."""
    torque = lm.signals.excitation(2.0, 2e-4, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    load = 3.0 * np.sin(np.pi * 2e-4 * np.arange(torque.size))
    run = lm.simulate(plant, torque_motor=torque, torque_load=load, dt=2e-4)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(torque.size)
    flt = ContactFilter.of(Predictor(torque, speed, 2e-4, False, plant, skip=0), 100.0)

    def least(drifts: bool) -> float:
        rates = np.geomspace(1e-3, 10.0, 9) * flt.torque_deviation
        each = replace(flt, drifts=drifts)
        return min(each.run(each.theta(values | {"torque_rate": rate})).cost for rate in rates)

    assert least(True) == pytest.approx(0.0, abs=0.1)
    assert least(True) < least(False) - 0.01


def test_a_total_inertia_beyond_that_of_the_slow_motion_costs_more(
    flt: ContactFilter, values: dict[str, float]
):
    theta, free = flt.theta(values), [INDEX["inertia_motor"], INDEX["stiffness"], INDEX["inertia_load"]]
    own, total = flt.run(theta, free), values["inertia_motor"] + values["inertia_load"]
    within = replace(flt, inertia=(1.05 * total, 0.1)).run(theta, free)
    assert within.cost == own.cost and within.weighted.size == flt.counting.size
    # Two half widths away: one beyond.
    beyond = replace(flt, inertia=(np.exp(-0.2) * total, 0.1))
    run = beyond.run(theta, free)
    assert run.cost - own.cost == pytest.approx(0.5 * np.log(2.0))
    step = 1e-6
    for place, slope in zip(free, run.jacobian[:, -1], strict=True):
        moved = theta.copy()
        moved[place] += step
        weights = [one.weighted[-1] / size(one) for one in (beyond.run(moved), run)]
        assert (weights[0] - weights[1]) / step == pytest.approx(slope / size(run), rel=1e-3, abs=1e-4)


def size(run: Run) -> float:
    """Of the innovations over what the filter thinks; what is beyond one is charged."""
    return float(np.sqrt(min(np.mean(run.weighted[:-1] ** 2), 1.0)))


def test_innovations_that_the_filter_does_not_expect_are_charged(
    flt: ContactFilter, values: dict[str, float]
):
    """Under a noisy torque a rate that knows of it does better. Divided out, a filter that is lost in all rows did."""
    per_row = flt.dt**2 if flt.counted else flt.dt
    noise = 300.0 * flt.floor * values["inertia_motor"] / per_row
    noisy = replace(flt, torque=flt.torque + noise * np.random.default_rng(2).standard_normal(flt.rows))
    low, *higher = (noisy.run(flt.theta(values | {"motor_rate": rate})).cost for rate in (30.0, 1e5, 1e6))
    high = min(higher)
    assert high < low - 0.5 and high < np.log(300.0)


@pytest.mark.parametrize("counted", [False, True])
def test_a_motion_that_the_filter_excludes_is_followed_again(
    plant: lm.Drivetrain, values: dict[str, float], counted: bool
):
    """Its motor sticks for certain where the drive's moves. Single rows cost a thousand, or it was lost for good."""
    dt = 2e-4
    torque = 3.0 * np.sin(4.0 * np.pi * dt * np.arange(5000))
    run = lm.simulate(plant, torque_motor=torque, dt=dt)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(torque.size)
    if counted:
        speed = np.diff(np.floor(run["angle_motor"] / 1e-5), prepend=0.0) * 1e-5 / dt
    flt = ContactFilter.of(Predictor(torque, speed, dt, counted, plant, skip=0), 100.0)
    low = dict.fromkeys(("motor_rate", "load_rate", "torque_rate"), 1e-6)
    innovations = flt.run(flt.theta(values | low | {"coulomb_motor": 2.0})).weighted
    assert np.max(np.abs(innovations)) < 3.01


def test_costs_under_different_noise_levels_compare(flt: ContactFilter, values: dict[str, float]):
    """Rates are relative to the noise: a filter that counts on ten times the noise has the same gain, so it predicts as
    well, but for the chance of a contact that it is in doubt about."""
    theta = flt.theta(values)
    assert replace(flt, level=10.0 * flt.floor).run(theta).cost == pytest.approx(flt.run(theta).cost, abs=0.1)


def test_values_are_those_of_the_parameters_over_any_rows(flt: ContactFilter, values: dict[str, float]):
    """A torque was in units of the rows' own torque: over other rows it was another one."""
    theta, rows = flt.theta(values | {"torque_offset": 1.5, "coulomb_motor": 0.5}), slice(0, 700)
    assert flt.part(rows).torque_deviation != pytest.approx(flt.torque_deviation, rel=0.05)
    assert np.array_equal(flt.part(rows).values(theta), flt.values(theta))


def test_the_filter_starts_anew_with_each_piece(flt: ContactFilter, values: dict[str, float]):
    """The same recording twice: the second half's innovations are those of the first, but for the angle's rounding."""
    theta, n = flt.theta(values), flt.rows
    offset = flt.measured[-1] if flt.counted else 0.0
    twice = replace(
        flt, torque=np.tile(flt.torque, 2), measured=np.r_[flt.measured, flt.measured + offset], bounds=(0, n, 2 * n),
        settling=0,
    )  # fmt: skip
    weighted = twice.run(theta).weighted
    assert weighted[n : n + 500] == pytest.approx(weighted[:500], abs=1e-4)
    through = replace(twice, bounds=(0, 2 * n)).run(theta).weighted
    assert through[n] != pytest.approx(weighted[n], abs=1e-2)


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_rows_until_the_first_contact_do_not_count(
    plant: lm.Drivetrain, values: dict[str, float], side: float
):
    """In which place of the gap a recording starts is not known: from against one side, the way to the other one was
    taken for half of the gap, and a push in one direction told 0.0297 rad ± 0.5 % where there are 0.012."""
    dt = 2e-4
    torque = 4.0 + lm.signals.noise(1.0, 200.0, 0.5, 2.0, dt, seed=2)
    state = (side * 0.5 * plant.backlash, 0.0, 0.0)
    run = lm.simulate(plant, torque_motor=torque, dt=dt, state=state)
    speed = run["speed_motor"] + 1e-3 * np.random.default_rng(1).standard_normal(torque.size)
    flt = ContactFilter.of(Predictor(torque, speed, dt, False, plant, skip=0), 3.0 * plant.pole_frequency)
    known = flt.theta(values | {"torque_rate": 1.0, "impact": 1e-3})
    wider = flt.changed(known, backlash=2.0 * values["backlash"])
    assert np.argmax(np.abs(run["twist"]) > 0.5 * plant.backlash) < flt.counting[0] < 0.1 * flt.rows
    assert flt.run(wider).cost == pytest.approx(flt.run(known).cost, abs=1e-3)
    all_rows = replace(flt, settling=0)
    if side <= 0.0:
        assert abs(all_rows.run(wider).cost - all_rows.run(known).cost) > 1e-3


def test_friction_that_differs_by_direction_is_a_constant_torque_beside_one_that_does_not(
    plant: lm.Drivetrain,
):
    """At the load or the motor, also where it holds: no recording tells one from the other."""
    torque = lm.signals.excitation(1.0, 2e-4, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    uneven = lm.Friction(coulomb=(2.6, 1.4), viscous=0.0175)
    load = lm.simulate(replace(plant, frictions=(lm.Friction(), uneven)), torque_motor=torque, dt=2e-4)
    pushed = lm.simulate(plant, torque_motor=torque, torque_load=np.full(torque.size, -0.6), dt=2e-4)
    assert np.max(np.abs(load["speed_motor"] - pushed["speed_motor"])) < 1e-5
    at_once = plant.with_parameters(lag=0.0)
    even = replace(at_once, frictions=(lm.Friction(2.0), at_once.frictions[1]))
    motor = lm.simulate(
        replace(even, frictions=(lm.Friction((2.6, 1.4)), even.frictions[1])), torque_motor=torque, dt=2e-4
    )
    offset = lm.simulate(even, torque_motor=torque - 0.6, dt=2e-4)
    assert np.max(np.abs(motor["speed_motor"] - offset["speed_motor"])) < 1e-5


#: Plant steps in a row of the coarse recordings below, which have 15 rows per torsional period.
STEPS, COARSE = 10, 1e-3
#: Count of the encoder there, rad: 1e-5 of the motion in a row, so that an error of the model shows.
COUNT = 2.0 * np.pi / 2**24


def coarse(
    plant: lm.Drivetrain, torque: np.ndarray, held: np.ndarray, steps: int = STEPS, **given: float
) -> tuple[ContactFilter, np.ndarray]:
    """The filter over rows of so many plant steps each, and the vector of the true parameters."""
    fine = COARSE / steps
    angle = lm.simulate(plant, dt=fine, torque_motor=torque)["angle_motor"][::steps]
    speed = np.diff(np.floor(angle / COUNT), prepend=0.0) * COUNT / COARSE
    flt = ContactFilter.of(Predictor(held, speed, COARSE, True, plant, skip=0), 100.0)
    true = {name: value for name, value in plant.parameters().items() if name in PARAMETERS}
    return flt, flt.theta(true | {"motor_rate": 1.0, "load_rate": 1.0} | given)


def command() -> np.ndarray:
    """Levels of torque that change from row to row, Nm."""
    return 10.0 * np.random.default_rng(5).standard_normal(1000)


def test_a_torque_that_changes_within_a_sample_is_followed_exactly(plant: lm.Drivetrain):
    """The delay is 0.3 of a row; with the torque's mean alone the innovations are a thousand times as large."""
    linear, held = plant.with_parameters(backlash=0.0, coulomb=0.0), command()
    torque = np.concatenate([np.zeros(3), np.repeat(held, STEPS)])[: held.size * STEPS]
    flt, theta = coarse(linear, torque, held, delay=0.3 * COARSE)
    assert flt.run(theta).cost == pytest.approx(0.0, abs=0.1)


def test_friction_that_ends_within_a_sample_is_followed(plant: lm.Drivetrain):
    """The load stops, rests and breaks away between rows."""
    rubbing, held = plant.with_parameters(backlash=0.0, coulomb=4.0), command()
    flt, theta = coarse(rubbing, np.repeat(held, STEPS), held)
    assert flt.run(theta).cost < 0.4


def test_a_measured_torque_goes_straight_from_row_to_row(plant: lm.Drivetrain):
    linear, rows = plant.with_parameters(backlash=0.0, coulomb=0.0, lag=0.0), np.arange(1000)
    finely = 20 * STEPS
    time = (np.arange(rows.size * finely) + 0.5) / finely
    # Straight lines in twenty steps a row: the filter has to know of the rest.
    flt, theta = coarse(
        linear, np.interp(time, rows, command()), command(), finely, motor_rate=30.0, load_rate=30.0
    )
    assert replace(flt, ramp=True).run(theta).cost == pytest.approx(0.0, abs=0.1)
    assert flt.run(theta).cost > 1.0


@pytest.mark.parametrize("counted", [False, True])
def test_sensitivities_are_those_of_the_innovations(plant: lm.Drivetrain, counted: bool):
    """Of an exact recording, whose innovations are none: that the gains change as well does not show. That of the lag
    was a third of it."""
    plant = plant.with_parameters(backlash=0.0, coulomb=0.0)
    torque = lm.signals.excitation(1.0, 2e-4, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(plant, torque_motor=torque, dt=2e-4)
    exact, floor = run["angle_motor" if counted else "speed_motor"], 1e-5 if counted else 1e-2
    flt = ContactFilter(torque, exact.copy(), 2e-4, counted, floor, floor, 6, (0, torque.size))
    known = {name: value for name, value in plant.parameters().items() if name in PARAMETERS}
    theta = flt.theta(known | {"motor_rate": 100.0, "load_rate": 30.0})
    names = ["delay", "torque_offset", *(name for name, value in known.items() if value > 0.0)]
    for name, slope in zip(names, flt.run(theta, [INDEX[n] for n in names]).jacobian, strict=True):
        moved = theta.copy()
        moved[INDEX[name]] += 1e-4
        measured = (flt.run(moved).weighted - flt.run(theta).weighted) / 1e-4
        assert np.linalg.norm(slope - measured) < 0.02 * np.linalg.norm(measured), name


@pytest.mark.parametrize("ramp", [False, True], ids=["held torque", "ramp"])
def test_sensitivities_are_those_of_the_innovations_where_friction_holds(plant: lm.Drivetrain, ramp: bool):
    """Ten samples in a torsional period, a fifth of which the motor rests, and a delay that is no whole number of
    samples. In a row in which one breaks away the change jumps: the median of rows is looked at."""
    dt, rows, fine, delay = 1e-3, 1200, 20, 8
    held = plant.with_parameters(backlash=0.0, coulomb=8.0, coulomb_motor=3.0, lag=0.0)
    at = np.arange(rows)
    torque = 9.0 * np.sin(0.0107 * at) + 3.0 * np.sin(0.04 * at)
    between = (
        np.interp((np.arange(rows * fine) + 0.5) / fine, at, torque) if ramp else np.repeat(torque, fine)
    )
    acting = np.concatenate([np.full(delay, torque[0]), between])[: rows * fine]
    speed = lm.simulate(held, torque_motor=acting, dt=dt / fine)["speed_motor"][::fine]
    flt = ContactFilter(torque, speed.copy(), dt, False, 1e-2, 1e-2, 6, (0, rows), ramp=ramp)
    known = {name: value for name, value in held.parameters().items() if name in PARAMETERS}
    theta = flt.theta(known | {"delay": delay / fine * dt, "motor_rate": 100.0, "load_rate": 30.0})
    assert flt.run(theta).cost < -2.0
    assert np.mean(speed == 0.0) > 0.2
    names = ["delay", "torque_offset", *(name for name, value in known.items() if value > 0.0)]
    run = flt.run(theta, [INDEX[n] for n in names])
    for name, slope in zip(names, run.jacobian, strict=True):
        theta_moved = theta.copy()
        theta_moved[INDEX[name]] += 1e-5
        measured = (flt.run(theta_moved).weighted - run.weighted) / 1e-5
        assert np.median(np.abs(slope - measured)) < 0.02 * np.median(np.abs(measured)) + 1e-9, name


def test_a_lag_of_next_to_nothing_is_none(plant: lm.Drivetrain):
    """A pole far beyond all others would take their digits."""
    linear, held = plant.with_parameters(backlash=0.0, coulomb=0.0, lag=0.0), command()
    flt, theta = coarse(linear, np.repeat(held, STEPS), held)
    without = flt.run(theta).cost
    tiny = theta.copy()
    tiny[INDEX["lag"]] += 1e-12
    assert flt.run(tiny).cost == pytest.approx(without, abs=1e-6)
    assert without == pytest.approx(0.0, abs=0.1)


@pytest.mark.parametrize(("law", "least"), [("viscoelastic", 0.0), ("physical", 0.5)])
def test_what_no_law_tells_of_an_impact_is_a_share_of_the_approach(
    plant: lm.Drivetrain, values: dict[str, float], law: str, least: float
):
    """Of a contact with another law the filter lost the motion at each impact. An exact one leaves no share to find."""
    dt, count = 2e-4, 2.0 * np.pi / 2**24
    torque = lm.signals.excitation(1.0, dt, seed=3, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    other = replace(plant, shafts=(replace(plant.shafts[0], contact=law),))
    angle = np.floor(lm.simulate(other, torque_motor=torque, dt=dt)["angle_motor"] / count) * count
    floor = count / np.sqrt(12.0)
    flt = ContactFilter(torque, angle, dt, True, floor, floor, 9, (0, torque.size))
    exact, share = flt.theta(values), flt.theta(values | {"impact": 0.1})
    fitted = fitted_rates(flt, share, ("impact",))
    assert flt.run(exact).cost - flt.run(fitted).cost > least - 0.02
    assert (flt.values(fitted)[INDEX["impact"]] > 1e-4) == (law == "physical")
