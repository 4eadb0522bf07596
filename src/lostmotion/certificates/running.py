"""From which load speed on the running loop is stable: the search for the smallest speed that can be proved."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from fractions import Fraction
from typing import Any, NamedTuple

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from .certificate import certificate, proof_data, short, verdict
from .equilibrium import Equilibrium, equilibrium
from .linear_loop import flow_and_step, is_stable, is_stable_in_sectors
from .lure import LureLoop, lure_loop, useful_memory, with_memory
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

#: Times that the inequalities are centred at numbers that do not satisfy them yet, where the search without it ends
#: (numerics: once is nearly always enough, twice for laws with many curves).
CENTRINGS = 2

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
        Called with the share done and what is tried.

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
    memory = useful_memory(loop)
    search = _Search(
        with_memory(loop, memory), drivetrain, law, delay, torque_load, fastest, substeps, step, tuple(speeds),
        progress or (lambda share, text: None), memory,
    )  # fmt: skip
    return search.smallest()


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


class _Begun(NamedTuple):
    """What the solver made of a candidate's inequalities without centring: the centre of further attempts."""

    rest: Equilibrium
    problem: SampledProof
    inequalities: Inequalities
    centre: Unknowns | None


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
    memory: tuple[int, ...] = ()
    reason: str = ""
    #: What has been worked out: rests by speed and load torque, candidates by speed and goal.
    _rests: dict[tuple[float, float], Equilibrium | None] = field(default_factory=dict)
    _begun: dict[tuple[float, _Goal], _Begun] = field(default_factory=dict)
    _found: dict[tuple[float, _Goal], _Candidate] = field(default_factory=dict)

    def smallest(self) -> RunningProof:
        """A search in ``speeds``: the sectors nest, so what holds from one speed on holds from any larger one.

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
        for speed, goal in self._proved(speeds, self._goal(speeds[-1])):
            for candidate in self.with_larger_steps(speed, self.at(speed, goal)):
                self.progress(0.95, f"exact check from {speed:g} rad/s")
                try:
                    return self.checked(speed, candidate)
                except Unproved as error:
                    self.reason = str(error)
        raise Unproved(self.reason)

    def _proved(self, speeds: Sequence[float], goal: _Goal) -> list[tuple[float, _Goal]]:
        """Speeds that the solver finds numbers for, with the goal, the smallest first.

        The region that proves most steps at the highest speed need not be the one that reaches down furthest: smaller
        ones are tried below. At last the search takes more pains with what is left.
        """
        found = [(speeds[place], goal) for place in self._proved_places(speeds, goal)]
        for share in SHARES:
            smaller, below = replace(goal, share=share), speeds[: speeds.index(found[0][0])]
            if goal.step is not None and share > goal.share and below and self._solves(below[-1], smaller):
                found = [(speeds[place], smaller) for place in self._proved_places(below, smaller)] + found
        lowest = self._first_allowed(speeds, found[0][1])
        while (place := speeds.index(found[0][0])) > lowest:
            if not self._solves(speeds[place - 1], found[0][1], CENTRINGS):
                break
            found.insert(0, (speeds[place - 1], found[0][1]))
        return found

    def _proved_places(self, speeds: Sequence[float], goal: _Goal) -> list[int]:
        """Places of the speeds that the solver finds numbers for, the smallest first; for the last one it did.

        Most loops are proved nearly as far as their sectors allow: from there the search goes up in doubled steps, then
        halves what is left.
        """
        low = self._first_allowed(speeds, goal)
        failed, proved, step = low - 1, [len(speeds) - 1], 1
        while (left := proved[0] - failed) > 1:
            place = failed + (min(step, left - 1) if len(proved) == 1 else left // 2)
            step *= 2
            self.progress(0.8 * (1.0 - left / len(speeds)), f"load speed from {speeds[place]:g} rad/s")
            if self._solves(speeds[place], goal):
                proved.insert(0, place)
            else:
                failed = place
        return proved

    def _first_allowed(self, speeds: Sequence[float], goal: _Goal) -> int:
        """Place of the smallest speed with sectors in which the linear loops are stable; the last one is."""
        low, high = -1, len(speeds) - 1
        while high - low > 1:
            middle = (low + high) // 2
            try:
                self._problem(speeds[middle], goal)
                high = middle
            except Unproved as error:
                self.reason = str(error)
                low = middle
        return high

    def _solves(self, speed: float, goal: _Goal, centrings: int = 0) -> bool:
        """Whether the solver finds numbers from a speed on."""
        try:
            self.at(speed, goal, centrings)
        except Unproved as error:
            self.reason = str(error)
            return False
        return True

    def _goal(self, speed: float) -> _Goal:
        """What can be proved at the highest speed: stability from every state, else within the torque limit's region.

        Raises ``Unproved`` where nothing is: then nothing is at smaller speeds. Centring is worth its time where it
        proves the goal that asks least.
        """
        goals = [_Goal(), *(_Goal(self.step, share) for share in SHARES if self.loop.limit is not None)]
        for goal in goals:
            if self._solves(speed, goal):
                return goal
        best = None
        for goal in reversed(goals):
            if not self._solves(speed, goal, 1):
                break
            best = goal
        if best is None:
            raise Unproved(self.reason)
        return best

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

    def at(self, speed: float, goal: _Goal, centrings: int = 0) -> _Candidate:
        """What the solver finds for a smallest speed; raises ``Unproved`` if it finds nothing."""
        key = speed, goal
        if key not in self._found:
            if key not in self._begun:
                self._begun[key] = self._first(speed, goal)
            rest, problem, inequalities, centre = self._begun[key]
            self._found[key] = _Candidate(rest, problem, solved(inequalities, centre, centrings), goal)
        return self._found[key]

    def _first(self, speed: float, goal: _Goal) -> _Begun:
        """The inequalities, and what the solver makes of them without centring."""
        rest, problem, numbers = self._problem(speed, goal)
        sizes = state_sizes(numbers)
        assert sizes is not None
        inequalities = Inequalities(numbers.conditions, numbers.layout(), condition_sizes(numbers, sizes))
        found = inequalities.largest_margin(nearly=True)
        return _Begun(rest, problem, inequalities, None if found is None else found[0])

    def _rest(self, speed: float, torque: float) -> Equilibrium | None:
        if (speed, torque) not in self._rests:
            self._rests[speed, torque] = equilibrium(self.loop, Fraction(speed), Fraction(torque))
        return self._rests[speed, torque]

    def _problem(self, speed: float, goal: _Goal) -> tuple[Equilibrium, SampledProof, SampledProof]:
        """A rest, the inequalities, and the same in floats; raises ``Unproved`` where they can have no solution."""
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
        numbers = problem.floats()
        if not is_stable(flow_and_step(numbers, np.asarray(numbers.slopes, dtype=float))[1]):
            raise Unproved("the loop is not stable where it rests, in contact and slipping")
        if not is_stable_in_sectors(numbers):
            raise Unproved("the sectors allow slopes of the curves with which the loop is not stable")
        return known[0], problem, numbers

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
        if self.memory:
            numbers["memory"] = list(self.memory)
        data = certificate(self.drivetrain, self.law, self.delay, claim, rest.segments, numbers)
        reason = verdict(data)
        if reason is not None:
            raise Unproved(f"the exact check failed: {reason}")
        return RunningProof(
            speed, self.fastest, float(rest.reference), self.torque_load, candidate.goal.step, self.delay,
            self.loop.is_odd, data, self.reason,
        )  # fmt: skip


def solved(inequalities: Inequalities, centre: Unknowns | None, centrings: int) -> Unknowns:
    """P and multipliers, rounded, that satisfy the inequalities in floats."""
    for left in reversed(range(centrings + 1)):
        if centre is None:
            break
        rounded = {name: short(value) for name, value in centre.items()}
        if inequalities.hold(rounded):
            return rounded
        centre = inequalities.centred(centre) if left else None
    raise Unproved("the inequalities have no solution that the solver finds")
