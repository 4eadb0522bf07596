"""Figures as data inside the page: SVG where it is small, PNG otherwise."""

from __future__ import annotations

import base64
import io
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: A figure whose SVG is larger than this becomes a PNG (chosen: ten of them stay below 3 MB).
MAX_SVG_BYTES = 200_000
DPI = 150

#: Places in the page at which a figure can stand.
SECTIONS = ("recording", "parameters", "fits", "observers", "controllers", "other")


@dataclass(frozen=True, eq=False)
class ReportFigure:
    """A figure of the report.

    Parameters
    ----------
    title, caption : str
    image : matplotlib Figure, or str
        A string is taken as the text of an SVG.
    section : {"recording", "parameters", "fits", "observers", "controllers", "other"}
        Where it stands in the page.
    """

    title: str
    caption: str
    image: Figure | str
    section: str = "other"

    def uri(self) -> str:
        """The figure as a ``data:`` address, so that it can neither load anything nor run anything."""
        if isinstance(self.image, str):
            return _uri("svg+xml", self.image.encode())
        svg = _render(self.image, "svg")
        if len(svg) <= MAX_SVG_BYTES:
            return _uri("svg+xml", svg)
        return _uri("png", _render(self.image, "png"))


def _render(figure: Figure, file_format: str) -> bytes:
    from matplotlib import rc_context

    stream = io.BytesIO()
    # The salt makes the names inside the SVG the same in every run; the setting ends with the block.
    with rc_context({"svg.hashsalt": "lostmotion"}):
        metadata = {"Date": None} if file_format == "svg" else None
        figure.savefig(stream, format=file_format, dpi=DPI, facecolor="white", metadata=metadata)
    return stream.getvalue()


def _uri(kind: str, data: bytes) -> str:
    return f"data:image/{kind};base64,{base64.b64encode(data).decode()}"
