"""Static curves as small pictures with their names: dead zone, saturation, positive part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ...curves import PiecewiseLinear
from ...display.numbers import given
from .sheet import ACCENT, LINE, QUIET, SMALL, Sheet, text_width

#: Width and height of a picture in points, and how far beyond its outermost corner a curve is drawn (option).
WIDTH, HEIGHT, BEYOND = 38.0, 30.0, 1.8
#: Free room around a picture with its caption, and between them, points (option).
AROUND, BETWEEN = 6.0, 4.0
#: Most pictures side by side (option).
ABREAST = 4


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


@dataclass(frozen=True)
class Group:
    """Neighbouring curves that are equal: one picture for all, numbered from ``first`` to ``last``, from 1 on."""

    first: int
    last: int
    curve: PiecewiseLinear

    @property
    def captions(self) -> list[str]:
        """Two lines below the picture: which curves, and their numbers."""
        name, numbers = kind(self.curve)
        between = {0: "", 1: f", w{self.last}"}.get(self.last - self.first, f" … w{self.last}")
        return [f"w{self.first}{between} {name}", numbers]


def grouped(curves: Sequence[PiecewiseLinear]) -> list[Group]:
    found: list[Group] = []
    for number, curve in enumerate(curves, start=1):
        if found and found[-1].curve == curve:
            found[-1] = replace(found[-1], last=number)
        else:
            found.append(Group(number, number, curve))
    return found


def abreast(pictures: int) -> int:
    """How many stand side by side: rows of nearly equal length."""
    return math.ceil(pictures / math.ceil(pictures / ABREAST))


def cell_size(groups: Sequence[Group]) -> tuple[float, float]:
    """Width and height in points that each picture with its caption takes."""
    texts = [line for group in groups for line in group.captions]
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


def draw_cell(sheet: Sheet, group: Group, x: float, top: float) -> None:
    """The picture with its caption, from ``top`` downwards."""
    draw_icon(sheet, group.curve, x, top - AROUND - 0.5 * HEIGHT)
    sheet.column(x, top - AROUND - HEIGHT - BETWEEN, group.captions, size=SMALL)
