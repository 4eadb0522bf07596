"""Sectors of the curves around their equilibria, over a range of speeds and load torques."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any, NamedTuple

from .equilibrium import Equilibrium
from .lure import LureLoop
from .rational import Matrix
from .static_curves import StaticCurve

#: Share of (w₁ − w₂)² that the cross condition gives up where two copies rest apart: so much per ε/room, and at most
#: (numerics: any share above 0 is sound).
SLACK, LARGEST_SLACK = 64, Fraction(1, 4)


@dataclass(frozen=True)
class Sector:
    """(w − low·z)(high·z − w) ≥ 0 for the deviations z, w of a curve's argument and value."""

    low: Fraction
    high: Fraction


class Copies(NamedTuple):
    """Two arguments of one rising curve: (w₁ − w₂)(steepest·(z₁ − z₂) − (1 − slack)(w₁ − w₂)) + loss·(z₁² + z₂²) ≥ 0.

    ``first`` and ``second`` number the plant's curves, then the law's; the numbers are fractions or floats.
    """

    first: int
    second: int
    steepest: Any
    slack: Any
    loss: Any


def sectors(loop: LureLoop, corners: Sequence[Equilibrium]) -> tuple[Sector, ...] | None:
    """The sector of each curve, the same for every equilibrium between the corners; None if there is none.

    docs/proofs.md, equation 6: on one segment the equilibrium is affine in speed and load torque, and each chord
    slope monotone in it.
    """
    if len({corner.segments for corner in corners}) != 1:
        return None
    found = []
    for i, curve in enumerate((*loop.plant_curves, *loop.law_curves)):
        each = [curve.sector(corner.arguments[i]) for corner in corners]
        found.append(Sector(min(low for low, _ in each), max(high for _, high in each)))
    return tuple(found)


def copies(loop: LureLoop, corners: Sequence[Equilibrium]) -> tuple[Copies, ...]:
    """All pairs of arguments of one rising curve, plant's and law's, for which the cross condition holds."""
    curves = (*loop.plant_curves, *loop.law_curves)
    found = []
    for j, second in enumerate(curves):
        for i, first in enumerate(curves[:j]):
            if first == second and first.rises and first.steepest != 0:
                apart = _apart(first, i, j, corners)
                if apart is not None:
                    found.append(_copies(first, i, j, apart))
    return tuple(found)


def _copies(curve: StaticCurve, i: int, j: int, apart: Fraction) -> Copies:
    """Equations 8 and 9, with ε/room; a jump has no largest slope: the product of both differences is left."""
    steepest, jump = (Fraction(1), 1) if curve.steepest is None else (curve.steepest, 0)
    slack = min(LARGEST_SLACK, SLACK * apart)
    loss = (steepest * apart) ** 2 / (4 * slack) if apart else apart
    return Copies(i, j, steepest, slack + jump, loss)


def _apart(curve: StaticCurve, i: int, j: int, corners: Sequence[Equilibrium]) -> Fraction | None:
    """ε/room, where two copies rest at arguments ε apart, on a flat segment with room to its ends; else None.

    docs/proofs.md, equation 9.
    """
    apart = [abs(corner.arguments[i] - corner.arguments[j]) for corner in corners]
    if not any(apart):
        return Fraction(0)
    segments = {curve.segment(corner.arguments[k]) for corner in corners for k in (i, j)}
    segment = segments.pop()
    if segments or segment is None or curve.slopes[segment] != 0:
        return None
    rooms = [min(curve.room(corner.arguments[k]) for k in (i, j)) for corner in corners]
    return max(a / room for a, room in zip(apart, rooms, strict=True))


@dataclass(frozen=True, eq=False)
class Region:
    """Where the sector of the torque limit, a law curve, holds: within ``reach`` of its argument at rest.

    ``start`` (n,): the deviation of the state after the largest step, from which V must stay there.
    """

    limit: int
    reach: Fraction
    start: Matrix


def limit_region(
    loop: LureLoop, corners: Sequence[Equilibrium], of: Sequence[Sector], step: Fraction, share: Fraction
) -> tuple[Region, tuple[Sector, ...]]:
    """The region in which the limit keeps ``share`` of its slope, and the sectors with that of the limit changed.

    docs/proofs.md, equation 16. The first two corners are the slowest and the fastest equilibrium at one load
    torque; ``step`` of the load speed in rad/s.
    """
    assert loop.limit is not None
    place = len(loop.plant_curves) + loop.limit
    slow, fast = corners[:2]
    room = min(loop.law_curves[loop.limit].room(corner.arguments[place]) for corner in corners)
    changed = list(of)
    changed[place] = Sector(share * of[place].high, of[place].high)
    per_speed = (fast.state - slow.state) / (fast.speed - slow.speed)
    return Region(loop.limit, room / share, per_speed * step), tuple(changed)
