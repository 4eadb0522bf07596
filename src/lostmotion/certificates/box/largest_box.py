"""The largest tolerance that is proved within a given time."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem
from ..continuous.continuous_law import ContinuousLaw
from .box_proof import BoxProof, around, prove_box
from .cell import PARAMETERS

#: First tolerance that is tried, and how near the largest one must be found, both as shares, whole percents (option).
FIRST, NEAR = 0.05, 0.01
#: Largest tolerance that is tried (option).
WIDEST = 0.9
#: Share of the time left that one tolerance may take (option: the search never hangs on one that is too wide).
PATIENCE = 0.5


class Attempt(NamedTuple):
    """One tolerance (a share), whether it was proved, in how many cells and s, and why not."""

    half_width: float
    proved: bool
    cells: int
    seconds: float
    reason: str


@dataclass(frozen=True, eq=False)
class LargestBox:
    """The widest box that was proved, None if there is none, and all attempts in their order."""

    proof: BoxProof | None
    attempts: tuple[Attempt, ...]

    @property
    def half_width(self) -> float:
        """Its tolerance as a share; 0 if nothing is proved."""
        return max((attempt.half_width for attempt in self.attempts if attempt.proved), default=0.0)


@checks_arguments
def largest_box(
    drivetrain: Drivetrain,
    law: DiscreteSystem | ContinuousLaw,
    parameters: Sequence[str] = PARAMETERS[:4],
    *,
    seconds: float = 600.0,
    **options: Any,
) -> LargestBox:
    """Double the tolerance while it is proved, then halve what is left, until the time is over.

    Parameters
    ----------
    drivetrain, law
        See ``prove_box``.
    parameters : sequence of str
        See ``around``.
    seconds : float, s
        Wall time. A tolerance that takes more than half of what is left of it counts as not proved.
    **options
        Further ones of ``prove_box``.

    Raises
    ------
    InvalidInput
        For no time; else as ``prove_box``.
    """
    if not seconds > 0.0:
        raise InvalidInput("largest_box.seconds", repr(seconds), "a time above 0", "600 is ten minutes.")
    end = time.monotonic() + seconds
    best: BoxProof | None = None
    attempts: list[Attempt] = []
    proved, failed, half_width = 0.0, WIDEST, FIRST
    while failed - proved > 1.5 * NEAR and ((left := end - time.monotonic()) > 0.0 or not attempts):
        start = time.monotonic()
        found = _tried(drivetrain, law, around(half_width, parameters), start + PATIENCE * left, options)
        spent = time.monotonic() - start
        reason = "it took too long" if found.reason == "interrupted" else found.reason
        attempts.append(Attempt(half_width, found.proved, found.cells, spent, reason))
        if found.proved:
            best, proved = found, half_width
        else:
            failed = half_width
        middle = 2.0 * proved if failed == WIDEST and proved else 0.5 * (proved + failed)
        half_width = round(min(middle, WIDEST), 2)
    return LargestBox(best, tuple(attempts))


def _tried(drivetrain: Drivetrain, law: Any, box: Any, end: float, options: dict[str, Any]) -> BoxProof:
    """A proof that is given up at a time (s of the monotonic clock), between two cells."""

    def progress(share: float, text: str) -> None:
        if time.monotonic() > end:
            raise KeyboardInterrupt

    return prove_box(drivetrain, law, box, progress=progress, **options)
