"""A law with states as a block diagram: the states' loop above, the curves as its feedback below."""

from __future__ import annotations

from dataclasses import dataclass

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
    draw_states,
    gain,
    heights,
    node,
    present,
    small,
    states_size,
    summed,
)
from .sheet import Sheet

#: Half of a block with the room around it, points.
_ROW = 0.5 * HIGH + 12.0


@dataclass(frozen=True)
class _Places:
    """Columns (x) and rows (y) in points: the main row with the states is at 0, inputs begin at 0."""

    into_e: float
    into_a: float
    states: float
    fork: float
    c: float
    out: float
    d: float
    a: float
    f: float
    curves: float
    h: float
    j: float
    g: float


def draw_dynamic(sheet: Sheet, law: DiscreteSystem) -> None:
    """::

        ┌──────────────── D ───────────────┐
        u ── B ── + ── + ── z⁻¹ ── x ── C ── + ── y
        │         E    └──── A ────┤         │
        │         w ─── curves ─ + F         │
        │         ├────── H ─────┤           │
        │         └────────────── J ─────────┘
        └───────────── G ────────┘

    Only what is there is drawn. J and G must cross: the graph has no drawing in the plane.
    """
    at = _places(law)
    ports = draw_inputs(sheet, law.inputs, 0.0, checked=[c.input for c in law.checks])
    bus(sheet, 0.0, ports, *_input_rows(law, at))
    _loop(sheet, law, at)
    _forks(sheet, law, at)
    _outputs(sheet, law, at)
    if law.curves:
        _curves(sheet, law, at)


def _places(law: DiscreteSystem) -> _Places:
    wide, high = states_size(law.states)
    curves_wide, curves_high = curves_size(law.curves) if law.curves else (0.0, 0.0)
    into_e = ROOM + BLOCK + ROOM + SUM
    into_a = into_e + 2.0 * SUM + ROOM
    fork = max(into_a + SUM + ROOM + wide + ROOM, into_e + ROOM + curves_wide + 2.0 * ROOM + SUM)
    states = 0.5 * (into_a + SUM + fork)
    c = fork + ROOM + 0.5 * BLOCK
    a = -0.5 * high - _ROW
    f = a - 2.0 * _ROW + 8.0 if present(law.A) else a
    curves = min(f - _ROW - SUM, a - _ROW - 0.5 * curves_high)
    h = curves - 0.5 * curves_high - _ROW
    j = h - 2.0 * _ROW + 12.0 if present(law.H) else h
    g = j - 2.0 * _ROW + 12.0 if present(law.J) else j
    d = max([0.5 * high, *heights(len(law.inputs))]) + _ROW
    return _Places(
        into_e, into_a, states, fork, c, c + 0.5 * BLOCK + 2.0 * ROOM, d, a, f, curves, h, j, g
    )  # fmt: skip


def _input_rows(law: DiscreteSystem, at: _Places) -> list[float]:
    rows = {"B": 0.0, "D": at.d, "G": at.g}
    return [rows[key] for key in rows if present(getattr(law, key))]


def _loop(sheet: Sheet, law: DiscreteSystem, at: _Places) -> None:
    """Inputs and states to the next states, and the delay."""
    wide, _ = states_size(law.states)
    left, right = at.states - 0.5 * wide, at.states + 0.5 * wide
    x = 0.0
    driven, curved, own = present(law.B), present(law.E), present(law.A)
    if driven:
        sheet.line((x, 0.0), (x + ROOM, 0.0), arrow=True)
        small(sheet, x + 0.4 * ROOM, 0.0, "u")
        block(sheet, x + ROOM + 0.5 * BLOCK, 0.0, "B", law.B)
        x += ROOM + BLOCK
    begun = driven
    for there, place in ((curved, at.into_e), (own, at.into_a)):
        if there and begun:
            sheet.line((x, 0.0), (place - SUM, 0.0), arrow=True)
            summed(sheet, place, 0.0)
            x = place + SUM
        elif there:
            x, begun = place, True
    if begun:
        sheet.line((x, 0.0), (left, 0.0), arrow=True)
    small(sheet, 0.5 * (max(x, at.into_a) + left), 0.0, "x⁺")
    draw_states(sheet, law.states, at.states, 0.0)
    sheet.line((right, 0.0), (at.fork, 0.0))
    small(sheet, 0.5 * (right + at.fork), 0.0, "x")
    if own:
        middle = 0.5 * (at.into_a + at.fork)
        end = -SUM if driven or curved else 0.0
        sheet.line((at.fork, 0.0), (at.fork, at.a), (middle + 0.5 * BLOCK, at.a), arrow=True)
        block(sheet, middle, at.a, "A", law.A)
        sheet.line((middle - 0.5 * BLOCK, at.a), (at.into_a, at.a), (at.into_a, end), arrow=end < 0.0)


def _forks(sheet: Sheet, law: DiscreteSystem, at: _Places) -> None:
    """Dots where a line branches, not where it only turns."""
    a, c, f, h, j, e = (present(getattr(law, key)) for key in "ACFHJE")
    if c and (a or f):
        node(sheet, at.fork, 0.0)
    if a and f:
        node(sheet, at.fork, at.a)
    if e and (h or j):
        node(sheet, at.into_e, at.curves)
    if h and j:
        node(sheet, at.into_e, at.h)


def _outputs(sheet: Sheet, law: DiscreteSystem, at: _Places) -> None:
    """States, inputs and curves to the outputs."""
    parts = [key for key in "CDJ" if present(getattr(law, key))]
    several = len(parts) > 1
    end = at.out - SUM if several else at.out
    if "C" in parts:
        sheet.line((at.fork, 0.0), (at.c - 0.5 * BLOCK, 0.0), arrow=True)
        block(sheet, at.c, 0.0, "C", law.C)
        sheet.line((at.c + 0.5 * BLOCK, 0.0), (end, 0.0), arrow=several)
    if "D" in parts:
        middle = at.states
        sheet.line((0.0, at.d), (middle - 0.5 * BLOCK, at.d), arrow=True)
        block(sheet, middle, at.d, "D", law.D)
        tip = (at.out, SUM if several else 0.0)
        sheet.line((middle + 0.5 * BLOCK, at.d), (at.out, at.d), tip, arrow=several)
    if several:
        summed(sheet, at.out, 0.0)
    x = at.out + (SUM if several else 0.0)
    sheet.line((x, 0.0), (x + ROOM, 0.0))
    small(sheet, x + 0.5 * ROOM, 0.0, "y")
    bus(sheet, x + ROOM, draw_outputs(sheet, law.outputs, x + ROOM), 0.0)


def _curves(sheet: Sheet, law: DiscreteSystem, at: _Places) -> None:
    """States, inputs and earlier curves to the curves, and their values back."""
    wide, _ = curves_size(law.curves)
    middle = 0.5 * (at.into_e + ROOM + at.fork - ROOM - SUM)
    left, right = middle - 0.5 * wide, middle + 0.5 * wide
    several = sum(present(m) for m in (law.F, law.G, law.H)) > 1
    edge = SUM if several else 0.0
    if several:
        summed(sheet, at.fork, at.curves)
    sheet.line((at.fork - edge, at.curves), (right, at.curves), arrow=True)
    small(sheet, 0.5 * (at.fork - edge + right), at.curves, "z")
    draw_curves(sheet, law.curves, middle, at.curves)
    sheet.line((left, at.curves), (at.into_e, at.curves))
    small(sheet, 0.5 * (left + at.into_e), at.curves, "w")
    if present(law.F):
        top = at.a if present(law.A) else 0.0
        sheet.line((at.fork, top), (at.fork, at.f + 0.5 * HIGH), arrow=True)
        block(sheet, at.fork, at.f, "F", law.F)
        sheet.line((at.fork, at.f - 0.5 * HIGH), (at.fork, at.curves + edge), arrow=several)
    if present(law.E):
        end = -SUM if present(law.B) else 0.0
        sheet.line((at.into_e, at.curves), (at.into_e, at.a - 0.5 * HIGH), arrow=True)
        block(sheet, at.into_e, at.a, "E", law.E)
        sheet.line((at.into_e, at.a + 0.5 * HIGH), (at.into_e, end), arrow=end < 0.0)
    _from_curves(sheet, law, at, middle, several)
    if present(law.G):
        around = at.fork + ROOM + SUM
        sheet.line((0.0, at.g), (middle - 0.5 * BLOCK, at.g), arrow=True)
        block(sheet, middle, at.g, "G", law.G)
        tip = (at.fork + edge, at.curves)
        sheet.line((middle + 0.5 * BLOCK, at.g), (around, at.g), (around, at.curves), tip, arrow=several)


def _from_curves(sheet: Sheet, law: DiscreteSystem, at: _Places, middle: float, several: bool) -> None:
    """H back to the arguments, J on to the outputs."""
    ends = {
        "H": (at.h, at.fork, at.curves - (SUM if several else 0.0), several),
        "J": (
            at.j,
            at.out,
            -SUM if present(law.C) or present(law.D) else 0.0,
            present(law.C) or present(law.D),
        ),
    }
    for key, (row, column, tip, joins) in ends.items():
        if present(getattr(law, key)):
            sheet.line((at.into_e, at.curves), (at.into_e, row))
            end = gain(sheet, at.into_e, middle, row, key, getattr(law, key))
            sheet.line((end, row), (column, row), (column, tip), arrow=joins)
