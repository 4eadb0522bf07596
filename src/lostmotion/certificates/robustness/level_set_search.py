"""The search for the smallest level sets: rounds, each of which knows the peaks and sets of the one before."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fractions import Fraction
from math import inf, nextafter, sqrt

import numpy as np
from numpy.typing import NDArray

from ..certificate import short
from ..linear_loop import exponential
from ..rational import Matrix, is_positive_definite, rational, zeros
from ..scaling import power_of_two
from ..semidefinite import Inequalities
from .curve_relations import CurveShape
from .level_set import LevelSet, LevelSetProblem, Output
from .peak_outputs import STATES, PeakLoop

Array = NDArray[np.float64]

#: Decays of V that are tried, over that of the slowest pole (option: the first rounds need slow ones, the last fast).
DECAYS = (0.75, 2.0, 5.0, 12.0, 30.0)

#: Rounds of the search, and the gain below which it ends (option).
ROUNDS, LEAST_GAIN = 6, 0.02

#: Margins of the conditions, over their scaled size, that the solver leaves for the exact check (numerics: its own
#: accuracy is 1e-8).
MARGINS = (1e-7, 1e-5)

#: Slowest time constants, and steps, over which the linear loop is followed for typical sizes of states, and a step
#: over the fastest time constant (numerics: they only scale).
LONG, STEPS, FINE = 12.0, 20000, 0.05


def smallest_peaks(loop: PeakLoop, reference: Fraction, substeps: int) -> dict[str, float] | None:
    """Peaks by name; None if the loop is not stable with all curves constant."""
    linear = _linear(loop, float(reference))
    return None if linear is None else _Search(loop, reference, substeps, *linear).peaks()


@dataclass(eq=False)
class _Search:
    """What is known so far: of each signal the peak of what states and saturations make of it, a set that shows it, and
    the decay of that set."""

    loop: PeakLoop
    reference: Fraction
    substeps: int
    sizes: Array
    slowest: float
    found: dict[str, float] = field(default_factory=dict)
    sets: dict[str, LevelSet] = field(default_factory=dict)
    fastest: dict[str, int] = field(default_factory=dict)

    def peaks(self) -> dict[str, float]:
        """Rounds until none of the peaks falls any more."""
        for _ in range(ROUNDS):
            before, known = dict(self.found), dict(self.sets)
            problem = self._problem(known)
            for name, asked in self.loop.asked.items():
                if (found := self._smallest(problem, name, asked.output)) is not None:
                    self.found[name], self.sets[name] = found
            if all(self.found[n] > (1.0 - LEAST_GAIN) * before.get(n, inf) for n in self.found):
                break
        return {name: self._total(name) for name in self.loop.asked}

    def _total(self, name: str) -> float:
        """The peak, with what jumps and set-point add."""
        asked = self.loop.asked[name]
        added = float(asked.by_jumps + asked.by_reference * self.reference)
        return (self.found.get(name, inf) + added) * (1.0 + 1e-12)

    def _problem(self, known: dict[str, LevelSet]) -> LevelSetProblem:
        """The conditions with what is known, yet without decay and output."""
        loop, step = self.loop.loop, self.loop.loop.dt / self.substeps
        given = self.reference * (1 if self.loop.sampled else step)
        widths = [self._total(name) for name in self.loop.arguments]
        return LevelSetProblem(
            A=loop.A * step, E=loop.E * step, Z=loop.Z, S=loop.S, S_w=loop.S_w, S_v=loop.S_v, N=loop.N, N_w=loop.N_w,
            N_v=loop.N_v, R=loop.R * given, M=loop.M * self.reference, shapes=self.loop.shapes,
            sampled=self.loop.sampled, substeps=self.substeps, signals=self._signals(),
            widths=tuple(None if width == inf else Fraction(width) for width in widths), known=tuple(known.values()),
            rate=Fraction(0), output=self.loop.asked["twist"].output,
        )  # fmt: skip

    def _signals(self) -> Matrix:
        """Rows of what is known to stay within ±1."""
        n, p = len(self.loop.loop.states), len(self.loop.loop.plant_curves)
        rows = []
        for name in (*STATES, "torque_motor"):
            row, peak = self.loop.asked[name].output.row, self.found.get(name, inf)
            if name == "torque_motor" and self.loop.sampled:
                row, peak = zeros(n + p), self._total(name)
                row[self.loop.loop.plant_size] = Fraction(1)
            if peak < inf:
                rows.append(row / Fraction(peak))
        return np.array(rows, dtype=object).reshape(len(rows), n + p)

    def _smallest(self, problem: LevelSetProblem, name: str, output: Output) -> tuple[float, LevelSet] | None:
        """The smallest peak over all decays, proved; None if it is not smaller than the one that is known."""
        own, below = replace(problem, output=output), self.found.get(name, inf)
        tried: list[tuple[float, int, Fraction]] = []
        first = self.fastest.get(name)
        # The more is known, the faster the best decay.
        for i in range(len(DECAYS)) if first is None else range(first, min(first + 2, len(DECAYS))):
            rate = Fraction(DECAYS[i] * self.slowest) * self.loop.loop.dt / self.substeps
            if self.loop.sampled and rate * self.substeps > 2:
                break  # the share of equation 31 would be negative, and V might leave its level at a sample
            found = self._gain(replace(own, rate=rate).floats(), MARGINS[0])
            if found is not None and found[0] > 0.0:
                tried.append((found[0], i, rate))
        # Of an infeasible decay the solver may promise the most.
        for gain, i, rate in sorted(tried, reverse=True):
            if 1.0 / sqrt(gain) > (1.0 - 0.1 * LEAST_GAIN) * below:
                return None
            if (proved := self._proved(replace(own, rate=rate), below)) is not None:
                self.fastest[name] = i
                return proved
        return None

    def _gain(self, problem: LevelSetProblem, margin: float) -> tuple[float, dict[str, Array]] | None:
        """Gain over level, and the unknowns, in floats."""
        found = Inequalities(problem.conditions, problem.layout(), self._scales(problem)).largest(
            "gain", "level", margin
        )
        if found is None or not found["level"][0] > 0.0:
            return None
        return float(found["gain"][0] / found["level"][0]), found

    def _proved(self, exact: LevelSetProblem, below: float) -> tuple[float, LevelSet] | None:
        """The bound in fractions."""
        for margin in MARGINS:
            found = self._gain(exact.floats(), margin)
            if found is None:
                continue
            unknowns = {name: rational(short(value)) for name, value in found[1].items()}
            if not all(map(is_positive_definite, exact.conditions(unknowns))):
                continue
            square = unknowns["level"][0] / unknowns["gain"][0]
            peak = nextafter(sqrt(square) * (1.0 + 1e-15), inf)
            return (peak, exact.found(unknowns)) if peak < below else None
        return None

    def _scales(self, problem: LevelSetProblem) -> list[Array]:
        """Typical sizes of the vectors of ``LevelSetProblem.conditions``."""
        high = [np.array([float(s.high) for s in part]) for part in self._parts()]
        state = np.concatenate([self.sizes, power_of_two(high[0])])
        faster = np.abs(problem.Z) @ (np.abs(problem.A) @ self.sizes + np.abs(problem.E) @ high[0])
        rates = [problem.shapes[i].steepest * faster[i] for i in problem.smooth]
        sampled = problem.sampled
        flow = np.concatenate([state, power_of_two(np.array(rates)), np.ones(1 if sampled else 2)])
        law = high[1][problem.inner] if problem.output.before_sample else ()
        output = np.concatenate([self.sizes, high[0][problem.smooth], law])
        rate = problem.rate / 2 if sampled else problem.rate
        made = [flow / sqrt(rate)] * problem.ends + [output] * len(problem.asked)
        if sampled:
            made.append(np.concatenate([state, high[1], np.ones(2)]) / sqrt(rate * problem.substeps))
        return made

    def _parts(self) -> tuple[tuple[CurveShape, ...], tuple[CurveShape, ...]]:
        p = len(self.loop.loop.plant_curves)
        return self.loop.shapes[:p], self.loop.shapes[p:]


def _linear(loop: PeakLoop, reference: float) -> tuple[Array, float] | None:
    """Typical sizes (n,) of the states, and the slowest decay, 1/s, of the loop with all curves constant: how far the
    curves and the set-point move it; None if it is not stable."""
    a, e, r = (m.astype(float) for m in (loop.loop.A, loop.loop.E, loop.loop.R))
    n, p = e.shape
    heights = np.array([float(shape.high) for shape in loop.shapes])
    if loop.sampled:
        dt = float(loop.loop.dt)
        whole = exponential(np.vstack([np.hstack([a, e]), np.zeros((p, n + p))]) * dt)
        s, by_plant, by_law = (m.astype(float) for m in (loop.loop.S, loop.loop.S_w, loop.loop.S_v))
        step, moved = s @ whole[:n, :n], np.hstack([s @ whole[:n, n:] + by_plant, by_law]) * heights
        moved = np.hstack([moved, r * reference])
    else:
        dt = FINE / float(np.max(np.abs(np.linalg.eigvals(a))))
        step, moved = exponential(a * dt), np.hstack([e * heights, r * reference]) * dt
    largest = float(np.max(np.abs(np.linalg.eigvals(step))))
    if not largest < 1.0:
        return None
    slowest = -float(np.log(largest)) / dt
    total = np.zeros(n)
    for _ in range(min(STEPS, int(LONG / (slowest * dt)))):
        total += np.abs(moved).sum(axis=1)
        moved = step @ moved
    return power_of_two(np.maximum(total, 1e-12)), slowest
