"""What every block diagram of a law has: ports with names and units, blocks of matrices, sums, curves."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from ...curves import PiecewiseLinear
from ...display.numbers import digits, given
from ...recording import unit_of
from ...systems import DiscreteSystem
from .curve_icons import abreast, cell_size, draw_cell, grouped
from .sheet import INK, LARGE, LINE, NORMAL, QUIET, SMALL, Sheet, text_width

#: Width and height of a block with a matrix, radius of a sum, distance of ports, length of their arrows, in points
#: (option).
BLOCK, HIGH, SUM, PITCH, ARROW = 44.0, 32.0, 7.0, 18.0, 34.0
#: Free room between blocks in points (option).
ROOM = 24.0


#: Unit of a name that the table of signals does not have, by its first word.
_UNITS = {
    "torque": "Nm", "friction": "Nm", "coulomb": "Nm", "speed": "rad/s", "angle": "rad", "twist": "rad",
    "backlash": "rad", "inertia": "kg m²", "stiffness": "Nm/rad", "acceleration": "rad/s²", "jerk": "rad/s³",
}  # fmt: skip


def with_unit(signal: str) -> str:
    """A signal's name with its unit, where the name tells it."""
    name = signal.rpartition(".")[2]
    unit = unit_of(name) or _UNITS.get(name.partition("_")[0], "")
    if name.endswith("_rate"):
        unit += "/s"
    return f"{signal} ({unit})" if unit else signal


def single_sum(law: DiscreteSystem) -> list[float]:
    """Gain of each input where the law has no states and sums its inputs once; else nothing."""
    both = np.vstack([law.G, law.D])
    rows = np.flatnonzero(np.any(both, axis=1))
    return both[rows[0]].tolist() if rows.size == 1 and not law.states else []


def present(matrix: NDArray[np.float64]) -> bool:
    return bool(np.any(matrix))


def is_identity(matrix: NDArray[np.float64]) -> bool:
    """Whether a matrix only passes its argument on, so that a line says all."""
    return matrix.shape[0] == matrix.shape[1] and bool(np.array_equal(matrix, np.eye(len(matrix))))


def block(sheet: Sheet, x: float, y: float, name: str, matrix: NDArray[np.float64]) -> None:
    """A matrix with its name and shape, or its number where it has only one."""
    sheet.box(x, y, BLOCK, HIGH)
    rows, columns = matrix.shape
    shape = given(float(matrix[0, 0]), "") if matrix.size == 1 else f"{rows}×{columns}"
    sheet.text(x, y + 6.0, name, size=LARGE, weight="bold")
    sheet.text(x, y - 8.0, shape, size=SMALL, color=QUIET)


def through(sheet: Sheet, x: float, y: float, name: str, matrix: NDArray[np.float64]) -> float:
    """A block to the right of x, see ``gain``; where it ends."""
    return gain(sheet, x, x + ROOM + 0.5 * BLOCK, y, name, matrix)


def gain(sheet: Sheet, x: float, middle: float, y: float, name: str, matrix: NDArray[np.float64]) -> float:
    """An arrow from x to a block around ``middle``, nothing for an identity; where that ends."""
    if is_identity(matrix):
        return x
    sheet.line((x, y), (middle - 0.5 * BLOCK, y), arrow=True)
    block(sheet, middle, y, name, matrix)
    return middle + 0.5 * BLOCK


def summed(sheet: Sheet, x: float, y: float) -> None:
    """A point where all that arrives is added."""
    half = 0.55 * SUM
    sheet.circle(x, y, SUM)
    sheet.line((x - half, y), (x + half, y), width=0.9, zorder=3.5)
    sheet.line((x, y - half), (x, y + half), width=0.9, zorder=3.5)


def node(sheet: Sheet, x: float, y: float) -> None:
    """A point where a line branches."""
    sheet.circle(x, y, 2.0, facecolor=INK)


def bus(sheet: Sheet, x: float, ports: Sequence[float], *branches: float) -> None:
    """Several signals as one vector, a bar over the heights of ports and branches; one signal is a line."""
    if not ports:
        return
    places = [*ports, *branches]
    high, low = max(places), min(places)
    if len(ports) > 1:
        sheet.line((x, high + 4.0), (x, low - 4.0), width=3.0, solid_capstyle="butt")
    elif high > low:
        sheet.line((x, high), (x, low))
        if len(set(branches)) > 1:
            node(sheet, x, ports[0])


def heights(count: int, y: float = 0.0) -> list[float]:
    """Heights of so many ports around y, from the top."""
    return [y + PITCH * (0.5 * (count - 1) - i) for i in range(count)]


def draw_inputs(
    sheet: Sheet, names: Sequence[str], x: float, *, checked: Sequence[str] = (), gains: Sequence[float] = ()
) -> list[float]:
    """An arrow to x for every input, with its check and its gain where it has one; the arrows' heights."""
    places = heights(len(names))
    wide = max((text_width(digits(g), SMALL) for g in gains), default=0.0) + 10.0
    start = x - ARROW - (wide + 20.0 if gains else 0.0) - (52.0 if checked else 0.0)
    for i, (name, y) in enumerate(zip(names, places, strict=True)):
        sheet.text(start - 5.0, y, with_unit(name), ha="right")
        sheet.line((start, y), (x, y), arrow=len(names) > 1)
        if name in checked:
            sheet.box(start + 34.0, y, 36.0, 14.0, round_by=4.0)
            sheet.text(start + 34.0, y, "check", size=SMALL)
        if gains:
            at = x - 0.5 * ARROW - 0.5 * wide
            sheet.box(at, y, wide, 15.0)
            sheet.text(at, y, digits(gains[i]), size=SMALL)
    return places


def draw_outputs(sheet: Sheet, names: Sequence[str], x: float) -> list[float]:
    """An arrow from x for every output; the arrows' heights."""
    places = heights(len(names))
    for name, y in zip(names, places, strict=True):
        sheet.line((x, y), (x + ARROW, y), arrow=True)
        sheet.text(x + ARROW + 5.0, y, with_unit(name), ha="left")
    return places


def curves_size(curves: Sequence[PiecewiseLinear]) -> tuple[float, float]:
    """Width and height in points of the block with all curves."""
    groups = grouped(curves)
    wide, high = cell_size(groups)
    columns = abreast(len(groups))
    return wide * columns, high * math.ceil(len(groups) / columns)


def draw_curves(sheet: Sheet, curves: Sequence[PiecewiseLinear], x: float, y: float) -> None:
    """One block around (x, y) with a picture of every curve, row by row; equal neighbours share one."""
    wide, high = curves_size(curves)
    sheet.box(x, y, wide, high, facecolor="white")
    groups = grouped(curves)
    cell_wide, cell_high = cell_size(groups)
    for i, group in enumerate(groups):
        row, column = divmod(i, abreast(len(groups)))
        left, top = x - 0.5 * wide, y + 0.5 * high
        draw_cell(sheet, group, left + (column + 0.5) * cell_wide, top - row * cell_high)


def states_size(names: Sequence[str]) -> tuple[float, float]:
    """Width and height in points of the block that delays the states by a sample."""
    wide = max(text_width(with_unit(name), SMALL) for name in names)
    return wide + 16.0, LINE * (LARGE + SMALL * len(names)) + 12.0


def draw_states(sheet: Sheet, names: Sequence[str], x: float, y: float) -> None:
    wide, high = states_size(names)
    sheet.box(x, y, wide, high)
    top = y + 0.5 * high - 5.0
    top -= sheet.column(x, top, ["z⁻¹"], size=LARGE, weight="bold")
    sheet.column(x, top, [with_unit(name) for name in names], size=SMALL)


def small(sheet: Sheet, x: float, y: float, text: str) -> None:
    """The name of a line, just above it."""
    sheet.text(x, y + 1.5, text, size=NORMAL, va="bottom", color=QUIET)
