"""Draws the rooms of the package, as the linter's layers have them: python docs/make_architecture_picture.py"""

from __future__ import annotations

import ast
import tomllib
from pathlib import Path

from matplotlib.figure import Figure

ROOT = Path(__file__).resolve().parent.parent
SOURCE = ROOT / "src" / "lostmotion"

#: Colours by what a layer is about: use, evidence, estimation and control, simulation, base (Okabe & Ito).
COLOURS = {
    "cli": "#E69F00",
    "report": "#CC79A7",
    "identification": "#56B4E9",
    "simulation": "#009E73",
    "drivetrain": "#BBBBBB",
}


def layers() -> list[list[str]]:
    contracts = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["importlinter"]["contracts"]
    return [layer.split(" | ") for layer in contracts[0]["layers"]]


def purpose(room: str, length: int) -> str:
    """What the room's docstring says first, without the room's own name, cut at a comma where it is too long."""
    place = SOURCE / room / "__init__.py"
    text = (place if place.exists() else SOURCE / f"{room}.py").read_text()
    sentence = (ast.get_docstring(ast.parse(text)) or "").split("\n")[0].removesuffix(".")
    name, _, rest = sentence.partition(": ")
    sentence = rest if rest and len(name.split()) < 3 else sentence
    while len(sentence) > length:
        shorter = max(sentence.rfind(mark) for mark in (",", ";", ":", " – "))
        sentence = sentence[:shorter] if shorter > 0 else sentence[: length - 1].rsplit(" ", 1)[0] + " …"
    return sentence


def main() -> None:
    rows = layers()
    figure = Figure(figsize=(10.0, 0.62 * len(rows) + 0.3))
    axes = figure.add_axes((0.01, 0.01, 0.98, 0.98))
    axes.set_axis_off()
    axes.set_xlim(0.0, 1.0)
    axes.set_ylim(len(rows), 0.0)
    colour = "white"
    for y, rooms in enumerate(rows):
        colour = next((COLOURS[room] for room in rooms if room in COLOURS), colour)
        width = 1.0 / len(rooms)
        for i, room in enumerate(rooms):
            axes.add_patch(_box(i * width, y, width, colour))
            axes.text((i + 0.5) * width, y + 0.33, room, ha="center", va="center", weight="bold", size=10)
            axes.text(
                (i + 0.5) * width,
                y + 0.68,
                purpose(room, 118 // len(rooms)),
                ha="center",
                va="center",
                size=7.5,
            )
    figure.savefig(Path(__file__).parent / "images" / "architecture.png", dpi=110, facecolor="white")


def _box(x: float, y: float, width: float, colour: str):
    from matplotlib.patches import FancyBboxPatch

    return FancyBboxPatch(
        (x + 0.006, y + 0.08), width - 0.012, 0.84, boxstyle="round,pad=0,rounding_size=0.01", facecolor=colour,
        alpha=0.35, edgecolor="0.3", mutation_aspect=len(layers()) / 6.0,
    )  # fmt: skip


if __name__ == "__main__":
    main()
