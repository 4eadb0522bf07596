"""A second builder of a mode's tables, in extended precision: rows by symbolic sums, exponentials of the whole matrix.

It shares nothing with ``kernels.plant.contact_states`` but the description of the drivetrain and the places of the
states.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import matrix_balance

from lostmotion.drivetrain import Friction
from lostmotion.simulation.contact_states import GAP, PLUS, Element, Layout, relaxes

Long = np.longdouble

#: Largest ‖A‖·(length of a Taylor piece), norm of the balanced matrix.
_PIECE_NORM = 0.5
#: The Taylor series ends where its terms fall below this part of the state.
_LAST_TERM = 1e-18
#: Signs on which a contact law depends.
_SIGNS = {"limited": ("sum", "difference"), "clipped": ("sum",)}


def friction_segment(friction: Friction, digit: int, rest: int) -> tuple[float, float, float, float]:
    """Torque = constant + slope·speed between two speeds: (constant, slope, low, high) of a moving digit."""
    sign = 1.0 if digit > rest else -1.0
    number = abs(digit - rest) - 1
    level = friction.coulomb_plus if sign > 0.0 else friction.coulomb_minus
    points = friction.stribeck or ((0.0, 0.0),)
    near, extra = points[number]
    far, slope = math.inf, 0.0
    if number + 1 < len(points):
        far = points[number + 1][0]
        slope = (points[number + 1][1] - extra) / (far - near)
    constant = sign * (level + extra - slope * near)
    low, high = (near, far) if sign > 0.0 else (-far, -near)
    return constant, slope, low, high


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode's tables.

    piece: length in s; guard_series: (O + 1, E, C) and state_series: (O, N, C), Taylor coefficients over a piece;
    rate: (N, C) dx/dt; shaft_torques: (n − 1, C) rows, Nm.
    """

    delta: NDArray[np.float64]
    rate: NDArray[np.float64]
    guard: NDArray[np.float64]
    guard_rate: NDArray[np.float64]
    lower: NDArray[np.float64]
    upper: NDArray[np.float64]
    swing: NDArray[np.float64]
    remainder: NDArray[np.float64]
    piece: float
    guard_series: NDArray[np.float64]
    state_series: NDArray[np.float64]
    shaft_torques: NDArray[np.float64]


class Rows:
    """Rows over s = [x, inputs, 1] of one mode."""

    def __init__(self, layout: Layout, parts: tuple[Element, ...], digits: tuple[int, ...]) -> None:
        self.layout = layout
        self.digit = {(e.kind, e.index): (d, e) for e, d in zip(parts, digits, strict=True)}
        self.shaft_torques = [self._shaft_torque(i) for i in range(layout.n - 1)]

    def row(self) -> NDArray[Any]:
        return np.zeros(self.layout.columns, dtype=Long)

    def unit(self, column: int, value: float = 1.0) -> NDArray[Any]:
        row = np.zeros(self.layout.columns, dtype=Long)
        row[column] = Long(value)
        return row

    def twist_rate(self, shaft: int) -> NDArray[Any]:
        return self.unit(self.layout.speed(shaft)) - self.unit(self.layout.speed(shaft + 1))

    def _shaft_torque(self, i: int) -> NDArray[Any]:
        shaft = self.layout.drivetrain.shafts[i]
        k, d = Long(shaft.stiffness), Long(shaft.damping)
        twist, rate = self.unit(self.layout.twist(i)), self.twist_rate(i)
        if not shaft.has_backlash:
            return k * twist + d * rate
        digit = self.digit["shaft", i][0]
        if digit == GAP:
            return d * rate if shaft.contact == "dead_zone" else 0 * rate
        if relaxes(shaft):
            return k * self.unit(self.layout.shaft_angle(i)) + d * rate
        elastic, damper = self.contact_parts(i)
        if shaft.contact not in _SIGNS:
            return elastic + damper
        # Signs as for the right flank; on the left one all torques are the other way round.
        right = int(digit == PLUS)
        if self.digit["sum", i][0] != right:
            return 0 * rate
        if shaft.contact == "limited" and self.digit["difference", i][0] != right:
            return 2 * elastic
        return elastic + damper

    def contact_parts(self, i: int) -> tuple[NDArray[Any], NDArray[Any]]:
        """Rows of k·dz(twist) and d·rate in this mode."""
        shaft = self.layout.drivetrain.shafts[i]
        digit = self.digit["shaft", i][0]
        offset = self.unit(-1, (digit - GAP) * 0.5 * shaft.backlash)
        elastic = Long(shaft.stiffness) * (self.unit(self.layout.twist(i)) - offset)
        return elastic, Long(shaft.damping) * self.twist_rate(i)

    def driving_torque(self, i: int) -> NDArray[Any]:
        """Torque on inertia i without its friction."""
        torque = self.external_torque(i)
        if i > 0:
            torque = torque + self.shaft_torques[i - 1]
        if i < self.layout.n - 1:
            torque = torque - self.shaft_torques[i]
        return torque

    def external_torque(self, i: int) -> NDArray[Any]:
        """Torque on inertia i that comes from outside the chain."""
        layout = self.layout
        torque = self.row()
        if i == 0:
            source = layout.actuator
            torque = torque + self.unit(layout.states if source is None else source)
        for name in ("torque_load",) * (i == layout.n - 1) + (f"torque_{i + 1}",):
            if name in layout.inputs:
                torque = torque + self.unit(layout.states + layout.inputs.index(name))
        return torque

    def friction_torque(self, i: int) -> NDArray[Any]:
        friction = self.layout.drivetrain.frictions[i]
        speed = self.unit(self.layout.speed(i))
        torque = Long(friction.viscous) * speed
        if ("friction", i) in self.digit:
            digit, element = self.digit["friction", i]
            constant, slope, _, _ = friction_segment(friction, digit, element.rest)
            torque = torque + Long(slope) * speed + self.unit(-1, constant)
        return torque

    def at_rest(self, i: int) -> bool:
        digit, element = self.digit.get(("friction", i), (1, None))
        return element is not None and digit == element.rest

    def rates(self) -> NDArray[Any]:
        layout, drivetrain = self.layout, self.layout.drivetrain
        rate = np.zeros((layout.states, layout.columns), dtype=Long)
        for i in range(layout.n - 1):
            rate[layout.twist(i)] = self.twist_rate(i)
        for i, inertia in enumerate(drivetrain.inertias):
            if i == drivetrain.locked_inertia:
                name = f"acceleration_{drivetrain.locked}"
                if name in layout.inputs:
                    rate[layout.speed(i)] = self.unit(layout.states + layout.inputs.index(name))
            elif not self.at_rest(i):
                rate[layout.speed(i)] = (self.driving_torque(i) - self.friction_torque(i)) / Long(inertia)
        rate[layout.angle_motor] = self.unit(layout.speed(0))
        for i in layout.physical:
            shaft = drivetrain.shafts[i]
            angle = layout.shaft_angle(i)
            if self.digit["shaft", i][0] == GAP:
                rate[angle] = -(Long(shaft.stiffness) / Long(shaft.damping)) * self.unit(angle)
            else:
                rate[angle] = self.twist_rate(i)
        if layout.actuator is not None:
            lag = Long(drivetrain.actuator.lag)
            rate[layout.actuator] = (self.unit(layout.states) - self.unit(layout.actuator)) / lag
        return rate

    def guard(self, element: Element) -> tuple[NDArray[Any], float, float]:
        """(row, lower, upper) of an element in this mode."""
        i = element.index
        digit = self.digit[element.kind, i][0]
        if element.kind == "shaft":
            return self._shaft_guard(i, digit)
        if element.kind in ("sum", "difference"):
            if self.digit["shaft", i][0] == GAP:
                return self.row(), -math.inf, math.inf
            elastic, damper = self.contact_parts(i)
            row = elastic + damper if element.kind == "sum" else elastic - damper
            return row, *((0.0, math.inf) if digit == 1 else (-math.inf, 0.0))
        friction = self.layout.drivetrain.frictions[i]
        if digit == element.rest:
            plus, minus = friction.level_at_rest
            if friction.breakaway is not None:
                plus = minus = friction.breakaway
            return self.driving_torque(i), -minus, plus
        _, _, low, high = friction_segment(friction, digit, element.rest)
        return self.unit(self.layout.speed(i)), low, high

    def _shaft_guard(self, i: int, digit: int) -> tuple[NDArray[Any], float, float]:
        shaft = self.layout.drivetrain.shafts[i]
        half = 0.5 * shaft.backlash
        row = self.unit(self.layout.twist(i))
        if relaxes(shaft):
            if digit != GAP:
                return self.shaft_torques[i], *((0.0, math.inf) if digit == PLUS else (-math.inf, 0.0))
            row = row - self.unit(self.layout.shaft_angle(i))
        elif shaft.contact == "viscoelastic":
            row = row + Long(shaft.damping) / Long(shaft.stiffness) * self.twist_rate(i)
        bounds = ((-math.inf, -half), (-half, half), (half, math.inf))[digit]
        return row, *bounds


def _balanced_norm(a: NDArray[np.float64]) -> float:
    return float(np.linalg.norm(matrix_balance(a, permute=False)[0], 2))


def taylor_terms(a: NDArray[Any], time: float, norm: float) -> tuple[list[NDArray[Any]], int]:
    """Terms (a·time)ⁿ/n! for n = 0 … in extended precision, and how many of them a double-precision sum needs.

    norm·time is at most a half. The terms go on until they are below the rounding of the extended sum.
    """
    terms = [np.eye(len(a), dtype=Long)]
    order = 0
    size = 1.0
    while size > 1e-22 or len(terms) < 5:
        n = len(terms)
        size *= norm * time / n
        terms.append(terms[-1] @ a * (Long(time) / n))
        if order == 0 and size * norm * time / (n + 1) < _LAST_TERM and n >= 4:
            order = n
    return terms, order


def delta_over(terms: list[NDArray[Any]], fraction: float) -> NDArray[Any]:
    """exp(a·fraction·time) − 1 from the terms over `time`, the smallest first."""
    total = np.zeros_like(terms[0])
    for n in range(len(terms) - 1, 0, -1):
        total = total + terms[n] * Long(fraction) ** n
    return total


def doubled(delta: NDArray[Any], times: int) -> NDArray[Any]:
    """exp(a·2ᵏ·t) − 1 from exp(a·t) − 1: (1 + D)² − 1 = 2 D + D²."""
    for _ in range(times):
        delta = 2 * delta + delta @ delta
    return delta


def build_mode(layout: Layout, parts: tuple[Element, ...], digits: tuple[int, ...], dt: float) -> Mode:
    """Tables of one mode for the sample time dt (s)."""
    rows = Rows(layout, parts, digits)
    states, columns = layout.states, layout.columns
    full = np.zeros((columns, columns), dtype=Long)
    full[:states] = rows.rates()
    norm = _balanced_norm(full[:states, :states].astype(float))
    halvings = max(0, math.ceil(math.log2(max(norm * dt, 1e-300) / _PIECE_NORM)))
    length = dt / 2**halvings
    terms, order = taylor_terms(full, length, norm)
    delta = doubled(delta_over(terms, 1.0), halvings)

    guards = [rows.guard(e) for e in parts]
    guard = np.array([g[0] for g in guards], dtype=Long).reshape(len(parts), columns)
    guard_rate = guard @ full
    second = guard_rate @ full
    fourth = second @ full @ full
    largest_second, largest_fourth = _largest((second, fourth), full, terms, halvings, dt)
    return Mode(
        delta=delta[:states].astype(float),
        rate=full[:states].astype(float),
        guard=guard.astype(float),
        guard_rate=(guard_rate * Long(dt)).astype(float),
        lower=np.array([g[1] for g in guards], dtype=float),
        upper=np.array([g[2] for g in guards], dtype=float),
        swing=0.5 * dt**2 * largest_second,
        remainder=dt**4 / 384.0 * largest_fourth,
        piece=length,
        guard_series=np.array([guard @ term for term in terms[: order + 1]], dtype=float),
        state_series=np.array([term[:states] for term in terms[1 : order + 1]], dtype=float),
        shaft_torques=np.array(rows.shaft_torques, dtype=float).reshape(layout.n - 1, columns),
    )


def _largest(
    rows: tuple[NDArray[Any], ...], full: NDArray[Any], terms: list[NDArray[Any]], halvings: int, dt: float
) -> list[NDArray[np.float64]]:
    """Bounds of |row · exp(F t)| over a sample, elementwise: the grid's largest plus half a cell of its slope.

    A cell is a quarter of a Taylor piece, or an eighth of the sample where that is shorter.
    """
    cells = max(8, 4 * 2**halvings)
    cell = (terms[0] + delta_over(terms, 2**halvings / cells)).astype(float)
    stacked = np.concatenate(rows)
    value = np.concatenate([stacked, stacked @ full]).astype(float)
    largest = np.abs(value)
    for _ in range(cells):
        value = value @ cell
        np.maximum(largest, np.abs(value), out=largest)
    # 1.2: the slope between the grid points may exceed the grid's largest a little.
    half = len(stacked)
    bound = largest[:half] + 1.2 * 0.5 * dt / cells * largest[half:]
    return np.split(np.asarray(bound), len(rows))
