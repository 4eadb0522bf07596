"""Static curves as small pictures with their names: dead zone, saturation, positive part."""

from __future__ import annotations

import numpy as np

from ...curves import PiecewiseLinear
from ...display.numbers import given
from .sheet import ACCENT, LINE, QUIET, SMALL, Sheet, text_width

#: Width and height of a picture in points, and how far beyond its outermost corner a curve is drawn (option).
WIDTH, HEIGHT, BEYOND = 38.0, 30.0, 1.8
#: Free room around a picture with its caption, and between them, points (option).
AROUND, BETWEEN = 6.0, 4.0


def kind(curve: PiecewiseLinear) -> tuple[str, str]:
    """What the field calls a curve, and its numbers in SI."""
    (z, w), (z_end, w_end) = curve.points[0], curve.points[-1]
    left, right, ends = curve.slope_left, curve.slope_right, len(curve.points)
    if len(set(curve.slopes)) == 1:
        return ("gain", _short(left)) if left else ("constant", _short(w))
    if ends == 2 and w == w_end == 0.0 and left == right:
        return "dead zone", f"±{_short(z_end)}" if z == -z_end else f"{_short(z)} … {_short(z_end)}"
    if ends == 1 and left == 0.0 and right > 0.0:
        return "positive part", "" if (z, w, right) == (0.0, 0.0, 1.0) else f"slope {_short(right)}"
    if left == right == 0.0:
        values = [point[1] for point in curve.points]
        low, high = min(values), max(values)
        name = "saturation" if ends == 2 else "curve"
        return name, f"±{_short(high)}" if low == -high else f"{_short(low)} … {_short(high)}"
    return "curve", f"{ends} points"


def _short(value: float) -> str:
    return given(value, "")


def captions(number: int, curve: PiecewiseLinear) -> list[str]:
    """Two lines below a picture: which curve, and its numbers."""
    name, numbers = kind(curve)
    return [f"w{number + 1} {name}", numbers]


def cell_size(curves: tuple[PiecewiseLinear, ...]) -> tuple[float, float]:
    """Width and height in points that each picture with its caption takes."""
    texts = [line for i, curve in enumerate(curves) for line in captions(i, curve)]
    wide = max([WIDTH, *(text_width(line, SMALL) for line in texts)])
    return wide + 2.0 * AROUND, HEIGHT + BETWEEN + 2.0 * LINE * SMALL + 2.0 * AROUND


def draw_icon(sheet: Sheet, curve: PiecewiseLinear, x: float, y: float) -> None:
    """The curve between thin axes, around the point (x, y), scaled to its own corners."""
    reach = BEYOND * max(abs(z) for z, _ in curve.points) or 1.0
    z = np.unique([-reach, reach, *(point[0] for point in curve.points)])
    w = curve(z)
    top = float(np.max(np.abs(w))) or 1.0
    for axis in (
        ((x - 0.5 * WIDTH, y), (x + 0.5 * WIDTH, y)),
        ((x, y - 0.5 * HEIGHT), (x, y + 0.5 * HEIGHT)),
    ):
        sheet.line(*axis, width=0.6, color=QUIET, zorder=3.5)
    drawn = [(x + 0.46 * WIDTH * a / reach, y + 0.42 * HEIGHT * b / top) for a, b in zip(z, w, strict=True)]
    sheet.line(*drawn, width=1.8, color=ACCENT, zorder=3.6)


def draw_cell(sheet: Sheet, number: int, curve: PiecewiseLinear, x: float, top: float) -> None:
    """The picture with its caption, from ``top`` downwards."""
    draw_icon(sheet, curve, x, top - AROUND - 0.5 * HEIGHT)
    sheet.column(x, top - AROUND - HEIGHT - BETWEEN, captions(number, curve), size=SMALL)
