"""Predictive control against DAQP: its quadratic programs, and its mixed-integer solver over the instant of contact."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from crossing_reference import by_daqp
from test_hybrid_predictive import ALL_WISHES, DT, HALF, LIMIT, PLANT, PROGRAMS, drawn, signals_of
from test_predictive import LAW as LINEAR
from test_predictive import WISHES, answer, states

from lostmotion.controllers.feedback.feedback_law import wished_rows
from lostmotion.controllers.hybrid_predictive import crossing_problem
from lostmotion.controllers.planning.crossing_plan import (
    CLOSING,
    FREE,
    SIGNALS,
    TWIST,
    crossing_program,
    shaft_models,
)
from lostmotion.controllers.planning.plan_cost import move_lengths
from lostmotion.controllers.predictive import HORIZON, MOVES, closed_plan
from lostmotion.kernels.predictive import layout
from lostmotion.kernels.predictive.quadratic_program import solve
from lostmotion.systems import design_model

daqp = pytest.importorskip("daqp", reason="the extra daqp is not installed")

#: Cost up to which a state has a plan that nearly keeps its soft limits; beyond it the large numbers of the binaries
#: are too small, or DAQP loses the optimum.
NEARLY_KEPT = 5e3
#: Sample time of the mixed-integer problem: as many moves as a plan has then cross the gap.
COARSE = 6e-4


def test_the_linear_law_is_the_optimum_of_daqp():
    model = design_model(PLANT, DT)
    rows = wished_rows("", model, WISHES["largest_error"], LIMIT, WISHES["largest_oscillation"], np.inf)
    lengths = move_lengths(round(HORIZON / (PLANT.pole_frequency * DT)), MOVES)
    plan = closed_plan(model, rows, LIMIT**-2, lengths)
    for state in states(200, seed=5):
        best, _, flag, _ = daqp.solve(
            LIMIT**2 * plan.hessian, LIMIT * plan.state_gradient @ state, np.zeros((0, MOVES)), np.ones(MOVES),
            -np.ones(MOVES), np.zeros(MOVES, dtype=np.int32), primal_tol=1e-10,
        )  # fmt: skip
        assert flag == 1
        given = {"friction_load_estimated": PLANT.viscous * state[2]}
        assert answer(LINEAR, state, **given) == pytest.approx(LIMIT * best[0], abs=0.02)


def test_every_candidate_is_the_optimum_of_daqp():
    for number, program in enumerate(PROGRAMS):
        for inputs in drawn(3, seed=number):
            signals, hold = signals_of(inputs, 1.0)
            plan, scratch = np.zeros(layout.MOVES), np.zeros(layout.PROGRAM_SCRATCH)
            solve(program.numbers(), signals, hold, LIMIT, plan, scratch, 100)
            cost, torque = by_daqp(program, signals, hold, LIMIT)
            assert scratch[layout.RESULT] == pytest.approx(cost, rel=1e-6)
            assert plan[0] == pytest.approx(torque, abs=1e-3 * LIMIT)


def coarse_problem():
    """The problem with as many samples as moves, and impact speed bound at the contact alone."""
    problem = replace(crossing_problem(PLANT, COARSE, ALL_WISHES, 0.0), late=0)
    gap, closed = shaft_models(PLANT, COARSE)
    assert np.array_equal(problem.gap[0], gap[0]) and np.array_equal(problem.closed[0], closed[0])
    return problem


def coarse_program(problem, contact):
    """The program of one instant, with a row for the twist after each sample and one for the impact."""
    program = crossing_program(problem, (1,) * contact, (1,) * (MOVES - contact))
    signals, moves = np.zeros_like(program.row_signals), np.zeros_like(program.row_moves)
    low, high = np.full(layout.ROWS, -FREE), np.full(layout.ROWS, FREE)
    low_weight, high_weight = np.zeros(layout.ROWS), np.zeros(layout.ROWS)
    free, forced = np.eye(SIGNALS), np.zeros((SIGNALS, MOVES))
    for sample in range(1, MOVES + 1):
        a, b = problem.gap if sample <= contact else problem.closed
        free, forced = a @ free, a @ forced
        forced[:, sample - 1] += b
        signals[sample], moves[sample] = free[TWIST], forced[TWIST]
        if sample < contact:
            high[sample], high_weight[sample] = 0.0, problem.contact_unit**-2
        elif sample > contact:
            low[sample], low_weight[sample] = 0.0, problem.contact_unit**-2
        else:
            signals[0], moves[0] = CLOSING @ free, CLOSING @ forced
            high[0], high_weight[0] = problem.contact_speed, problem.speed_unit**-2
    return replace(
        program, row_moves=moves, row_signals=signals, low=low, high=high, low_weight=low_weight,
        high_weight=high_weight,
    )  # fmt: skip


class MixedInteger:
    """The problem of all instants at once: binaries δⱼ say that the gap closes at sample j, states are variables.

    Bemporad & Morari 1999: with c = δ₁ + … + δⱼ, x⁺ = A_gap x + B u + c·(…) becomes inequalities with a large number.
    """

    #: Units of twist, speeds, torques, so that all numbers are alike; the large numbers for states and for excesses.
    #: With larger ones, with its presolve, or without some cost of every variable, DAQP finds false infeasibilities.
    UNITS = np.array([2e-3, 1.0, 1.0, LIMIT, LIMIT])
    LARGE, LARGE_EXCESS, RIDGE = 20.0, 2e3, 1e-3

    def __init__(self, problem, signals, hold):
        self.problem, self.signals, self.hold = problem, signals, hold
        self.blocks = {"u": MOVES, "x": 5 * MOVES, "binary": MOVES, "oscillation": MOVES, "contact": MOVES,
                       "impact": MOVES, "inside": MOVES, "joined": MOVES}  # fmt: skip
        self.start = dict(zip(self.blocks, np.cumsum([0, *self.blocks.values()]), strict=False))
        self.size = sum(self.blocks.values())
        self.rows, self.bounds = [], []
        self.hessian, self.gradient, self.constant = (
            np.zeros((self.size, self.size)),
            np.zeros(self.size),
            0.0,
        )

    def variable(self, block, i, factor=1.0):
        row = np.zeros(self.size)
        row[self.start[block] + i] = factor
        return row

    def state(self, sample):
        """All signals after so many samples as (rows over the variables, constant)."""
        rows, constant = np.zeros((SIGNALS, self.size)), self.signals.copy()
        if sample > 0:
            constant[:5] = 0.0
            first = self.start["x"] + 5 * (sample - 1)
            rows[:5, first : first + 5] = np.diag(self.UNITS)
        return rows, constant

    def closed(self, sample):
        return sum((self.variable("binary", i) for i in range(sample)), np.zeros(self.size))

    def at_most(self, row, bound):
        self.rows.append(row)
        self.bounds.append(bound)

    def square(self, row, constant=0.0):
        self.hessian += np.outer(row, row)
        self.gradient += constant * row
        self.constant += 0.5 * constant**2

    def build(self):
        p = self.problem
        once = self.closed(MOVES)
        self.at_most(once, 1.0)
        self.at_most(-once, -1.0)
        for k in range(MOVES):
            rows, constant = self.state(k)
            after, after_constant = self.state(k + 1)
            torque, closed = self.variable("u", k, LIMIT), self.closed(k)
            for (a, b), off, limit in ((p.gap, closed, 0.0), (p.closed, -closed, self.LARGE)):
                difference = (after - a @ rows - np.outer(b, torque))[:5] / self.UNITS[:, None]
                rest = (after_constant - a @ constant)[:5] / self.UNITS
                for sign in (1.0, -1.0):
                    for row, value in zip(sign * difference, sign * rest, strict=True):
                        self.at_most(row - self.LARGE * off, limit - value)
            self.square(p.torque_weight**0.5 * torque)
            if k > 0:
                self.square(p.change_weight**0.5 * (torque - self.variable("u", k - 1, LIMIT)))
            else:
                self.square(p.change_weight**0.5 * torque, -(p.change_weight**0.5) * self.signals[4])
            self.sample(k + 1, after, after_constant)
        root = np.linalg.cholesky(p.last + 1e-12 * np.eye(SIGNALS)).T
        rows, constant = self.state(MOVES)
        for row, value in zip(root @ rows, root @ constant, strict=True):
            self.square(row, value)
        return self

    def sample(self, k, rows, constant):
        """Costs and excesses after sample k."""
        p, L = self.problem, self.LARGE_EXCESS
        before, now, here = self.closed(k - 1), self.closed(k), self.variable("binary", k - 1)
        none = np.zeros(self.size)
        if k < MOVES:
            self.square(p.error @ rows, p.error @ constant)
        # (excess, what it exceeds, where it counts: 0 there and 1 elsewhere as rows and constant)
        terms = [
            ("oscillation", sign * p.oscillation, 0.0, -before, 1.0) for sign in (1.0, -1.0) if k < MOVES
        ]
        edge = np.eye(SIGNALS)[TWIST] / p.contact_unit
        terms += [("contact", sign * edge, 0.0, -here, 1.0) for sign in (1.0, -1.0)]
        terms.append(("impact", CLOSING / p.speed_unit, p.contact_speed / p.speed_unit, -here, 1.0))
        terms.append(("inside", edge, 0.0, now, 0.0))
        terms.append(("joined", -edge, 0.0, -before, 1.0))
        for name, row, bound, off, always in terms:
            excess = self.variable(name, k - 1)
            self.at_most(row @ rows - excess - L * off, bound + L * always - row @ constant)
        for name in self.blocks:
            if name not in ("u", "x", "binary"):
                self.at_most(none - self.variable(name, k - 1), 0.0)
                self.square(self.variable(name, k - 1))

    def solve(self):
        low, high = np.full(self.size, -1e30), np.full(self.size, 1e30)
        low[:MOVES], high[:MOVES] = -1.0 - self.hold / LIMIT, 1.0 - self.hold / LIMIT
        binary = slice(self.start["binary"], self.start["binary"] + MOVES)
        low[binary], high[binary] = 0.0, 1.0
        sense = np.zeros(self.size + len(self.rows), dtype=np.int32)
        sense[binary] = 16
        x, value, flag, _ = daqp.solve(
            self.hessian + self.RIDGE * np.eye(self.size), self.gradient, np.array(self.rows),
            np.concatenate([high, self.bounds]), np.concatenate([low, np.full(len(self.rows), -1e30)]), sense,
            presolve=0,
        )  # fmt: skip
        assert flag == 1
        return value - 0.5 * self.RIDGE * x @ x + self.constant, 1 + int(np.argmax(x[binary]))


def test_the_enumeration_finds_the_optimum_of_the_mixed_integer_problem():
    problem = coarse_problem()
    programs = [coarse_program(problem, contact) for contact in range(1, MOVES + 1)]
    compared = []
    for inputs in drawn(20, seed=4):
        # Within reach of the large numbers.
        inputs[1], inputs[3:5] = np.clip(inputs[1], -HALF, 0.9 * HALF), np.clip(inputs[3:5], -2.0, 2.0)
        signals, hold = signals_of(inputs, 1.0)
        costs = []
        for program in programs:
            plan, scratch = np.zeros(MOVES), np.zeros(layout.PROGRAM_SCRATCH)
            solve(program.numbers(), signals, hold, LIMIT, plan, scratch, 200)
            costs.append(scratch[layout.RESULT])
        cost, contact = MixedInteger(problem, signals, hold).build().solve()
        assert min(costs) <= cost * (1.0 + 1e-4)
        if min(costs) < NEARLY_KEPT:
            compared.append(contact)
            assert min(costs) == pytest.approx(cost, rel=1e-4)
            assert contact == 1 + int(np.argmin(costs))
    assert len(compared) > 12 and len(set(compared)) > 3
