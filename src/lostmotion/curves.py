"""Static piecewise-linear curves: the dead zone, the saturation, and any curve given by its points."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .argument_checks import checks_arguments
from .errors import InvalidInput, within
from .plain_data import entries, number, numbers, shown, table


@checks_arguments
@dataclass(frozen=True)
class PiecewiseLinear:
    """A continuous static curve w(z), given by its points and the slopes beyond the first and the last.

    Parameters
    ----------
    points : tuple of (z, w)
        At least one point, strictly increasing in z.
    slope_left, slope_right : float
        Slope dw/dz left of the first and right of the last point.

    Raises
    ------
    InvalidInput
        If there is no point, a value is no finite number, z does not increase strictly, or a segment is too steep for
        a float.
    """

    points: tuple[tuple[float, float], ...]
    slope_left: float = 0.0
    slope_right: float = 0.0

    def __post_init__(self) -> None:
        where = "PiecewiseLinear.points"
        try:
            points = tuple((number(where, z), number(where, w)) for z, w in self.points)
        except (TypeError, ValueError) as error:
            if isinstance(error, InvalidInput):
                raise
            raise InvalidInput(where, shown(self.points), "pairs (z, w) of numbers", "Give pairs.") from None
        object.__setattr__(self, "points", points)
        for name in ("slope_left", "slope_right"):
            object.__setattr__(self, name, number(f"PiecewiseLinear.{name}", getattr(self, name)))
        if not points:
            raise InvalidInput(
                "PiecewiseLinear.points", "no point", "at least one point (z, w)", "Add a point."
            )
        if any(b[0] <= a[0] for a, b in zip(points, points[1:], strict=False)):
            raise InvalidInput(
                "PiecewiseLinear.points",
                shown(points),
                "strictly increasing z",
                "Sort the points, drop doubles.",
            )
        if not all(math.isfinite(slope) for slope in self.slopes):
            raise InvalidInput(
                where, shown(points), "segments whose slope is a finite number", "Move the points apart."
            )

    @property
    def slopes(self) -> tuple[float, ...]:
        """Slope of every segment from left to right: one more than there are points."""
        inner = [
            (w1 - w0) / (z1 - z0) for (z0, w0), (z1, w1) in zip(self.points, self.points[1:], strict=False)
        ]
        return (self.slope_left, *inner, self.slope_right)

    def to_dict(self) -> dict[str, Any]:
        """Plain lists and numbers: ``from_dict`` gives back the very same curve."""
        return {
            "points": [list(point) for point in self.points],
            "slope_left": self.slope_left,
            "slope_right": self.slope_right,
        }

    @classmethod
    def from_dict(cls, data: object, where: str = "PiecewiseLinear.from_dict") -> PiecewiseLinear:
        """The curve that ``to_dict`` wrote; raises ``InvalidInput`` for anything else."""
        content: Mapping[str, Any] = table(where, data, ("points", "slope_left", "slope_right"))
        count = len(entries(f"{where}, points", content["points"]))
        points = numbers(f"{where}, points", content["points"], (count, 2))
        with within(where):
            return cls(tuple(map(tuple, points.tolist())), content["slope_left"], content["slope_right"])

    def __call__(self, z: ArrayLike) -> NDArray[np.float64]:
        """The curve at z, elementwise; any shape."""
        z = np.asarray(z, dtype=float)
        z_points = np.array([p[0] for p in self.points])
        w_points = np.array([p[1] for p in self.points])
        slopes = np.array(self.slopes)
        # Segment i lies right of point i-1; the first segment is measured from the first point.
        segment = np.searchsorted(z_points, z, side="right")
        anchor = np.maximum(segment - 1, 0)
        return np.asarray(w_points[anchor] + slopes[segment] * (z - z_points[anchor]))


@checks_arguments
def dead_zone(half_width: float, slope: float = 1.0) -> PiecewiseLinear:
    """slope · dz(z), dz(z) = z − clip(z, −half_width, half_width); a half width of 0 gives the straight line."""
    if number("dead_zone.half_width", half_width) < 0.0:
        raise InvalidInput(
            "dead_zone.half_width", f"{half_width!r}", "zero or more", "Give backlash/2 in rad."
        )
    if half_width == 0.0:
        return PiecewiseLinear(((0.0, 0.0),), slope, slope)
    return PiecewiseLinear(((-half_width, 0.0), (half_width, 0.0)), slope, slope)


@checks_arguments
def saturation(limit: float, slope: float = 1.0) -> PiecewiseLinear:
    """clip(slope · z, −limit, limit); a limit of 0 gives zero."""
    if number("saturation.limit", limit) < 0.0 or number("saturation.slope", slope) <= 0.0:
        raise InvalidInput(
            "saturation", f"limit {limit!r}, slope {slope!r}", "limit ≥ 0 and slope > 0", "Check the signs."
        )
    if limit == 0.0:
        return PiecewiseLinear(((0.0, 0.0),), 0.0, 0.0)
    return PiecewiseLinear(((-limit / slope, -limit), (limit / slope, limit)), 0.0, 0.0)
