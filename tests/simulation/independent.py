"""A second simulator of the same physics: scipy's DOP853 from switching event to switching event, for comparison.

It shares nothing with the package but the description of the drivetrain: right-hand side and switching rules are
written from the torque laws, the state is integrated numerically, every switch restarts the integration.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

from lostmotion import Drivetrain


@dataclass
class Regime:
    """Which branch of every law holds: per shaft (side, branch), per inertia the sign of its motion and segment."""

    side: list[int]
    branch: list[int] = field(default_factory=list)
    sign: list[int] = field(default_factory=list)
    segment: list[int] = field(default_factory=list)


class Independent:
    """State: n − 1 twists, n speeds, n − 1 shaft angles (physical law only), actuator torque."""

    def __init__(
        self, drivetrain: Drivetrain, rtol: float, method: str = "DOP853", max_step: float = np.inf
    ) -> None:
        self.d = drivetrain
        self.n = len(drivetrain.inertias)
        self.rtol = rtol
        self.method = method
        #: Crossings are looked for at the ends of steps: two within one step are overlooked.
        self.max_step = max_step
        self.events = 0

    def twist(self, y, i):
        return y[i]

    def rate(self, y, i):
        return y[self.n - 1 + i] - y[self.n + i]

    def dz(self, y, i, side):
        return y[i] - side * 0.5 * self.d.shafts[i].backlash

    def shaft_torque(self, y, i, r):
        shaft = self.d.shafts[i]
        k, d, rate, side = shaft.stiffness, shaft.damping, self.rate(y, i), r.side[i]
        if not shaft.has_backlash:
            return k * y[i] + d * rate
        elastic = k * self.dz(y, i, side)
        if shaft.contact == "dead_zone":
            return (elastic if side else 0.0) + d * rate
        if side == 0:
            return 0.0
        if shaft.contact == "limited":
            return elastic + (d * rate if r.branch[i] == 0 else r.branch[i] * side * elastic)
        if shaft.contact == "clipped":
            return elastic + d * rate if r.branch[i] else 0.0
        if shaft.contact == "physical" and d > 0.0:
            return k * y[2 * self.n - 1 + i] + d * rate
        return elastic + d * rate

    def driving(self, y, i, u, r):
        torque = 0.0
        if i > 0:
            torque += self.shaft_torque(y, i - 1, r)
        if i < self.n - 1:
            torque -= self.shaft_torque(y, i, r)
        if i == 0:
            torque += y[-1] if self.d.actuator.lag > 0.0 else u
        return torque

    def friction(self, speed, i, r):
        f = self.d.frictions[i]
        if not f.sticks:
            return f.viscous * speed
        sign = r.sign[i]
        level = f.coulomb_plus if sign > 0 else f.coulomb_minus
        extra = 0.0
        if r.segment[i] + 1 < len(f.stribeck):
            (s0, t0), (s1, t1) = f.stribeck[r.segment[i] : r.segment[i] + 2]
            extra = t0 + (t1 - t0) * (sign * speed - s0) / (s1 - s0)
        return sign * (level + extra) + f.viscous * speed

    def slope(self, t, y, u, r):
        n, out = self.n, np.zeros_like(y)
        for i in range(n - 1):
            out[i] = self.rate(y, i)
            shaft = self.d.shafts[i]
            if shaft.contact == "physical" and shaft.has_backlash and shaft.damping > 0.0:
                at = 2 * n - 1 + i
                out[at] = self.rate(y, i) if r.side[i] else -shaft.stiffness / shaft.damping * y[at]
        for i in range(n):
            if not (self.d.frictions[i].sticks and r.sign[i] == 0):
                speed = y[n - 1 + i]
                out[n - 1 + i] = (self.driving(y, i, u, r) - self.friction(speed, i, r)) / self.d.inertias[i]
        if self.d.actuator.lag > 0.0:
            out[-1] = (u - y[-1]) / self.d.actuator.lag
        return out

    def switches(self, u, r):
        """(function of y, direction, action) of every way out of the regime."""
        found = []
        for i, shaft in enumerate(self.d.shafts):
            if shaft.has_backlash:
                found += self.shaft_switches(i, shaft, r)
        for i, f in enumerate(self.d.frictions):
            if f.sticks:
                found += self.friction_switches(i, f, u, r)
        return found

    def shaft_switches(self, i, shaft, r):
        k, d, half, side = shaft.stiffness, shaft.damping, 0.5 * shaft.backlash, r.side[i]
        physical = shaft.contact == "physical" and d > 0.0

        def reach(y):
            if shaft.contact == "viscoelastic":
                return y[i] + d / k * self.rate(y, i)
            return y[i] - y[2 * self.n - 1 + i] if physical else y[i]

        def enter(new):
            def act(y):
                r.side[i] = new
                if shaft.contact == "limited":
                    r.branch[i] = new
                if shaft.contact == "clipped":
                    r.branch[i] = 1
                if physical and new:
                    y[2 * self.n - 1 + i] = y[i] - new * half

            return act

        if side == 0:
            return [(lambda y: reach(y) - half, 1, enter(1)), (lambda y: reach(y) + half, -1, enter(-1))]
        if physical:
            return [(lambda y: side * self.shaft_torque(y, i, r), -1, enter(0))]
        found = [(lambda y: side * reach(y) - half, -1, enter(0))]

        def branch(new):
            def act(y):
                r.branch[i] = new

            return act

        if shaft.contact == "clipped":
            total = lambda y: side * (k * self.dz(y, i, side) + d * self.rate(y, i))  # noqa: E731
            found.append((total, -1, branch(0)) if r.branch[i] else (total, 1, branch(1)))
        if shaft.contact == "limited":
            high = lambda y: d * self.rate(y, i) - side * k * self.dz(y, i, side)  # noqa: E731
            low = lambda y: d * self.rate(y, i) + side * k * self.dz(y, i, side)  # noqa: E731
            found += {
                0: [(high, 1, branch(1)), (low, -1, branch(-1))],
                1: [(high, -1, branch(0))],
                -1: [(low, 1, branch(0))],
            }[r.branch[i]]
        return found

    def friction_switches(self, i, f, u, r):
        at, sign = self.n - 1 + i, r.sign[i]

        def start(new):
            def act(y):
                r.sign[i], r.segment[i] = new, 0

            return act

        def rest(y):
            r.sign[i] = 0
            y[at] = 0.0

        def step(by):
            def act(y):
                r.segment[i] += by

            return act

        if sign == 0:
            plus, minus = self.breakaway(f)
            return [
                (lambda y: self.driving(y, i, u, r) - plus, 1, start(1)),
                (lambda y: self.driving(y, i, u, r) + minus, -1, start(-1)),
            ]
        speeds = [s for s, _ in f.stribeck] or [0.0]
        low = speeds[r.segment[i]]
        down = rest if r.segment[i] == 0 else step(-1)
        found = [(lambda y: sign * y[at] - low, -1, down)]
        if r.segment[i] + 1 < len(speeds):
            high = speeds[r.segment[i] + 1]
            found.append((lambda y: sign * y[at] - high, 1, step(1)))
        return found

    @staticmethod
    def breakaway(f):
        return f.level_at_rest if f.breakaway is None else (f.breakaway, f.breakaway)

    def start_regime(self, y):
        r = Regime([0] * (self.n - 1), [0] * (self.n - 1), [0] * self.n, [0] * self.n)
        for i, shaft in enumerate(self.d.shafts):
            half = 0.5 * shaft.backlash
            k, d, rate = shaft.stiffness, shaft.damping, self.rate(y, i)
            reach = y[i] + (d / k * rate if shaft.contact == "viscoelastic" else 0.0)
            r.side[i] = 1 if reach > half else -1 if reach < -half else 0
            elastic = abs(k * self.dz(y, i, r.side[i]))
            if shaft.contact == "limited" and r.side[i]:
                r.branch[i] = 1 if d * rate > elastic else -1 if d * rate < -elastic else 0
            if shaft.contact == "clipped":
                r.branch[i] = int(elastic + r.side[i] * d * rate > 0.0)
            if shaft.contact == "physical" and r.side[i]:
                y[2 * self.n - 1 + i] = y[i] - r.side[i] * half
                if d > 0.0 and r.side[i] * self.shaft_torque(y, i, r) < 0.0:
                    r.side[i] = 0  # wound up, but torn away from the edge faster than it unwinds
        for i, f in enumerate(self.d.frictions):
            speed = y[self.n - 1 + i]
            r.sign[i] = int(math.copysign(1, speed)) if speed else 0
            r.segment[i] = max(0, sum(s <= abs(speed) for s, _ in f.stribeck) - 1)
        return r

    def run(self, torque, dt, start):
        """(len(torque) + 1, 2 n − 1) twists and speeds at every sample."""
        n = self.n
        y = np.zeros(3 * n - 1)
        y[: 2 * n - 1] = start
        r = self.start_regime(y)
        rows = [y[: 2 * n - 1].copy()]
        for u in torque:
            y = self.sample(y, u, dt, r)
            rows.append(y[: 2 * n - 1].copy())
        return np.array(rows)

    def sample(self, y, u, dt, r):
        t = 0.0
        for _ in range(1000):
            self.let_slip(y, u, r)
            ways = self.switches(u, r)
            events = []
            for function, direction, _act in ways:
                event = lambda t, y, g=function: g(y)  # noqa: E731
                event.terminal, event.direction = True, direction
                events.append(event)
            solution = self.solve(t, dt, y, u, r, events)
            if solution.status == 0:
                return solution.y[:, -1]
            which = next(j for j, times in enumerate(solution.t_events) if times.size)
            at = solution.t_events[which][0]
            if at > t:
                y = self.solve(t, at, y, u, r, None).y[
                    :, -1
                ]  # the step's own accuracy, not its interpolant's
            t = at
            ways[which][2](y)
            self.events += 1
        raise RuntimeError("endless switching")

    def let_slip(self, y, u, r):
        for i, f in enumerate(self.d.frictions):
            if f.sticks and r.sign[i] == 0:
                plus, minus = self.breakaway(f)
                driving = self.driving(y, i, u, r)
                if not -minus <= driving <= plus:
                    r.sign[i], r.segment[i] = (1 if driving > 0 else -1), 0

    def solve(self, t, end, y, u, r, events):
        slope = lambda t, y: self.slope(t, y, u, r)  # noqa: E731
        options = {"rtol": self.rtol, "atol": 1e-16, "max_step": self.max_step}
        return solve_ivp(slope, (t, end), y, self.method, events=events, **options)
