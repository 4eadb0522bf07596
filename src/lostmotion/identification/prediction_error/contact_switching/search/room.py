"""What all descents of a recording have in common: rows, starts, bounds, and when to end."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

import numpy as np
from numpy.typing import NDArray

from .....drivetrain import Drivetrain
from ...gain_schedule import Progress
from ..effort import Effort
from ..estimate import sharp
from ..filter import ContactFilter
from ..likelihood import Box, Candidate, polish, side_by_side
from ..likelihood_ratio import simplest
from ..parameter_vector import pole_of
from ..starts.from_drivetrain import RESPONSE, free_places, response_start, starts
from ..starts.slow_motion import informed
from .completeness import lacks_nothing

Array = NDArray[np.float64]

#: Torsional periods of the rows that the descents run over, and rows at least and at most (numerics: a pass over them
#: takes some 3 ms).
PERIODS, FEWEST, MOST = 80, 3000, 10_000
#: Poles up to this multiple of the nameplate's are stepped over finely enough (numerics: three either way).
POLES = 3.0
#: No parameter leaves its start by more than this factor (numerics).
FAR = 100.0
#: Part of the rows of a descent that show whether the fit stands, and rows at least (numerics: 20 torsional periods).
GLIMPSE, LEAST = 4, 2000
#: Halvings of a sample at most in a first descent: it need not place an impact finely (numerics).
COARSE = 4
#: Cost below which nothing but the sensor's noise is left (numerics: innovations 2 % larger), and that in standard
#: deviations of a cost by chance (numerics).
NOISE_ALONE, BY_CHANCE = 0.02, 3.0
#: Cost up to which a candidate that knows inertias, stiffness and backlash seems to be the drive (calibrated on
#: development drives 4024 to 4941, 2026-11-27: of 12 up to 0.1 none changed in the rest of the search, of 8 up to 0.25
#: three did).
KNOWN = 0.1
#: Steps of the model after which nothing new is begun (numerics: some 8 s on two threads of an Intel Xeon, 2026-11-27).
LONG = 80_000_000


@dataclass(frozen=True, eq=False)
class Room:
    """What all descents of a recording have in common.

    Parameters
    ----------
    flt, part : ContactFilter
        Over the whole recording, and over the rows of the descents.
    start, fitted : Drivetrain
        Nameplate; what the observer of constant gain has found.
    fixed : names that keep the nameplate's value
    intermediate : share and compliance of a third inertia, if that was found
    begun : mapping of name → θ
        From where descents start.
    box : Box
    say : callable
        Hears how far the search is.
    """

    flt: ContactFilter
    part: ContactFilter
    start: Drivetrain
    fitted: Drivetrain
    fixed: Collection[str]
    intermediate: tuple[float, float] | None
    begun: dict[str, Array]
    box: Box
    say: Progress = field(default=lambda fraction, text: None)

    @classmethod
    def of(
        cls,
        flt: ContactFilter,
        start: Drivetrain,
        fitted: Drivetrain,
        fixed: Collection[str],
        intermediate: tuple[float, float] | None,
        slow: tuple[float, float],
    ) -> Self:
        """``slow``: total inertia, kg m2, as the slow motion tells it, and the half width of its logarithm."""
        flt = replace(informed(flt, slow, start), effort=Effort())
        begun = starts(flt, start, fitted, fixed)
        box = Box.around(flt, begun["nameplate"], FAR).including(begun["fitted"], FAR)
        rows = int(np.clip(PERIODS / (flt.dt * pole_of(begun["nameplate"])), FEWEST, MOST))
        return cls(flt, flt.liveliest(rows), start, fitted, fixed, intermediate, begun, box)

    def glimpse(self) -> Self:
        """The same over a few torsional periods, with innovations that are too large divided out.

        On drives like the virtual rig, with more inertias than the model, the charge makes a right fit look poor there.
        """
        part = self.flt.liveliest(max(LEAST, self.part.rows // GLIMPSE))
        return replace(self, part=replace(part, charged=False))

    @cached_property
    def coarse(self) -> ContactFilter:
        """A few torsional periods with impacts that are placed less finely, for first descents."""
        return replace(
            self.glimpse().part, halvings=min(self.part.halvings, COARSE), charged=self.part.charged
        )

    def reached(self, step: str) -> None:
        """Says which step begins; how far that is, is what has been computed: what is to come depends on the drive."""
        self.say(float(-np.expm1(-self.flt.effort.steps / LONG)), step)

    @property
    def long(self) -> bool:
        """Whether it has taken so long that nothing new is begun."""
        return self.flt.effort.steps > LONG

    def nothing_left(self, best: Candidate) -> bool:
        """Whether nothing new is looked for: only the sensor's noise is left, or it has taken long."""
        return noise_alone(best) or self.long

    def ended(self, found: Sequence[Candidate]) -> bool:
        """The same, or little more is left where inertias, stiffness and backlash are well known."""
        best = simplest(found)
        return self.nothing_left(best) or (abs(best.cost) < KNOWN and sharp(best))

    def is_the_drive(self, best: Candidate) -> bool:
        """Whether only the sensor's noise is left beside inertias, stiffness and backlash that are well known, and
        nothing else shows."""
        return noise_alone(best) and sharp(best) and lacks_nothing(best)

    @cached_property
    def free(self) -> list[int]:
        """Places of what is fitted."""
        return free_places(self.start, self.fixed)

    def raw(self, name: str) -> Candidate:
        """A start as it is."""
        theta = self.response if name == RESPONSE else self.begun[name]
        return Candidate(name, theta, np.inf, self.part, self.free)

    @cached_property
    def response(self) -> Array:
        """The start from the frequency response, where a fit does not stand without it."""
        return response_start(self.flt, self.start, self.fixed)

    def polished(self, candidates: Sequence[Candidate], rows: ContactFilter | None = None) -> list[Candidate]:
        """Over their own rows, or over others."""
        return side_by_side(
            lambda one: polish(one, one.over(rows) if rows else one.flt, self.box), candidates
        )


def noise_alone(best: Candidate) -> bool:
    """Whether nothing but the sensor's noise is left: over many rows a small cost is no chance any more."""
    # Half the mean square of n white innovations scatters by 1/√(2·n).
    return abs(best.cost) < min(NOISE_ALONE, BY_CHANCE / np.sqrt(2.0 * best.flt.counting.size))
