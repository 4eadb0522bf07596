"""Monte Carlo beside a proof: how many variants of a drivetrain swing or settle slowly under one law."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...display.numbers import quantity
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...simulation import simulate_batch, variants
from ...systems import DiscreteSystem

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class VariantCount:
    """What became of simulated variants.

    Parameters
    ----------
    count : int
    spread : float
        Each number of the drivetrain times a factor between 1 − spread and 1 + spread.
    unsettled, slow : int
        Variants that still move at the end; that settle in more than ``SLOW`` times the time of the drivetrain itself.
    settling : float, s
        Longest settling time of those that settle.
    own_settling : float, s
        Of the drivetrain itself; inf if it does not settle.
    """

    count: int
    spread: float
    unsettled: int
    slow: int
    settling: float
    own_settling: float

    @property
    def most_unsettled(self) -> float:
        """Share of unsettled variants that is not exceeded, with 95 % confidence."""
        return upper_bound(self.unsettled, self.count)

    @property
    def most_slow(self) -> float:
        """The same for variants that are slow or unsettled."""
        return upper_bound(self.slow + self.unsettled, self.count)

    def __str__(self) -> str:
        return (
            f"{self.unsettled} of {self.count} simulated variants within ±{100.0 * self.spread:g} % do not settle: "
            f"with 95 % confidence at most {100.0 * self.most_unsettled:.2g} % of all. {self.slow} take more than "
            f"{SLOW:g} times as long as the drivetrain itself, {quantity(self.own_settling, 's')}."
        )


#: Deviation of the load speed that counts as settled, over the set-point (option: as usual for step responses).
SETTLED = 0.02
#: Settling time that counts as slow, over that of the drivetrain itself (option).
SLOW = 2.0
#: Part of the time, at its end, in which nothing may swing any more (option).
LAST = 0.2
#: Confidence of the bounds (option: as for all intervals of the package).
CONFIDENCE = 0.95
#: Variants, how far they depart from the drivetrain, and time that they have, s, by default (options: with none
#: that fails at most 1.5 % of all do; a usual tolerance; many times what a step of the paper's rig takes).
COUNT, SPREAD, DURATION = 200, 0.1, 2.0


def upper_bound(found: int, count: int) -> float:
    """One-sided upper bound of a share, of which ``found`` of ``count`` were seen: Clopper & Pearson 1934."""
    from scipy.special import betaincinv

    return 1.0 if found >= count else float(betaincinv(found + 1, count - found, CONFIDENCE))


@checks_arguments
def count_variants(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    *,
    reference: float,
    count: int = COUNT,
    spread: float = SPREAD,
    torque_load: float = 0.0,
    delay: int = 0,
    duration: float = DURATION,
    seed: int = 1,
) -> VariantCount:
    """Start every variant from rest to a constant set-point, and see whether and when it settles.

    The law stays that of the drivetrain. What is shown is a share with a confidence bound, of this one start: no proof.

    Parameters
    ----------
    drivetrain, law
        As for ``simulate``; input checks are left out.
    reference : float, rad/s
    count : int
    spread : float
        See ``simulation.variants``.
    torque_load : float, Nm
    delay : int
        Computing delay, samples.
    duration : float, s
        At its end a variant must have settled.
    seed : int

    Raises
    ------
    InvalidInput
        As ``variants`` and ``simulate_batch``; for a set-point of 0 or a time that is not positive.
    """
    if not (reference != 0.0 and duration > 2.0 * law.dt and duration / law.dt < 1e8):
        raise InvalidInput(
            "count_variants.reference, duration", f"{reference!r} rad/s, {duration!r} s",
            "a set-point other than 0 and some samples", "Give a load speed and a time in s.",
        )  # fmt: skip
    samples = round(duration / law.dt)
    given: dict[str, Any] = {"speed_reference": np.full(samples, float(reference)), "delay": delay}
    if torque_load:
        given["torque_load"] = np.full(samples, float(torque_load))
    plants = [drivetrain, *variants(drivetrain, count, spread=spread, seed=seed)]
    made = simulate_batch(
        plants, dt=law.dt, law=law.without_checks(), signals=(), quantiles=("speed_load",), workers=1, **given
    )
    times = np.array(
        [settling_time(made.quantile_time, row, abs(reference)) for row in made.samples["speed_load"]]
    )
    own, of_variants = float(times[0]), times[1:]
    settled = np.isfinite(of_variants)
    return VariantCount(
        count=count, spread=spread, unsettled=int(np.sum(~settled)),
        slow=int(np.sum(settled & (of_variants > SLOW * own))),
        settling=float(np.max(of_variants[settled], initial=0.0)), own_settling=own,
    )  # fmt: skip


def settling_time(time: Array, speed: Array, size: float) -> float:
    """When a speed has come within ``SETTLED``·size of what it has at the end; inf if it still moves, or is NaN.

    A law without integral action rests beside its set-point, so the end itself is what it settles to.
    """
    last = speed[-max(round(LAST * speed.size), 2) :]
    if not np.ptp(last) < SETTLED * size:
        return math.inf
    outside = np.flatnonzero(np.abs(speed - np.mean(last)) > SETTLED * size)
    return 0.0 if not outside.size else float(time[min(outside[-1] + 1, time.size - 1)])
