"""Without a gap no shaft is the joint: the softest one divides motor and load."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..likelihood import Box, Candidate, polish
from ..likelihood_ratio import alike
from ..parameter_vector import INDEX
from .no_gap import SHOWN, bare
from .shaft_inertias import Place, has_fourth


@dataclass(frozen=True)
class Chain:
    """Three or four inertias from motor to load (kg m2), the shafts' parts of the compliance, their damping over
    stiffness in any unit, and the shaft that divides motor and load."""

    inertias: tuple[float, ...]
    compliances: tuple[float, ...]
    losses: tuple[float, ...]
    joint: int

    @classmethod
    def of(cls, candidate: Candidate) -> Chain | None:
        """None of two masses."""
        place, values, behind = Place.of(candidate), candidate.values, candidate.flt.fourth_behind
        if place is None:
            return None
        ends = [values["inertia_motor"], values["inertia_load"]]
        # Of either side what hangs on its end: inertia, compliance, loss, the outer one first.
        sides: list[list[tuple[float, float, float]]] = [[], []]
        third, rest = place.share * ends[place.behind], 1.0 - place.compliance
        ends[place.behind] -= third
        sides[place.behind].append((third, place.compliance, place.loss))
        if has_fourth(candidate):
            share, compliance, loss = (values[f"{name}_fourth"] for name in ("share", "compliance", "loss"))
            if behind == place.behind:
                sides[behind] = [((1.0 - share) * third, place.compliance, place.loss)]
                fourth = share * third
            else:
                fourth = share * ends[behind]
                ends[behind] -= fourth
            sides[behind].append((fourth, compliance * rest, loss))
            rest *= 1.0 - compliance
        before, after = sides[0], sides[1][::-1]
        parts = [
            *((part, loss) for _, part, loss in before),
            (rest, 1.0),
            *((part, loss) for _, part, loss in after),
        ]
        inertias = (ends[0], *(one[0] for one in before), *(one[0] for one in after), ends[1])
        compliances, losses = zip(*parts, strict=True)
        return cls(inertias, compliances, losses, len(before))

    def divided_at(self, joint: int, candidate: Candidate) -> Candidate:
        """The candidate, which is the same chain, with another shaft between motor and load; its cost is not known."""
        motor, load = sum(self.inertias[: joint + 1]), sum(self.inertias[joint + 1 :])
        values, loss = candidate.values, self.losses[joint]
        was = 1.0 / values["inertia_motor"] + 1.0 / values["inertia_load"]
        changed = {
            "inertia_motor": motor,
            "inertia_load": load,
            "stiffness": values["stiffness"] * was / (1.0 / motor + 1.0 / load),
        }
        # From either end inwards: the third is the outer one, before the gap if there is one on either side.
        before = [(i, 0) for i in range(joint)]
        after = [(i, 1) for i in range(len(self.compliances) - 1, joint, -1)]
        left, rest, flt = [motor, load], 1.0, candidate.flt
        for name, (shaft, side) in zip(("", "_fourth"), (*before, *after), strict=False):
            # What the end or the third keeps, and what goes on towards the gap.
            kept = self.inertias[shaft + side]
            changed |= {
                f"share{name}": (left[side] - kept) / left[side],
                f"compliance{name}": self.compliances[shaft] / rest,
                f"loss{name}": self.losses[shaft] / loss,
            }
            left[side] -= kept
            rest -= self.compliances[shaft]
            flt = replace(flt, fourth_behind=bool(side)) if name else replace(flt, behind=bool(side))
        return replace(candidate, theta=flt.changed(candidate.theta, **changed), flt=flt, cost=np.inf)


def split_at_the_softest_shaft(candidate: Candidate, box: Box) -> Candidate:
    """The same inertias with motor and load divided at the softest shaft, where no gap shows which is the joint.

    Without a gap, a third inertia before it and one behind it are two names for one drive.
    """
    chain = Chain.of(candidate)
    gap = INDEX["backlash"]
    moved = {INDEX[name] for name in ("inertia_motor", "inertia_load", "stiffness")}
    moved |= {gap} if np.isfinite(candidate.theta[gap]) else set()
    if chain is None or not moved <= set(candidate.free):
        return candidate
    softest = int(np.argmax(chain.compliances))
    if softest == chain.joint:
        return candidate
    other = chain.divided_at(softest, bare(candidate))
    other = replace(other, cost=other.flt.run(other.theta).cost)
    if other.cost > candidate.cost + SHOWN:
        return candidate
    # The unknown torque of a further inertia is that of its side: the rates are others.
    other = polish(other, other.flt, box)
    return other if alike(other, candidate, 0.0) else candidate
