"""Beside a proof: the worst start that a search finds, and below which load speed the simulated loop really fails."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...display.numbers import quantity
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...recording import Recording
from ...simulation import simulate
from ...systems import DiscreteSystem
from ..equilibrium import Equilibrium, equilibrium
from ..lure import LureLoop, lure_loop
from ..running import SPEEDS, STEPS, RunningProof
from .simulated_variants import settling_time

Array = NDArray[np.float64]

#: Starts of each round, best of them that the next round is drawn around, rounds where it is proved, and beyond
#: (option: a hundred simulations; cross-entropy method, Rubinstein & Kroese 2004).
STARTS, BEST, ROUNDS, BEYOND = 16, 4, 5, 1
#: Starts lie within so many times the twist at rest, and within so many rad/s (option: speeds that an impact makes).
TWISTS, LARGEST_SPEED = 2.0, 5.0
#: Length of a simulation, s, and what is added over the load speed, rad: at low speed friction is overcome slowly
#: (option: PI winds up by twice the Coulomb torque in 0.02 rad of set-point).
DURATION, WAIT = 1.0, 0.1
#: Distance of the end from the rest that is the equilibrium's, over its speed (option).
NEAR = 0.1
#: So many times longer a start is simulated that has not settled (option: laws that wind up slowly).
LONGER = 8
#: How far the search goes below the proof's load speed, or above its step, as a factor (option).
FURTHEST = 10.0


@dataclass(frozen=True, kw_only=True)
class WorstCase:
    """What simulations beside a proof have found.

    Parameters
    ----------
    settling : float, s
        Longest settling time at the smallest proved load speed; inf: a start did not settle, and something is wrong.
    start : (float, float, float)
        Twist (rad), motor speed and load speed (rad/s) of it; of a proof for steps the rest that it stepped from.
    simulations : int
    proved : float
        Smallest load speed (rad/s), or largest step of it, that is proved.
    still_settles : float
        Smallest load speed, or largest step, at which all starts of the search settle.
    fails : float or None
        The next one that was tried, at which one does not; None if the search found none.
    of_steps : bool
        Whether these are steps.
    check_fired : int
        Simulations in which an input check of the law fired: the proof says nothing about them.
    """

    settling: float
    start: tuple[float, float, float]
    simulations: int
    proved: float
    still_settles: float
    fails: float | None
    of_steps: bool
    check_fired: int

    @property
    def careful(self) -> float:
        """By what factor the proof is more careful than what was simulated."""
        return self.still_settles / self.proved if self.of_steps else self.proved / self.still_settles

    def __str__(self) -> str:
        if math.isinf(self.settling):
            return f"A start that is proved does not settle within the simulated time: {self.start}."
        unit = "steps of {:g} rad/s" if self.of_steps else "{:g} rad/s"
        where = "up to" if self.of_steps else "down to"
        end = "the search ended there" if self.fails is None else f"at {unit.format(self.fails)} one does not"
        fired = (
            f"An input check fired in {self.check_fired} of them: no proof covers those. "
            if self.check_fired
            else ""
        )
        return (
            f"The worst of {self.simulations} simulated starts settles in {quantity(self.settling, 's')}. {fired}"
            f"All settle {where} {unit.format(self.still_settles)}, a factor {self.careful:.3g} beyond the proof: "
            f"{end}."
        )


@checks_arguments
def worst_case(
    drivetrain: Drivetrain, law: DiscreteSystem, proof: RunningProof, *, rounds: int = ROUNDS, seed: int = 1
) -> WorstCase | None:
    """Search for the start that settles last, then for the load speed or the step at which one does not settle.

    Of a proof from every state: starts of twist and speeds, at the smallest proved speed, then at lower ones. Of a
    proof for steps: steps between proved speeds, then larger ones. None where nothing is proved.

    Parameters
    ----------
    drivetrain, law
        Those of the proof; the law with its input checks, so that it is seen whether they fire.
    proof : RunningProof
    rounds : int
        Of 16 simulations each where it is proved.
    seed : int
    """
    if rounds < 1:
        raise InvalidInput(
            "worst_case.rounds", repr(rounds), "one or more", "Leave it out for the usual ones."
        )
    if proof.speed is None:
        return None
    rng = np.random.default_rng(seed)
    return _Search(drivetrain, law, proof, rounds, rng).result(proof.speed, proof.step)


class _Search:
    def __init__(
        self,
        drivetrain: Drivetrain,
        law: DiscreteSystem,
        proof: RunningProof,
        rounds: int,
        rng: np.random.Generator,
    ) -> None:
        self.drivetrain, self.law, self.proof, self.rounds, self.rng = drivetrain, law, proof, rounds, rng
        self.loop: LureLoop = lure_loop(drivetrain, law, delay=proof.delay)
        self.torque = proof.torque_load[0]
        self.simulations = self.fired = 0

    def result(self, speed: float, step: float | None) -> WorstCase:
        """What is proved, then beyond it: lower speeds, or larger steps, until a start does not settle."""
        if step is None:
            proved, beyond = speed, [s for s in reversed(SPEEDS) if speed / FURTHEST <= s < speed]
        else:
            proved, beyond = step, [s for s in STEPS if step < s <= FURTHEST * step]

        def worst(tried: float, rounds: int) -> tuple[float, tuple[float, float, float]]:
            return (
                self._worst_start(tried, rounds) if step is None else self._worst_step(tried, speed, rounds)
            )

        settling, start = worst(proved, self.rounds)
        simulations, fired = self.simulations, self.fired
        settles, fails = proved, None
        for tried in beyond:
            if math.isinf(worst(tried, BEYOND)[0]):
                fails = tried
                break
            settles = tried
        return WorstCase(
            settling=settling, start=start, simulations=simulations, proved=proved, still_settles=settles, fails=fails,
            of_steps=step is not None, check_fired=fired,
        )  # fmt: skip

    def _worst_start(self, speed: float, rounds: int) -> tuple[float, tuple[float, float, float]]:
        """Longest settling time at a load speed, and its start; ends at the first that does not settle."""
        rest = self._rest(speed)
        if rest is None:
            return math.inf, (math.nan, math.nan, math.nan)
        sizes = np.array([TWISTS * abs(float(rest.state[0])), LARGEST_SPEED, LARGEST_SPEED])
        course = [(float(rest.reference), self._samples(speed))]
        found = self._most(
            lambda part: self._settling(course, (sizes * part).tolist(), speed), np.zeros(3), rounds
        )
        twist, motor, load = (sizes * found[1]).tolist()
        return found[0], (twist, motor, load)

    def _worst_step(self, step: float, speed: float, rounds: int) -> tuple[float, tuple[float, float, float]]:
        """The same for steps of up to that size between speeds from ``speed`` on, up and down."""

        def settling(part: Array) -> float:
            first = speed + (0.5 + 0.5 * part[0]) * step
            second = max(speed, first + part[1] * step)
            rests = self._rest(first), self._rest(second)
            if rests[0] is None or rests[1] is None:
                return math.inf
            course = [
                (float(rest.reference), self._samples(r))
                for rest, r in zip(rests, (first, second), strict=True)
                if rest is not None
            ]
            return self._settling(course, None, second)

        worst, part = self._most(settling, np.array([0.0, 1.0]), rounds)
        first = speed + (0.5 + 0.5 * float(part[0])) * step
        rest = self._rest(first)
        twist = math.nan if rest is None else float(rest.state[0])
        return worst, (twist, first, first)

    def _most(self, measure: Callable[[Array], float], centre: Array, rounds: int) -> tuple[float, Array]:
        """Largest measure over parts in −1 … 1, and where; the cross-entropy method, ended by the first infinity."""
        best: list[tuple[float, Array]] = []
        middle, width = np.zeros(centre.size), np.full(centre.size, 0.6)
        for number in range(rounds):
            parts = np.clip(middle + width * self.rng.standard_normal((STARTS, centre.size)), -1.0, 1.0)
            if number == 0:
                parts[0] = centre
            for part in parts:
                best.append((measure(part), part))
                if math.isinf(best[-1][0]):
                    return best[-1]
            best = sorted(best, key=lambda each: -each[0])[:BEST]
            kept = np.array([part for _, part in best])
            middle, width = kept.mean(axis=0), kept.std(axis=0) + 0.05
        return best[0]

    def _rest(self, speed: float) -> Equilibrium | None:
        return equilibrium(self.loop, Fraction(speed), Fraction(self.torque))

    def _samples(self, speed: float) -> int:
        return round((DURATION + WAIT / speed) / self.law.dt)

    def _settling(
        self, course: list[tuple[float, int]], start: list[float] | None, speed: float, factor: int = 1
    ) -> float:
        """Time from the last of the set-points (rad/s, samples) on until the load has come to its rest, s."""
        *before, (last, samples) = course
        course = [*before, (last, factor * samples)]
        reference = np.concatenate([np.full(count, value) for value, count in course])
        run = self._run(reference, start)
        part = run["speed_load"][-course[-1][1] :]
        time = settling_time(run.time[: part.size], part, speed)
        if math.isfinite(time) and abs(float(part[-1]) - speed) < NEAR * speed:
            return time
        return math.inf if factor > 1 else self._settling(course, start, speed, LONGER)

    def _run(self, reference: Array, start: list[float] | None) -> Recording:
        """One simulation with the law's input checks."""
        run = simulate(
            self.drivetrain, law=self.law, dt=self.law.dt, delay=self.proof.delay, state=start,
            speed_reference=reference, torque_load=np.full(reference.size, self.torque),
        )  # fmt: skip
        self.simulations += 1
        fault = f"input_fault_{self.law.name}"
        self.fired += bool(fault in run and np.any(run[fault]))
        return run
