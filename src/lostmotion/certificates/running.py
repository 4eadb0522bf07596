"""From which load speed on the running loop is stable: the search for the smallest speed that can be proved."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from .certificate import certificate, proof_data, short, verdict
from .equilibrium import Equilibrium, equilibrium
from .linear_loop import is_stable_in_sectors
from .lure import LureLoop, lure_loop, with_gap_memory
from .sampled_proof import SampledProof, sampled_proof
from .scaling import condition_sizes, state_sizes
from .sectors import copies, limit_region, sectors
from .semidefinite import Inequalities, Unknowns

Progress = Callable[[float, str], None]

#: Load speeds (rad/s) that are tried, ten per decade (option: Renard's series R10, ISO 3).
SPEEDS = tuple(
    round(step * 10.0**decade, 6)
    for decade in range(-3, 2)
    for step in (1.0, 1.25, 1.6, 2.0, 2.5, 3.15, 4.0, 5.0, 6.3, 8.0)
)

#: Steps of the load speed (rad/s) that are tried where the torque limit keeps a proof from holding everywhere (option).
STEPS = (0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0)

#: Step (rad/s) that must be proved there, by default (option).
STEP = 0.5

#: Shares of its slope that the limit keeps in the region of such a proof: the torque may ask for 1/share times the room
#: that the limit leaves (option: larger regions allow larger steps, and are proved more seldom).
SHARES = (0.2, 0.5)

#: So many speeds below the smallest that bisection finds are tried as well (numerics).
NEAR = 3

#: Load speed up to which a proof holds, rad/s (option).
FASTEST = 1000.0


class Unproved(Exception):
    """Why a proof was not found."""


@dataclass(frozen=True, eq=False)
class RunningProof:
    """What is proved of the loop at a constant set-point.

    Parameters
    ----------
    speed : float or None
        The loop is globally asymptotically stable at every load speed (rad/s) from here on up to ``fastest``; None if
        nothing is proved.
    fastest : float, rad/s
    reference : float or None
        Set-point (rad/s) that leads to ``speed``.
    torque_load : (float, float), Nm
        Range of constant load torques, positive in the direction of the motion.
    step : float or None
        Where the torque limit keeps the proof from holding for every state: the largest step of the load speed (rad/s)
        within the range after which it holds. None: it holds from every state.
    delay : int
        Computing delay in samples that is part of the loop.
    both_directions : bool
        Whether it also holds for the opposite speeds and load torques.
    certificate : dict or None
        See ``certificate.certificate``.
    reason : str
        Why nothing is proved, or why not from a smaller speed on.
    """

    speed: float | None
    fastest: float
    reference: float | None
    torque_load: tuple[float, float]
    step: float | None
    delay: int
    both_directions: bool
    certificate: dict[str, Any] | None
    reason: str


@checks_arguments
def prove_running(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    *,
    delay: int = 0,
    torque_load: tuple[float, float] = (0.0, 0.0),
    fastest: float = FASTEST,
    substeps: int = 1,
    step: float = STEP,
    speeds: Sequence[float] = SPEEDS,
    progress: Progress | None = None,
) -> RunningProof:
    """The smallest load speed from which the sampled loop is proved globally asymptotically stable.

    Parameters
    ----------
    drivetrain, law, delay
        See ``lure.lure_loop``.
    torque_load : (float, float), Nm
        Smallest and largest constant load torque, positive in the direction of the motion.
    fastest : float, rad/s
        Largest load speed.
    substeps : int
        Into how many substeps P(τ) is cut over a sample.
    step : float, rad/s
        Step of the load speed that must be proved where the torque limit keeps the proof from holding for every state;
        larger ones of ``STEPS`` are tried.
    speeds : sequence of float, rad/s, rising
        Smallest load speeds that are tried; fewer take less time.
    progress : callable, optional
        Told the share done and what is tried.

    Raises
    ------
    InvalidInput
        For a drivetrain or a law that has no Lur'e form, and for ranges that are empty.
    """
    if not torque_load[0] <= torque_load[1] or not math.isfinite(sum(torque_load)):
        raise InvalidInput(
            "torque_load", repr(torque_load), "smallest and largest torque in Nm", "Swap them."
        )
    if substeps < 1:
        raise InvalidInput("substeps", repr(substeps), "a whole number from 1 on", "1 is usual.")
    if not speeds or list(speeds) != sorted(set(speeds)) or not speeds[0] > 0.0:
        raise InvalidInput("speeds", repr(tuple(speeds)), "positive speeds that rise, rad/s", "Sort them.")
    if not speeds[0] < fastest < math.inf:
        raise InvalidInput("fastest", repr(fastest), f"more than {speeds[0]} rad/s", "Raise it.")
    if not 0.0 < step < math.inf:
        raise InvalidInput("step", repr(step), "a step of the load speed in rad/s above 0", "Raise it.")
    loop = lure_loop(drivetrain, law, delay=delay)
    search = _Search(
        loop, drivetrain, law, delay, torque_load, fastest, substeps, step, tuple(speeds),
        progress or (lambda share, text: None),
    )  # fmt: skip
    proof = search.smallest()
    if proof.speed is None and "gap" in loop.names:
        # Slower, and needed by laws that read the shaft torque.
        remembering = replace(search, loop=with_gap_memory(loop), gap_memory=True, _rests={}, _found={})
        with_memory = remembering.smallest()
        return proof if with_memory.speed is None else with_memory
    return proof


@dataclass(frozen=True)
class _Goal:
    """Stability from every state, or after steps (rad/s) within the region in which the limit keeps a share."""

    step: float | None = None
    share: float = 1.0


@dataclass(frozen=True, eq=False)
class _Candidate:
    """A rest of the loop, what is to be proved there, the numbers that do it, and for what goal."""

    rest: Equilibrium
    problem: SampledProof
    unknowns: Unknowns
    goal: _Goal


@dataclass(eq=False)
class _Search:
    loop: LureLoop
    drivetrain: Drivetrain
    law: DiscreteSystem
    delay: int
    torque_load: tuple[float, float]
    fastest: float
    substeps: int
    step: float
    speeds: tuple[float, ...]
    progress: Progress
    gap_memory: bool = False
    reason: str = ""
    #: What has been worked out: rests by speed and load torque, candidates by speed and goal.
    _rests: dict[tuple[float, float], Equilibrium | None] = field(default_factory=dict)
    _found: dict[tuple[float, _Goal], _Candidate | Unproved] = field(default_factory=dict)

    def smallest(self) -> RunningProof:
        """Bisection over ``speeds``: the sectors nest, so what holds from one speed on holds from any larger one.

        The floats of the solver guide it; the exact check of the last one decides, and goes up where it fails.
        """
        try:
            return self._checked_smallest()
        except Unproved as error:
            return RunningProof(
                None, self.fastest, None, self.torque_load, None, self.delay, self.loop.is_odd, None, str(error)
            )  # fmt: skip

    def _checked_smallest(self) -> RunningProof:
        """The proof that ``smallest`` finds; raises ``Unproved`` if it finds none."""
        speeds = [speed for speed in self.speeds if speed < self.fastest]
        goal = self._goal(speeds[-1])
        found: dict[int, _Candidate] = {}
        low, high = -1, len(speeds)
        done, tries = 0, math.ceil(math.log2(len(speeds) + 1))
        while high - low > 1:
            middle = (low + high) // 2
            self.progress(0.8 * done / tries, f"load speed from {speeds[middle]:g} rad/s")
            done += 1
            if self._solves(speeds[middle], goal, middle, found):
                high = middle
            else:
                low = middle
        # Near its limit the solver fails here and there: a smaller speed may do where a larger one did not.
        for place in range(max(0, high - NEAR), high):
            if found and self._solves(speeds[place], goal, place, found):
                break
        for place in sorted(found):
            for candidate in self.with_larger_steps(speeds[place], found[place]):
                self.progress(0.95, f"exact check from {speeds[place]:g} rad/s")
                try:
                    return self.checked(speeds[place], candidate)
                except Unproved as error:
                    self.reason = str(error)
        raise Unproved(self.reason)

    def _solves(self, speed: float, goal: _Goal, place: int, found: dict[int, _Candidate]) -> bool:
        """Whether the solver finds numbers from a speed on; they go into ``found``."""
        try:
            found[place] = self.at(speed, goal)
        except Unproved as error:
            self.reason = str(error)
        return place in found

    def _goal(self, speed: float) -> _Goal:
        """What can be proved at the highest speed: stability from every state, else within the torque limit's region.

        Raises ``Unproved`` where nothing is: then nothing is at smaller speeds.
        """
        goals = [_Goal(), *(_Goal(self.step, share) for share in SHARES if self.loop.limit is not None)]
        for goal in goals:
            try:
                self.at(speed, goal)
            except Unproved as error:
                self.reason = str(error)
            else:
                return goal
        raise Unproved(self.reason)

    def with_larger_steps(self, speed: float, candidate: _Candidate) -> list[_Candidate]:
        """Candidates with larger steps of the set-point, the largest first; the last is the given one."""
        found = [candidate]
        for step in STEPS if candidate.goal.step is not None else ():
            if step > self.step:
                self.progress(0.9, f"steps of {step:g} rad/s")
                try:
                    found.insert(0, self.at(speed, replace(candidate.goal, step=step)))
                except Unproved:
                    break
        return found

    def at(self, speed: float, goal: _Goal) -> _Candidate:
        """What the solver finds for a smallest speed; raises ``Unproved`` if it finds nothing."""
        if (speed, goal) not in self._found:
            try:
                self._found[speed, goal] = self._solved_at(speed, goal)
            except Unproved as error:
                self._found[speed, goal] = error
        found = self._found[speed, goal]
        if isinstance(found, Unproved):
            raise found
        return found

    def _rest(self, speed: float, torque: float) -> Equilibrium | None:
        if (speed, torque) not in self._rests:
            self._rests[speed, torque] = equilibrium(self.loop, Fraction(speed), Fraction(torque))
        return self._rests[speed, torque]

    def _solved_at(self, speed: float, goal: _Goal) -> _Candidate:
        corners = [self._rest(r, m) for m in sorted(set(self.torque_load)) for r in (speed, self.fastest)]
        known = [corner for corner in corners if corner is not None]
        if len(known) < len(corners):
            raise Unproved("the loop has no single equilibrium there")
        bounds = sectors(self.loop, known)
        if bounds is None:
            raise Unproved("a curve changes its segment between the smallest and the largest speed")
        pairs = copies(self.loop, known)
        region = None
        if goal.step is not None:
            region, bounds = limit_region(self.loop, known, bounds, Fraction(goal.step), Fraction(goal.share))
        problem = sampled_proof(self.loop, known[0], bounds, pairs, self.substeps, region)
        return _Candidate(known[0], problem, self.solved(problem), goal)

    def checked(self, speed: float, candidate: _Candidate) -> RunningProof:
        """The proof, which holds in exact fractions; raises ``Unproved`` if not."""
        claim = {
            "speed_from": speed,
            "speed_to": float(self.fastest),
            "torque_load": [float(torque) for torque in self.torque_load],
            "both_directions": self.loop.is_odd,
            "limit": None if candidate.goal.step is None else asdict(candidate.goal),
        }
        rest, numbers = candidate.rest, proof_data(candidate.problem, candidate.unknowns)
        if self.gap_memory:
            numbers["gap_memory"] = True
        data = certificate(self.drivetrain, self.law, self.delay, claim, rest.segments, numbers)
        reason = verdict(data)
        if reason is not None:
            raise Unproved(f"the exact check failed: {reason}")
        return RunningProof(
            speed, self.fastest, float(rest.reference), self.torque_load, candidate.goal.step, self.delay,
            self.loop.is_odd, data, self.reason,
        )  # fmt: skip

    def solved(self, problem: SampledProof) -> Unknowns:
        """P and multipliers, rounded, that satisfy the inequalities in floats."""
        numbers = problem.floats()
        sizes = state_sizes(numbers)
        if sizes is None:
            raise Unproved("the loop is not stable where it rests, in contact and slipping")
        if not is_stable_in_sectors(numbers):
            raise Unproved("the sectors allow slopes of the curves with which the loop is not stable")
        scales = condition_sizes(numbers, sizes)
        found = Inequalities(numbers.conditions, numbers.layout(), scales).largest_margin()
        if found is None:
            raise Unproved("the solver found no numbers")
        unknowns = {name: short(value) for name, value in found[0].items()}
        for scale, matrix in zip(scales, numbers.conditions(unknowns), strict=True):
            if not np.linalg.eigvalsh(matrix * np.outer(scale, scale))[0] > 0.0:
                raise Unproved("the inequalities have no solution that the solver finds")
        return unknowns
