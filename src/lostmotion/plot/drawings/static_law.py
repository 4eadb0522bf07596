"""A law without states as a block diagram, from left to right: inputs, curves, outputs."""

from __future__ import annotations

from ...systems import DiscreteSystem
from . import law_parts as parts
from .sheet import Sheet


def draw_static(sheet: Sheet, law: DiscreteSystem) -> None:
    """u → G → curves → J → y with D above; gains stand on the inputs' arrows where there is one sum of them alone."""
    gains = parts.single_sum(law)
    ports = parts.draw_inputs(sheet, law.inputs, 0.0, checked=[c.input for c in law.checks], gains=gains)
    beside = bool(law.curves) and parts.present(law.D) and not gains
    above = 0.5 * (max(parts.curves_size(law.curves)[1], parts.HIGH) + parts.HIGH) + 10.0 if beside else 0.0
    parts.bus(sheet, 0.0, ports, above, 0.0)
    x = 0.0
    if gains:
        sheet.line((x, 0.0), (x + parts.ROOM - parts.SUM, 0.0), arrow=True)
        x += parts.ROOM + parts.SUM
        parts.summed(sheet, x - parts.SUM, 0.0)
    if law.curves:
        x = _curves(sheet, law, x, driven=not gains and parts.present(law.G))
        if beside:
            x = _direct(sheet, law, x, above)
    elif not gains:
        x = parts.through(sheet, x, 0.0, "D", law.D)
    sheet.line((x, 0.0), (x + parts.ROOM, 0.0))
    parts.small(sheet, x + 0.5 * parts.ROOM, 0.0, "y")
    parts.bus(sheet, x + parts.ROOM, parts.draw_outputs(sheet, law.outputs, x + parts.ROOM), 0.0)


def _curves(sheet: Sheet, law: DiscreteSystem, x: float, *, driven: bool) -> float:
    """From the inputs through the curves, with their feedback H below, to J; where that ends."""
    wide, high = parts.curves_size(law.curves)
    if driven:
        x = parts.through(sheet, x, 0.0, "G", law.G)
    looped = parts.present(law.H)
    join = x + parts.ROOM
    if looped:
        sheet.line((x, 0.0), (join - parts.SUM, 0.0), arrow=True)
        parts.summed(sheet, join, 0.0)
        x = join + parts.SUM
    left = x + parts.ROOM
    sheet.line((x, 0.0), (left, 0.0), arrow=True)
    parts.small(sheet, x + 0.4 * parts.ROOM, 0.0, "z")
    parts.draw_curves(sheet, law.curves, left + 0.5 * wide, 0.0)
    branch = left + wide + 0.75 * parts.ROOM
    sheet.line((left + wide, 0.0), (branch, 0.0))
    parts.small(sheet, branch - 0.3 * parts.ROOM, 0.0, "w")
    if looped:
        below, middle = -0.5 * (high + parts.HIGH) - 10.0, left + 0.5 * wide
        parts.node(sheet, branch, 0.0)
        sheet.line((branch, 0.0), (branch, below), (middle + 0.5 * parts.BLOCK, below), arrow=True)
        parts.block(sheet, middle, below, "H", law.H)
        sheet.line((middle - 0.5 * parts.BLOCK, below), (join, below), (join, -parts.SUM), arrow=True)
    return parts.through(sheet, branch, 0.0, "J", law.J)


def _direct(sheet: Sheet, law: DiscreteSystem, end: float, above: float) -> float:
    """From the inputs over the curves to a sum before the outputs; where that ends."""
    join = end + parts.ROOM
    sheet.line((end, 0.0), (join - parts.SUM, 0.0), arrow=True)
    middle = 0.5 * join
    sheet.line((0.0, above), (middle - 0.5 * parts.BLOCK, above), arrow=True)
    parts.block(sheet, middle, above, "D", law.D)
    sheet.line((middle + 0.5 * parts.BLOCK, above), (join, above), (join, parts.SUM), arrow=True)
    parts.summed(sheet, join, 0.0)
    return join + parts.SUM
