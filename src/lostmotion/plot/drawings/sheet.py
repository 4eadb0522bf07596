"""A sheet of paper in points: what is put on it decides its size, so that text is as large on every drawing."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

from ..style import ESTIMATED

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Point = tuple[float, float]

#: Colours: lines and text, quiet text, fills of blocks; the accent is that of estimates everywhere.
INK, QUIET, FILL, ACCENT = "#222222", "#5a5a5a", "#eef3f8", ESTIMATED["color"]
#: Sizes of text in points (option): names, values and small print.
LARGE, NORMAL, SMALL = 11.0, 9.0, 8.0
#: Height of a line of text over its size, and the free edge of a sheet in points (option).
LINE, MARGIN = 1.3, 14.0


@cache
def text_width(text: str, size: float, weight: str = "normal") -> float:
    """Width of one line of text in points."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    return float(
        text_to_path.get_text_width_height_descent(text, FontProperties(size=size, weight=weight), False)[0]
    )


class Sheet:
    """Lines, boxes and text in points, y upwards; ``figure`` cuts the sheet to what is on it."""

    def __init__(self) -> None:
        from matplotlib.figure import Figure

        self._figure = Figure()
        self._axes = self._figure.add_axes((0.0, 0.0, 1.0, 1.0))
        self._axes.set_axis_off()
        self._x: list[float] = []
        self._y: list[float] = []

    def _cover(self, *points: Point) -> None:
        for x, y in points:
            self._x.append(x)
            self._y.append(y)

    @property
    def left(self) -> float:
        return min(self._x)

    @property
    def right(self) -> float:
        return max(self._x)

    @property
    def bottom(self) -> float:
        return min(self._y)

    @property
    def top(self) -> float:
        return max(self._y)

    def line(
        self, *points: Point, width: float = 1.2, color: str = INK, arrow: bool = False,
        zorder: float = 2.0, **style: Any,
    ) -> None:  # fmt: skip
        """A polyline; with ``arrow`` it ends in a head."""
        from matplotlib.patches import FancyArrowPatch
        from matplotlib.path import Path

        self._cover(*points)
        if not arrow:
            self._axes.plot(*zip(*points, strict=True), color=color, linewidth=width, zorder=zorder, **style)
            return
        head = FancyArrowPatch(
            path=Path(list(points)), arrowstyle="-|>,head_length=5,head_width=2.4", mutation_scale=1.0,
            color=color, linewidth=width, zorder=zorder, joinstyle="miter", capstyle="butt", **style,
        )  # fmt: skip
        self._axes.add_patch(head)

    def box(
        self, x: float, y: float, width: float, height: float, *, round_by: float = 0.0, **style: Any
    ) -> None:
        """A rectangle around the point (x, y)."""
        from matplotlib.patches import FancyBboxPatch

        low = (x - 0.5 * width, y - 0.5 * height)
        self._cover(low, (x + 0.5 * width, y + 0.5 * height))
        look = {"facecolor": FILL, "edgecolor": INK, "linewidth": 1.1, "zorder": 3.0, **style}
        shape = f"round,pad=0,rounding_size={round_by}" if round_by else "square,pad=0"
        self._axes.add_patch(FancyBboxPatch(low, width, height, boxstyle=shape, **look))

    def circle(self, x: float, y: float, radius: float, **style: Any) -> None:
        from matplotlib.patches import Circle

        self._cover((x - radius, y - radius), (x + radius, y + radius))
        look = {"facecolor": "white", "edgecolor": INK, "linewidth": 1.1, "zorder": 3.0, **style}
        self._axes.add_patch(Circle((x, y), radius, **look))

    def text(
        self, x: float, y: float, text: str, *, size: float = NORMAL, ha: str = "center", va: str = "center",
        color: str = INK, weight: str = "normal",
    ) -> None:  # fmt: skip
        """One line of text."""
        width, height = text_width(text, size, weight), LINE * size
        left = x - {"left": 0.0, "center": 0.5, "right": 1.0}[ha] * width
        low = y - {"bottom": 0.0, "center": 0.5, "top": 1.0}[va] * height
        self._cover((left, low), (left + width, low + height))
        self._axes.text(x, y, text, fontsize=size, ha=ha, va=va, color=color, fontweight=weight, zorder=4.0)

    def column(
        self, x: float, top: float, lines: Sequence[str], *, size: float = NORMAL, **style: Any
    ) -> float:
        """Lines of text one below the other from ``top`` on; the height that they take."""
        for i, line in enumerate(lines):
            self.text(x, top - (i + 0.5) * LINE * size, line, size=size, **style)
        return len(lines) * LINE * size

    def figure(self, title: str) -> Figure:
        """The figure, with a title above at the left."""
        self.text(
            self.left, self.top + MARGIN, title, size=LARGE + 1.0, ha="left", va="bottom", weight="bold"
        )
        x, y = (self.left - MARGIN, self.right + MARGIN), (self.bottom - MARGIN, self.top + MARGIN)
        self._figure.set_size_inches((x[1] - x[0]) / 72.0, (y[1] - y[0]) / 72.0)
        self._axes.set(xlim=x, ylim=y)
        return self._figure
