"""Curves of plant and law as a proof sees them: points of exact fractions, a set-valued jump included."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from ..curves import PiecewiseLinear


@dataclass(frozen=True)
class StaticCurve:
    """A static curve w(z) through points, with the slopes beyond the first and the last.

    Two points with one z are a jump: there the curve takes all values between them (Coulomb friction at rest).

    Parameters
    ----------
    points : tuple of (z, w)
        z increases, or stays for one jump.
    left, right : Fraction
        Slope before the first and after the last point.
    """

    points: tuple[tuple[Fraction, Fraction], ...]
    left: Fraction = Fraction(0)
    right: Fraction = Fraction(0)

    @property
    def slopes(self) -> tuple[Fraction | None, ...]:
        """Slope of every segment from left to right; None for a jump."""
        inner = (
            None if z1 == z0 else (w1 - w0) / (z1 - z0)
            for (z0, w0), (z1, w1) in zip(self.points, self.points[1:], strict=False)
        )
        return (self.left, *inner, self.right)

    @property
    def steepest(self) -> Fraction | None:
        """Largest slope; None if the curve jumps."""
        slopes = [slope for slope in self.slopes if slope is not None]
        return None if len(slopes) < len(self.slopes) else max(slopes)

    @property
    def rises(self) -> bool:
        """Whether the curve falls nowhere."""
        jumps_up = all(
            w1 > w0 for (z0, w0), (z1, w1) in zip(self.points, self.points[1:], strict=False) if z0 == z1
        )
        return jumps_up and all(slope is None or slope >= 0 for slope in self.slopes)

    @property
    def is_odd(self) -> bool:
        mirrored = tuple((-z, -w) for z, w in reversed(self.points))
        return mirrored == self.points and self.left == self.right

    def segment(self, z: Fraction) -> int | None:
        """Number of the segment around z, as in ``slopes``; None on a point."""
        if any(z == point for point, _ in self.points):
            return None
        return sum(point < z for point, _ in self.points)

    def line(self, segment: int) -> tuple[Fraction, Fraction]:
        """Value c at 0 and slope m of the line c + m·z that a segment lies on."""
        slope = self.slopes[segment]
        if slope is None:
            raise ValueError("a jump lies on no line")
        z, w = self.points[max(segment - 1, 0)]
        return w - slope * z, slope

    def sector(self, z: Fraction) -> tuple[Fraction, Fraction]:
        """Smallest and largest chord slope (w(z + Δ) - w(z))/Δ over all Δ ≠ 0, from a z that is no point.

        Between two points, and beyond the last, the chord slope is monotone in Δ: so the chords to the points, the
        slope at z itself, and those at infinity are all that is needed.
        """
        segment = self.segment(z)
        if segment is None:
            raise ValueError("no sector from a point of the curve")
        value, slope = self.line(segment)
        here = value + slope * z
        chords = [slope, self.left, self.right, *((w - here) / (point - z) for point, w in self.points)]
        return min(chords), max(chords)

    def room(self, z: Fraction) -> Fraction:
        """Distance from z to the nearest point."""
        return min(abs(z - point) for point, _ in self.points)


def normalised(curve: PiecewiseLinear) -> tuple[Fraction, Fraction, StaticCurve]:
    """(a, b, σ) with curve(z) = a·z + b·σ(z); σ is bounded and of height 1 where the curve allows it.

    A dead zone becomes z minus a saturation, so that all copies of one gap have the same σ.
    """
    points = tuple((Fraction(z), Fraction(w)) for z, w in curve.points)
    return normalised_curve(StaticCurve(points, Fraction(curve.slope_left), Fraction(curve.slope_right)))


def normalised_curve(curve: StaticCurve) -> tuple[Fraction, Fraction, StaticCurve]:
    """``normalised`` of a curve that is given in fractions."""
    right = curve.right
    if curve.left != right:
        return Fraction(0), Fraction(1), curve
    flat = tuple((z, w - right * z) for z, w in curve.points)
    height = flat[-1][1] - flat[0][1]
    if height == 0:
        return right, Fraction(1), StaticCurve(flat)
    return right, height, StaticCurve(tuple((z, w / height) for z, w in flat))
