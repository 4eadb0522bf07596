"""A torsional model above the chain that takes its place (Fig. 3 of Fietzek & Rinderknecht)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...argument_checks import checks_arguments
from ...display.numbers import given, quantity
from ...drivetrain import Drivetrain
from ...structure import TorsionalModel, modes
from .chain import draw_chain
from .sheet import ACCENT, LINE, QUIET, SMALL, Sheet, text_width
from .symbols import LARGEST, fork_and_pin, rotor, rotor_height, spring

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Distance of the model's nodes, thickness of its rotors, room between the two drawings in points (option).
STEP, THIN, BETWEEN = 40.0, 9.0, 72.0


@checks_arguments
def reduction(
    model: TorsionalModel,
    drivetrain: Drivetrain,
    *,
    gap: str | int | None = None,
    gap_shaft: int = 0,
    title: str = "Reduction",
) -> Figure:
    """The nodes of a torsional model, which of them become which side of the gap, and the chain with its values.

    Parameters
    ----------
    model : TorsionalModel
    drivetrain : Drivetrain
        The chain in its place, such as ``ChainReduction.drivetrain``.
    gap : str, int or None
        The model's last node before the gap; None: no place of the gap, only the whole goes over.
    gap_shaft : int
        The chain's shaft with the gap, where ``gap`` is given.
    title : str

    Returns
    -------
    Figure
    """
    sheet = Sheet()
    last = None if gap is None else model.node(gap)
    nodes = [STEP * i for i in range(len(model.names))]
    _draw_model(sheet, model, nodes, last)
    below = sheet.bottom
    chain = Sheet()
    wide = draw_chain(chain, drivetrain, 0.0, 0.0)
    start = 0.5 * (nodes[-1] - wide[-1])
    y = below - BETWEEN - chain.top
    places = draw_chain(sheet, drivetrain, start, y)
    top = y + chain.top + 2.0
    if last is None:
        _lead(sheet, nodes, places, below, top, _whole(model), "left")
    else:
        first, second = (quantity(j, "kg m2") for j in model.inertia_sides(last))
        _lead(sheet, nodes[: last + 1], places[: gap_shaft + 1], below, top, f"motor side {first}", "right")
        _lead(sheet, nodes[last + 1 :], places[gap_shaft + 1 :], below, top, f"load side {second}", "left")
    return sheet.figure(title)


def _whole(model: TorsionalModel) -> str:
    poles = modes(model).frequency[1:2]
    first = "".join(f", first pole {quantity(float(f), 'Hz')}" for f in poles)
    return f"{given(model.inertia_total, 'kg m2')} in all{first}"


def _draw_model(sheet: Sheet, model: TorsionalModel, nodes: Sequence[float], last: int | None) -> None:
    """A rotor for each node with its share of the mass, a spring for each element."""
    shares = model.mass.sum(axis=1)
    largest = float(np.max(shares))
    for i, (left, right) in enumerate(zip(nodes, nodes[1:], strict=False)):
        ends = left + 0.5 * THIN, right - 0.5 * THIN
        if i == last:
            spring(sheet, ends[0], ends[1] - 17.0, 0.0, size=3.5)
            fork_and_pin(sheet, ends[1] - 17.0, ends[1], 0.0, size=8.0)
        else:
            spring(sheet, *ends, 0.0, size=3.5)
    for x, share in zip(nodes, shares, strict=True):
        rotor(sheet, x, 0.0, rotor_height(float(share), largest), THIN)
    _name(sheet, model, nodes)
    sheet.text(nodes[0] - 20.0, 0.0, f"{len(nodes)} nodes", ha="right", color=QUIET)


def _name(sheet: Sheet, model: TorsionalModel, nodes: Sequence[float]) -> None:
    """Names of all nodes but those inside a shaft, each on the lowest line on which it is free."""
    taken: list[float] = []
    for x, name in zip(nodes, model.names, strict=True):
        if "." in name:
            continue
        half = 0.5 * text_width(name, SMALL) + 4.0
        level = next((i for i, end in enumerate(taken) if end <= x - half), len(taken))
        taken[level : level + 1] = [x + half]
        y = 0.5 * LARGEST + 8.0 + LINE * SMALL * level
        sheet.text(x, y, name, size=SMALL, va="bottom")


def _lead(
    sheet: Sheet,
    nodes: Sequence[float],
    places: Sequence[float],
    top: float,
    bottom: float,
    text: str,
    ha: str,
) -> None:
    """A bar under some nodes, and an arrow from it to the rotors that take their place."""
    under, above = top - LINE * SMALL - 6.0, bottom
    target = 0.5 * (places[0] + places[-1])
    if len(places) > 1:
        above = bottom + 6.0
        sheet.line(
            (places[0], bottom), (places[0], above), (places[-1], above), (places[-1], bottom), color=ACCENT
        )
    sheet.line((nodes[0], under), (nodes[-1], under), width=2.4, color=ACCENT)
    sheet.line((0.5 * (nodes[0] + nodes[-1]), under), (target, above), color=ACCENT, arrow=True)
    side = nodes[0] + 4.0 if ha == "left" else nodes[-1] - 4.0
    sheet.text(side, under + 3.0, text, size=SMALL, ha=ha, va="bottom", color=ACCENT)
