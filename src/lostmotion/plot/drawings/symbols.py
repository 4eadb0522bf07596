"""Symbols of a torsional chain: rotor, spring, damper, gap, friction, held end."""

from __future__ import annotations

from .sheet import ACCENT, FILL, INK, QUIET, Sheet

#: Height of the largest rotor, of the smallest, and a rotor's thickness in points (option).
LARGEST, SMALLEST, THICKNESS = 84.0, 26.0, 16.0
#: Width of the surface that holds a friction pad, in points (option).
GROUND = 26.0


def rotor_height(inertia: float, largest: float) -> float:
    """In points: a disc of constant thickness has an inertia that grows with the fourth power of its diameter."""
    return max(SMALLEST, LARGEST * (inertia / largest) ** 0.25)


def rotor(sheet: Sheet, x: float, y: float, height: float, thickness: float = THICKNESS) -> None:
    sheet.box(x, y, thickness, height, facecolor=FILL, edgecolor=INK, linewidth=1.4)


def spring(sheet: Sheet, start: float, end: float, y: float, size: float = 6.0) -> None:
    """A zigzag from ``start`` to ``end``."""
    lead, teeth = 0.12 * (end - start), 8
    step = (end - start - 2.0 * lead) / teeth
    inner = [(start + lead + (i + 0.5) * step, y + (size if i % 2 else -size)) for i in range(teeth)]
    sheet.line((start, y), (start + lead, y), *inner, (end - lead, y), (end, y))


def damper(sheet: Sheet, start: float, end: float, y: float, size: float = 6.0) -> None:
    """A dashpot: a cup from the left, a piston from the right."""
    middle = 0.5 * (start + end)
    sheet.line((start, y), (middle - 6.0, y))
    sheet.line(
        (middle + 8.0, y + size), (middle - 6.0, y + size), (middle - 6.0, y - size), (middle + 8.0, y - size)
    )
    sheet.line((middle + 2.0, y), (end, y))
    sheet.line((middle + 2.0, y + size - 2.0), (middle + 2.0, y - size + 2.0), width=1.8)


def fork_and_pin(sheet: Sheet, start: float, end: float, y: float, size: float = 10.0) -> None:
    """A pin with play between the lips of a fork."""
    fork, lip, pin = start + 4.0, end - 6.0, 0.5 * (start + end) + 0.5
    accent = {"color": ACCENT, "width": 1.6}
    sheet.line((start, y), (fork, y))
    sheet.line((lip, y + 0.4 * size), (lip, y + size), (fork, y + size), (fork, y - size), (lip, y - size),
               (lip, y - 0.4 * size), **accent)  # fmt: skip
    sheet.line((pin, y), (end, y))
    sheet.line((pin, y + 0.65 * size), (pin, y - 0.65 * size), color=ACCENT, width=2.4)


def shaft(
    sheet: Sheet, start: float, end: float, y: float, *, damped: bool, backlash: bool, damper_spans_gap: bool
) -> None:
    """Spring, damper and gap as the contact law joins them.

    The damper acts beside the spring and behind the gap; under the law ``dead_zone`` it acts across the gap too.
    """
    width = 26.0 if backlash else 0.0
    off = 13.0 if damped else 0.0
    fork, join = start + 8.0, end - 8.0
    closed = join if damper_spans_gap else join - width
    sheet.line((start, y), (fork, y))
    sheet.line((join, y), (end, y))
    spring(sheet, fork, join - width, y + off)
    if backlash:
        fork_and_pin(sheet, join - width, join, y + off if damper_spans_gap else y)
    if damped:
        damper(sheet, fork, closed, y - off)
        sheet.line((fork, y - off), (fork, y + off))
        sheet.line((closed, y - off), (closed, y + off))


def ground(sheet: Sheet, x: float, y: float, width: float = GROUND) -> None:
    """A fixed surface below the point (x, y)."""
    sheet.line((x - 0.5 * width, y), (x + 0.5 * width, y), width=1.4)
    for i in range(6):
        left = x - 0.5 * width + i * width / 6.0
        sheet.line((left, y - 5.0), (left + 4.5, y), width=0.8, color=QUIET)


def friction(sheet: Sheet, x: float, top: float) -> float:
    """A pad on the rotor's rim, held by the ground; the height (points) that it takes below ``top``."""
    sheet.box(x, top - 3.0, 12.0, 6.0, facecolor=QUIET, edgecolor=INK, linewidth=0.8)
    sheet.line((x, top - 6.0), (x, top - 13.0))
    ground(sheet, x, top - 13.0)
    return 20.0


def wall(sheet: Sheet, x: float, y: float, *, left: bool) -> None:
    """A held end at the left or the right of a rotor's face at x."""
    side = -1.0 if left else 1.0
    face = x + 10.0 * side
    sheet.line((x, y), (face, y), width=2.4)
    sheet.line((face, y - 20.0), (face, y + 20.0), width=1.6)
    for i in range(8):
        low = y - 20.0 + 5.0 * i
        sheet.line((face, low), (face + 5.0 * side, low + 5.0), width=0.8, color=QUIET)
