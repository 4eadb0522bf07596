"""What an inertia that the model does not have may change of the values, as far as the recording leaves it open."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ..estimate import WITHOUT_GAP, distance
from ..likelihood import Box, Candidate, side_by_side
from ..parameter_vector import pole_of
from ..selection import ELSEWHERE
from ..structures.shaft_inertias import Place, has_fourth, placed, without_last_inertia
from .score_test import change_by, room_by_score

Array = NDArray[np.float64]

#: An inertia that is not seen has its mode at the first of these multiples of the torsional frequency, or above
#: (calibrated on development drives 2050 to 2890, 2026-11-26). Its effect is computed at each (numerics: it goes with
#: the inverse square of the multiple; far off it is linear, near by it is well above what else changes).
HIDDEN_MODES = (8.0, 16.0, 32.0)
#: Parts of its side's inertia that it may have (numerics: a light one and a heavy one).
SHARES = (0.1, 0.5)
#: Part of the compliance at the gap that it may have at most (numerics: no shaft beyond a light inertia is stiff).
MOST_COMPLIANCE = 0.5
#: Damping ratio of its mode (numerics: it does not ring).
DAMPED = 0.5
#: How much of what a third inertia on the other side changes belongs to the intervals (calibrated on 45 development
#: drives 3460 to 3580, 2026-11-26: with 0, 0.3 and 1 89, 92 and 94 % of 223 values hold; half widths are 6.8, 7.8 and
#: 11.1 times the error).
OTHER_SIDE = 0.3
#: Where there is a third inertia there may be several more: their room over that of one (calibrated on 119 development
#: drives of 3460 to 3899, 2026-11-27: with 1.5, 3 and 5 96.2, 96.8 and 97.5 % of some 440 values hold, 86, 88 and 90 %
#: with five masses, half widths are 7.4, 7.9 and 8.6 times the error; on test drives 1.5 held 75 % with five masses).
SEVERAL = 3.0


def room_for_further_inertias(best: Candidate, others: Sequence[Candidate], box: Box) -> Array:
    """(8,) half widths, in the logarithm, for inertias that the model does not have.

    With a fourth inertia, a fifth one changes the values by as much for what is left of the innovations as the fourth
    did for what it took away, and by no more than that: it is taken out, and the others are fitted again. Where there
    are inertias on both sides of the gap, a third one on the other side, among ``others``, does about as well, and
    tells slightly other values. Without a fourth, see ``of_another``.
    """
    if Place.of(best) is None:
        return of_another(best)
    if has_fourth(best):
        return SEVERAL * _as_far_as_left(best, without_last_inertia(best, box))
    room = of_another(best)
    behind = best.flt.behind
    opposite = [
        one
        for one in others
        if Place.of(one) and not has_fourth(one) and one.flt.behind is not behind and _near(one, best)
    ]
    if opposite:
        beside = OTHER_SIDE * _as_far_as_left(best, min(opposite, key=lambda one: one.cost))
        # Of what only one of them has a value there is nothing to compare.
        room = np.hypot(room, np.where(np.isfinite(beside), beside, 0.0))
    return SEVERAL * room


def _near(one: Candidate, best: Candidate) -> bool:
    """Whether it has about the same inertias and stiffness: elsewhere, what it tells otherwise has other reasons."""
    return bool(np.all(distance(one, best)[WITHOUT_GAP] < ELSEWHERE))


def _as_far_as_left(best: Candidate, other: Candidate) -> Array:
    """(8,) distance to a worse candidate, for what is left of the innovations instead of what it predicts worse."""
    # Innovations of e^cost times the noise: both parts of their squares.
    left, worse = np.expm1(2.0 * abs(best.cost)), np.exp(2.0 * other.cost) - np.exp(2.0 * best.cost)
    part = np.sqrt(left / worse) if worse > left else 1.0
    return np.asarray(part * distance(other, best))


def of_another(best: Candidate) -> Array:
    """(8,) largest change of the values by a third inertia at either end, light or heavy; by a fourth beside a third.

    A part of 1 has its mode at the lowest of ``HIDDEN_MODES``.
    """
    return room_by_score(best, [(effect, None) for effect in effects(best)], 1.0)


def effects(best: Candidate) -> list[Array]:
    """Change of the weighted innovations by another inertia of part 1, as each of its places and modes says."""

    def effect(where: tuple[float, float, bool]) -> Array:
        flt, theta = placed(best, stiff_place(best, *where), best.flt)
        return change_by(flt.run(theta), best.run) * (where[0] / HIDDEN_MODES[0]) ** 2

    return side_by_side(effect, list(product(HIDDEN_MODES, SHARES, (False, True))))


def stiff_place(best: Candidate, mode: float, share: float, behind: bool) -> Place:
    """A third inertia, or a fourth, whose mode is at a multiple of the torsional frequency."""
    values, third = best.values, Place.of(best)
    motor, load = values["inertia_motor"], values["inertia_load"]
    divided, rest = load if behind else motor, 1.0
    if third is not None:
        rest = 1.0 - third.compliance
        divided *= third.share if behind == third.behind else 1.0
    # The mode of both parts of what it divides on a stiff shaft, over the torsional one.
    compliance = motor * load / (motor + load) / (share * (1.0 - share) * divided * mode**2) / rest
    damped = 2.0 * np.pi * mode * pole_of(best.theta) * values["damping"] / values["stiffness"]
    loss = 2.0 * DAMPED / damped if damped > 0.0 else 1.0
    return Place(share, min(compliance, MOST_COMPLIANCE), loss, behind, fourth=third is not None)
