"""A race of descents from many starts: all get a few steps, the lowest get more of them."""

from __future__ import annotations

from collections.abc import Sequence

from ..filter import ContactFilter
from ..likelihood import Box, Candidate, cost_of, rates_first, side_by_side

#: Steps of each round, and how many are in it at most (numerics: a start shows after two steps whether it leads on).
FIRST, NEXT = 2, ((60, 3), (20, 6))
#: Part of the rows that tell the rates of all starts, and rows at least (numerics: they are sought by threes).
RATES, FEWEST = 4, 500


def race(begun: Sequence[Candidate], rows: ContactFilter, box: Box) -> list[Candidate]:
    """Ends of the descents that get furthest over some rows, the lowest first.

    A start is not judged where it lies: what it does not have (which end has the friction, a load torque) makes more of
    its cost than what it has.
    """

    def lowest(found: Sequence[Candidate], steps: int, few: ContactFilter) -> list[Candidate]:
        ends = side_by_side(lambda one: rates_first(one, box, steps, one.over(few)), found)
        return sorted(ends, key=cost_of)

    found = lowest(begun, FIRST, rows.liveliest(max(FEWEST, rows.rows // RATES)))
    for most, steps in NEXT:
        found = lowest(found[:most], steps, rows)
    return found
