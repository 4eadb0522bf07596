"""A law without states as a block diagram, from left to right: inputs, curves, outputs."""

from __future__ import annotations

from ...systems import DiscreteSystem
from .law_parts import (
    BLOCK,
    HIGH,
    ROOM,
    SUM,
    block,
    bus,
    curves_size,
    draw_curves,
    draw_inputs,
    draw_outputs,
    node,
    present,
    single_sum,
    small,
    summed,
    through,
)
from .sheet import Sheet


def draw_static(sheet: Sheet, law: DiscreteSystem) -> None:
    """u → G → curves → J → y with D above; gains stand on the inputs' arrows where there is one sum of them alone."""
    gains = single_sum(law)
    ports = draw_inputs(sheet, law.inputs, 0.0, checked=[c.input for c in law.checks], gains=gains)
    beside = bool(law.curves) and present(law.D) and not gains
    above = 0.5 * (max(curves_size(law.curves)[1], HIGH) + HIGH) + 10.0 if beside else 0.0
    bus(sheet, 0.0, ports, above, 0.0)
    x = 0.0
    if gains:
        sheet.line((x, 0.0), (x + ROOM - SUM, 0.0), arrow=True)
        x += ROOM + SUM
        summed(sheet, x - SUM, 0.0)
    if law.curves:
        x = _curves(sheet, law, x, driven=not gains and present(law.G))
        if beside:
            x = _direct(sheet, law, x, above)
    elif not gains:
        x = through(sheet, x, 0.0, "D", law.D)
    sheet.line((x, 0.0), (x + ROOM, 0.0))
    small(sheet, x + 0.5 * ROOM, 0.0, "y")
    bus(sheet, x + ROOM, draw_outputs(sheet, law.outputs, x + ROOM), 0.0)


def _curves(sheet: Sheet, law: DiscreteSystem, x: float, *, driven: bool) -> float:
    """From the inputs through the curves, with their feedback H below, to J; where that ends."""
    wide, high = curves_size(law.curves)
    if driven:
        x = through(sheet, x, 0.0, "G", law.G)
    looped = present(law.H)
    join = x + ROOM
    if looped:
        sheet.line((x, 0.0), (join - SUM, 0.0), arrow=True)
        summed(sheet, join, 0.0)
        x = join + SUM
    left = x + ROOM
    sheet.line((x, 0.0), (left, 0.0), arrow=True)
    small(sheet, x + 0.4 * ROOM, 0.0, "z")
    draw_curves(sheet, law.curves, left + 0.5 * wide, 0.0)
    branch = left + wide + 0.75 * ROOM
    sheet.line((left + wide, 0.0), (branch, 0.0))
    small(sheet, branch - 0.3 * ROOM, 0.0, "w")
    if looped:
        below, middle = -0.5 * (high + HIGH) - 10.0, left + 0.5 * wide
        node(sheet, branch, 0.0)
        sheet.line((branch, 0.0), (branch, below), (middle + 0.5 * BLOCK, below), arrow=True)
        block(sheet, middle, below, "H", law.H)
        sheet.line((middle - 0.5 * BLOCK, below), (join, below), (join, -SUM), arrow=True)
    return through(sheet, branch, 0.0, "J", law.J)


def _direct(sheet: Sheet, law: DiscreteSystem, end: float, above: float) -> float:
    """From the inputs over the curves to a sum before the outputs; where that ends."""
    join = end + ROOM
    sheet.line((end, 0.0), (join - SUM, 0.0), arrow=True)
    middle = 0.5 * join
    sheet.line((0.0, above), (middle - 0.5 * BLOCK, above), arrow=True)
    block(sheet, middle, above, "D", law.D)
    sheet.line((middle + 0.5 * BLOCK, above), (join, above), (join, SUM), arrow=True)
    summed(sheet, join, 0.0)
    return join + SUM
