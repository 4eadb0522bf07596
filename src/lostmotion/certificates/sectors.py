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


@dataclass(frozen=True)
class Sector:
    """(w − low·z)(high·z − w) ≥ 0 for the deviations z, w of a curve's argument and value."""

    low: Fraction
    high: Fraction


class Copies(NamedTuple):
    """Two arguments of one rising curve: (w₁ − w₂)(steepest·(z₁ − z₂) − (w₁ − w₂)) + mismatch·(z₁² + z₂²) ≥ 0.

    ``first`` and ``second`` number the plant's curves, then the law's; the numbers are fractions or floats.
    """

    first: int
    second: int
    steepest: Any
    mismatch: Any


def sectors(loop: LureLoop, corners: Sequence[Equilibrium]) -> tuple[Sector, ...] | None:
    """The sector of each curve, the same for every equilibrium between the corners; None if there is none.

    docs/stability.md, section 3: on one segment the equilibrium is affine in speed and load torque, and each chord
    slope monotone in it.
    """
    if len({corner.segments for corner in corners}) != 1:
        return None
    found = []
    for i, curve in enumerate((*loop.plant_curves, *loop.law_curves)):
        each = [curve.sector(corner.arguments[i]) for corner in corners]
        found.append(Sector(min(low for low, _ in each), max(high for _, high in each)))
    return tuple(found)


def copies(loop: LureLoop, corners: Sequence[Equilibrium], of: Sequence[Sector]) -> tuple[Copies, ...]:
    """All pairs of arguments of one rising curve without a jump, plant's and law's, for which the cross condition
    holds."""
    curves = (*loop.plant_curves, *loop.law_curves)
    found = []
    for j, second in enumerate(curves):
        for i, first in enumerate(curves[:j]):
            if first == second and first.rises and first.steepest:
                mismatch = _mismatch(first, i, j, corners, max(of[i].high, of[j].high))
                if mismatch is not None:
                    found.append(Copies(i, j, first.steepest, mismatch))
    return tuple(found)


def _mismatch(
    curve: StaticCurve, i: int, j: int, corners: Sequence[Equilibrium], high: Fraction
) -> Fraction | None:
    """What the cross condition loses because the two copies rest at arguments that differ by ε.

    docs/stability.md, equation 9: 2·steepest·high·ε/room where both rest on a flat segment with room to its ends.
    """
    apart = max(abs(corner.arguments[i] - corner.arguments[j]) for corner in corners)
    if apart == 0:
        return Fraction(0)
    for corner in corners:
        segments = {curve.segment(corner.arguments[k]) for k in (i, j)}
        segment = segments.pop()
        if segments or segment is None or curve.slopes[segment] != 0:
            return None
    room = min(curve.room(corner.arguments[k]) for corner in corners for k in (i, j))
    return 2 * (curve.steepest or Fraction(0)) * high * apart / room


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

    docs/stability.md, equation 16. The first two corners are the slowest and the fastest equilibrium at one load
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
