"""Figures as data inside the page: SVG where it is small, PNG otherwise."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: A figure whose SVG is larger than this becomes a PNG (option: ten of them stay below 4 MB; the figures of a run take
#: 25 to 280 kB). A PNG costs a second drawing, which takes longer than the first.
MAX_SVG_BYTES = 300_000
#: Of a PNG, pixels per inch (option).
DPI = 150

#: Sections of the page that can have figures.
SECTIONS = ("recording", "parameters", "fits", "observers", "controllers", "stability", "other")


@dataclass(frozen=True, eq=False)
class ReportFigure:
    """A figure of the report.

    Parameters
    ----------
    title, caption : str
    image : matplotlib Figure, or str
        A string is taken as the text of an SVG.
    section : {"recording", "parameters", "fits", "observers", "controllers", "stability", "other"}
        Section of the page.
    """

    title: str
    caption: str
    image: Figure | str
    section: str = "other"

    def draw(self) -> None:
        """Draw it now: the page, which is written when all else is known, then takes what is drawn."""
        _ = self.uri

    @cached_property
    def uri(self) -> str:
        """The figure, drawn once, as a ``data:`` address: it cannot load or run anything."""
        if isinstance(self.image, str):
            return _uri("svg+xml", self.image.encode())
        svg = svg_of(self.image)
        if len(svg) <= MAX_SVG_BYTES:
            return _uri("svg+xml", svg)
        stream = io.BytesIO()
        self.image.savefig(stream, format="png", dpi=DPI, facecolor="white")
        return _uri("png", stream.getvalue())


def svg_of(figure: Figure) -> bytes:
    """The figure as SVG, the same bytes in every run."""
    from matplotlib import rc_context
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    stream, canvas = io.BytesIO(), figure.canvas
    # The salt makes the names inside the SVG the same in every run; text stays text. Both settings end with the block.
    with rc_context({"svg.hashsalt": "lostmotion", "svg.fonttype": "none"}):
        # ``savefig`` would draw everything twice, the first time for a layout that is found in the second as well.
        FigureCanvasSVG(figure).print_svg(stream, metadata={"Date": None})
    figure.set_canvas(canvas)
    return stream.getvalue()


def _uri(kind: str, data: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
