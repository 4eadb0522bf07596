"""Tables of a mode: rows, exponential, series and bounds beside a builder in extended precision."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from long_double import Rows, build_mode, delta_over, doubled, friction_segment, taylor_terms
from scipy.linalg import expm
from table_i import TABLE_I

from lostmotion.drivetrain import CONTACT_LAWS, Actuator, Drivetrain, Friction, Shaft
from lostmotion.kernels.plant.layout import ELEMENT_ROWS, HEADER
from lostmotion.kernels.plant.taylor_series import ORDER
from lostmotion.simulation.contact_states import elements
from lostmotion.simulation.tables import Mode, Plant

DT = 1e-4
STRIBECK = ((0.0, 0.4), (1.0, 0.1), (3.0, 0.0))


def groups(count: int) -> int:
    return -(-count // 4) * 4


def parts(mode: Mode) -> dict[str, np.ndarray]:
    """The block's numbers by name: guards' rows and bounds, Taylor series of the guards (E, O + 1, C)."""
    columns, e = mode.rows.shape[1], len(mode.guard)
    high, wide = groups(mode.states), groups(e)
    table = mode.block[: columns * (high + ELEMENT_ROWS * wide)].reshape(columns, -1).T
    named = {"delta": table[: mode.states]}
    for i, name in enumerate(("guard", "guard_rate", "swing", "remainder")):
        named[name] = table[high + i * wide :][:e]
    bounds = mode.block[table.size :][: 2 * wide].reshape(2, wide)
    order = int(mode.block[table.size + 2 * wide + 1])
    series = mode.block[table.size + 2 * wide + HEADER + ORDER * columns * high :]
    series = series[: e * columns * groups(ORDER + 1)].reshape(e, columns, groups(ORDER + 1))
    named["series"] = series[:, :, : order + 1].transpose(0, 2, 1)
    return named | {"lower": bounds[0, :e], "upper": bounds[1, :e]}


def typical(plant: Plant) -> np.ndarray:
    """Sizes of the states, inputs and one in ordinary use, by which columns of different units are weighed."""
    layout = plant.layout
    s = np.full(layout.columns, 10.0)
    s[: layout.n - 1] = s[[layout.shaft_angle(i) for i in layout.physical]] = 0.01
    s[layout.angle_motor] = s[-1] = 1.0
    return s


@st.composite
def chains(draw) -> tuple[Drivetrain, tuple[str, ...]]:
    """A chain of one to six inertias under any laws, and its inputs."""

    def number(low: float, high: float) -> float:
        return 10.0 ** draw(st.floats(low, high))

    n = draw(st.integers(1, 6))
    shafts = [
        Shaft(
            number(2, 5),
            draw(st.sampled_from([0.0, number(-3, 1)])),
            draw(st.sampled_from([0.0, 0.01])),
            draw(st.sampled_from(CONTACT_LAWS)),
        )
        for _ in range(n - 1)
    ]
    frictions = [
        Friction(
            draw(st.sampled_from([0.0, 2.0, (1.0, 3.0)])),
            draw(st.sampled_from([0.0, 0.02])),
            draw(st.sampled_from([None, 5.0])),
            draw(st.sampled_from([(), STRIBECK])),
        )
        for _ in range(n)
    ]
    locked = draw(st.sampled_from([None, "motor", "load"]))
    actuator = Actuator(draw(st.sampled_from([0.0, 1e-3])))
    known = ["torque_load", *(f"torque_{i + 1}" for i in range(n))]
    known += [] if locked is None else [f"acceleration_{locked}"]
    inputs = ("torque_motor", *draw(st.lists(st.sampled_from(known), unique=True, max_size=3)))
    inertias = tuple(number(-3, 0) for _ in range(n))
    return Drivetrain(inertias, tuple(shafts), tuple(frictions), actuator, locked), inputs


def entered(drivetrain: Drivetrain, inputs: tuple[str, ...], digits: np.ndarray, dt: float = DT) -> Plant:
    plant = Plant(drivetrain, dt, inputs)
    plant.enter(digits)
    return plant


def check_against_extended_precision(plant: Plant) -> None:
    """Row by row, weighed by `typical`; rounding of a sum is measured by the sum of absolute values."""
    mode, s = plant.modes[-1], typical(plant)
    got, states = parts(mode), plant.layout.states
    rows = Rows(plant.layout, plant.elements, mode.digits)
    full = np.zeros((s.size, s.size), dtype=np.longdouble)
    full[:states] = rows.rates()
    guards = [rows.guard(e) for e in plant.elements]
    guard = np.array([g[0] for g in guards]).reshape(-1, s.size)
    np.testing.assert_allclose(got["guard"], guard.astype(float), rtol=2e-15)
    np.testing.assert_array_equal(got["lower"], [g[1] for g in guards])
    np.testing.assert_array_equal(got["upper"], [g[2] for g in guards])
    np.testing.assert_allclose(mode.shaft_torques, np.array(rows.shaft_torques, float).reshape(-1, s.size))

    halvings = round(math.log2(plant.dt / mode.piece))
    terms, _ = taylor_terms(full, mode.piece, 0.5 / mode.piece)
    piece = delta_over(terms, 1.0)
    sizes = expm(np.abs(full.astype(float)) * mode.piece)

    def close(a: np.ndarray, exact: np.ndarray, size: np.ndarray, rounding: float) -> None:
        assert np.all(np.abs(a - exact.astype(float)) @ s <= rounding * (size @ s))

    # Dampers and a friction that falls with the speed may cancel each other in an entry.
    close(mode.rate, full[:states], np.abs(full[:states]).astype(float), 2e-15)
    change = sizes - np.eye(s.size)
    close(mode.state_series.sum(axis=0), piece[:states], change[:states], 2e-15)
    close(got["series"].sum(axis=1), guard + guard @ piece, np.abs(guard).astype(float) @ sizes, 2e-15)
    close(
        got["guard_rate"],
        guard @ full * plant.dt,
        (np.abs(guard) @ np.abs(full) * plant.dt).astype(float),
        2e-15,
    )
    with np.errstate(over="ignore", invalid="ignore"):
        whole = np.linalg.matrix_power(sizes, 2**halvings) - np.eye(s.size)
    # A damper that relaxes within a thousandth of a sample: the sum of absolute values is no measure of rounding.
    if np.all(np.isfinite(whole)):
        close(got["delta"], doubled(piece, halvings)[:states], whole[:states], 2e-15)


@settings(max_examples=150, deadline=None, derandomize=True, database=None)
@given(chain=chains(), seed=st.integers(0, 10**6), dt=st.sampled_from([1e-5, 1e-4, 1e-3]))
def test_tables_equal_those_of_extended_precision(chain, seed, dt):
    drivetrain, inputs = chain
    assume(math.prod(e.digits for e in elements(drivetrain)) <= 10**6)
    plant = Plant(drivetrain, dt, inputs)
    rng = np.random.default_rng(seed)
    plant.enter(np.array([rng.integers(e.digits) for e in plant.elements], dtype=np.int64))
    check_against_extended_precision(plant)


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_every_mode_of_two_masses(contact):
    drivetrain = Drivetrain.two_mass(**TABLE_I, contact=contact, lag=1e-3)
    plant = Plant(drivetrain, DT, ("torque_motor", "torque_load"))
    for digits in np.ndindex(*(e.digits for e in plant.elements)):
        plant.enter(digits)
        check_against_extended_precision(plant)


def test_stiffness_is_rounded_once():
    """What a twist does to the speeds over a sample is the double nearest to the exact number, hardly ever another.

    The plain sum of the same terms hits it in two cases of three.
    """
    rng = np.random.default_rng(0)
    nearest = 0
    for _ in range(40):
        values = {name: value * rng.uniform(0.8, 1.2) for name, value in TABLE_I.items()}
        plant = entered(
            Drivetrain.two_mass(**values, contact="dead_zone"), ("torque_motor",), np.array([2, 2])
        )
        exact = build_mode(plant.layout, plant.elements, (2, 2), DT).delta[1:3, 0]
        nearest += np.count_nonzero(parts(plant.modes[0])["delta"][1:3, 0] == exact)
    assert nearest >= 78  # of 80


def test_twenty_inertias_under_all_laws():
    shafts = tuple(Shaft(5e3 + 500.0 * i, 0.3, 0.01 * (i < 5), CONTACT_LAWS[i % 5]) for i in range(19))
    frictions = tuple(Friction(1.0 * (i == 7), 0.01, stribeck=STRIBECK if i == 7 else ()) for i in range(20))
    drivetrain = Drivetrain((0.01,) * 20, shafts, frictions)
    plant = Plant(drivetrain, DT, ("torque_motor", "torque_20"))
    for seed in range(4):
        rng = np.random.default_rng(seed)
        plant.enter(np.array([rng.integers(e.digits) for e in plant.elements], dtype=np.int64))
        check_against_extended_precision(plant)


@pytest.mark.parametrize("contact", CONTACT_LAWS)
@pytest.mark.parametrize("dt", [1e-4, 3e-3])
def test_bounds_of_the_enclosure_hold(contact, dt):
    """Swing and remainder bound the guard's second and fourth derivative at every time within a sample."""
    plant = Plant(Drivetrain.two_mass(**TABLE_I, contact=contact), dt, ("torque_motor",))
    states, columns = plant.layout.states, plant.layout.columns
    for digits in np.ndindex(*(e.digits for e in plant.elements)):
        plant.enter(digits)
        mode = plant.modes[-1]
        full = np.zeros((columns, columns))
        full[:states] = mode.rate
        second = mode.guard @ full @ full
        fourth = second @ full @ full
        # Elementwise, so that they hold for every state.
        times = [expm(full * t) for t in np.linspace(0.0, dt, 41)]
        got = parts(mode)
        for name, row, factor in (("swing", second, dt**2 / 2), ("remainder", fourth, dt**4 / 384)):
            largest = np.max([np.abs(row @ at) for at in times], axis=0) * factor
            size = np.abs(row).max(axis=1, keepdims=True) * factor
            assert np.all(got[name] >= largest * (1 - 1e-11) - 1e-15 * size)


def test_bounds_are_not_much_larger_than_the_derivatives():
    """Far below one contact oscillation in a sample the bound is close; else quiet samples would be rare."""
    plant = Plant(Drivetrain.two_mass(**TABLE_I, contact="dead_zone"), DT, ("torque_motor",))
    for digits in np.ndindex(3, 3):
        plant.enter(digits)
        extended = build_mode(plant.layout, plant.elements, digits, DT)
        assert np.all(parts(plant.modes[-1])["swing"] <= 1.05 * extended.swing)


def test_segments_join_to_the_friction_curve():
    friction = Friction((0.5, 0.3), 0.02, stribeck=STRIBECK)
    drivetrain = Drivetrain((0.1, 0.2), (Shaft(1e3),), (Friction(), friction))
    plant = Plant(drivetrain, DT, ("torque_motor",))
    for digit in (0, 1, 2, 4, 5, 6):
        _, _, low, high = friction_segment(friction, digit, 3)
        plant.enter([digit])
        mode = plant.modes[-1]
        for speed in np.linspace(max(low, -9.0), min(high, 9.0), 7)[1:-1]:
            state = np.array([0.0, 0.0, speed, 0.0, 0.0, 1.0])
            assert mode.frictions[1] @ state == pytest.approx(friction.torque(speed), abs=1e-15)
            assert plant.start_digits(state)[0] == digit


def test_exponential_of_a_known_matrix():
    """Of the extended builder itself."""
    a = np.array([[0.0, 1.0], [-4.0, 0.0]], dtype=np.longdouble)
    for time, halvings in ((1e-6, 0), (0.1, 0), (0.1, 3), (0.12, 8)):
        terms, order = taylor_terms(a, time, 4.0)
        assert 4 <= order < len(terms)
        got = doubled(delta_over(terms, 1.0), halvings)
        t = time * 2**halvings
        c, s = math.cos(2 * t), math.sin(2 * t)
        np.testing.assert_allclose(got.astype(float), [[c - 1, s / 2], [-2 * s, c - 1]], rtol=0, atol=4e-15)


def test_modes_are_built_when_entered():
    plant = Plant(Drivetrain.two_mass(**TABLE_I), DT, ("torque_motor",))
    assert len(plant.modes) == 0
    plant.enter((1, 2))
    plant.enter((1, 2))
    assert len(plant.modes) == 1
    assert np.count_nonzero(plant.row_of_mode >= 0) == 1
    assert int(np.flatnonzero(plant.row_of_mode >= 0)[0]) == plant.radix @ (1, 2)
    assert plant.modes[0].digits == (1, 2)


def test_tables_grow_without_losing_modes():
    drivetrain = Drivetrain((0.1,) * 4, (Shaft(1e3, 0.1, 0.01),) * 3)
    plant = Plant(drivetrain, DT, ("torque_motor",))
    first = None
    for digits in np.ndindex(3, 3, 3):
        plant.enter(digits)
        first = plant.modes[0].block.copy() if first is None else first
    assert len(plant.modes) == 27
    np.testing.assert_array_equal(plant.modes[0].block, first)
