"""The figures as files: SVG and PDF for print, PNG to look at; the same bytes in every run."""

from __future__ import annotations

from pathlib import Path

from ..report.images import svg_of
from .figures import PaperFigure, styled

#: Pixels per inch of a PNG (option: sharp at twice the column's width).
DPI = 200


def save_figure(figure: PaperFigure, folder: Path) -> str:
    """Write the three files; returns the SVG, which the page shows."""
    with styled():
        svg = svg_of(figure.image)
        (folder / f"{figure.name}.svg").write_bytes(svg)
        # The places that were found for the SVG hold for the others: finding them again takes half of the time.
        figure.image.set_layout_engine("none")
        # Without its date a PDF is the same in every run.
        figure.image.savefig(folder / f"{figure.name}.pdf", metadata={"CreationDate": None})
        figure.image.savefig(folder / f"{figure.name}.png", dpi=DPI, facecolor="white")
    return svg.decode()
