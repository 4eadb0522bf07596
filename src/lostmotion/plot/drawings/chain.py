"""A drivetrain as the drawing of its rotors, shafts, gaps and friction (Figs. 3 and 6 of Fietzek & Rinderknecht)."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from ...argument_checks import checks_arguments
from ...display.numbers import given
from ...drivetrain import Drivetrain, Friction, Shaft
from .sheet import LINE, NORMAL, SMALL, Sheet, text_width
from .symbols import GROUND, LARGEST, THICKNESS, friction, rotor, rotor_height, shaft, wall

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Shortest shaft, and room beside its values, in points (option).
SHORTEST, BESIDE = 96.0, 10.0
_BELOW = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


@checks_arguments
def chain(drivetrain: Drivetrain, *, title: str = "Drivetrain") -> Figure:
    """Rotors, shafts with spring, damper and gap, friction, actuator and held end, each with its values.

    A rotor's height grows with the fourth root of its inertia, as a disc's diameter does. The damper is drawn across
    the gap under the contact law ``dead_zone``, where it acts there too, and behind it under all others.

    Parameters
    ----------
    drivetrain : Drivetrain
        Of any number of inertias; about six fit on a page.
    title : str

    Returns
    -------
    Figure
        Its size follows from what is on it.
    """
    sheet = Sheet()
    draw_chain(sheet, drivetrain, 0.0, 0.0)
    return sheet.figure(title)


def draw_chain(sheet: Sheet, drivetrain: Drivetrain, left: float, y: float) -> list[float]:
    """Draws it from ``left`` on along the axis at height ``y``; the places of the rotors."""
    several = len(drivetrain.inertias) > 2
    labels = [_shaft_lines(s, i, several) for i, s in enumerate(drivetrain.shafts)]
    rims = [_inertia_lines(drivetrain, i) for i in range(len(drivetrain.inertias))]
    frictions = [_friction_lines(f) for f in drivetrain.frictions]
    places = _places(labels, [a + b for a, b in zip(rims, frictions, strict=True)], left)
    low = (
        min(y - 0.5 * LARGEST, y - 30.0 - LINE * SMALL * max((len(lines) for lines in labels), default=0))
        - 4.0
    )
    largest = max(drivetrain.inertias)
    for i, (x, inertia) in enumerate(zip(places, drivetrain.inertias, strict=True)):
        height = rotor_height(inertia, largest)
        rotor(sheet, x, y, height)
        sheet.column(x, y + 0.5 * LARGEST + 6.0 + LINE * NORMAL * len(rims[i]), rims[i])
        if frictions[i]:
            top = y - 0.5 * height
            taken = friction(sheet, x, top)
            sheet.column(x, min(top - taken, low), frictions[i], size=SMALL)
    for i, part in enumerate(drivetrain.shafts):
        ends = places[i] + 0.5 * THICKNESS, places[i + 1] - 0.5 * THICKNESS
        crossing = part.contact == "dead_zone"
        shaft(
            sheet, *ends, y, damped=part.damping > 0.0, backlash=part.has_backlash, damper_spans_gap=crossing
        )
        sheet.column(0.5 * sum(ends), y - 26.0, labels[i], size=SMALL)
    _ends(sheet, drivetrain, places, y)
    return places


def _places(shafts: list[list[str]], rotors: list[list[str]], left: float) -> list[float]:
    """Middle of each rotor: neighbours as far apart as the texts of the shaft and of both rotors need."""

    def width(lines: list[str], size: float) -> float:
        return max((text_width(line, size) for line in lines), default=0.0)

    places = [left]
    for i, lines in enumerate(shafts):
        own = max(width(lines, SMALL) + GROUND, SHORTEST)
        both = 0.5 * (width(rotors[i], NORMAL) + width(rotors[i + 1], NORMAL))
        places.append(places[-1] + max(own, both) + BESIDE)
    return places


def _ends(sheet: Sheet, drivetrain: Drivetrain, places: list[float], y: float) -> None:
    """The motor torque with its actuator, and the wall at an end that is held."""
    if drivetrain.locked is not None:
        at_motor = drivetrain.locked == "motor"
        side = -0.5 if at_motor else 0.5
        wall(sheet, places[0 if at_motor else -1] + side * THICKNESS, y, left=at_motor)
    if drivetrain.locked == "motor":
        return
    tip = places[0] - 0.5 * THICKNESS
    actuator, lines = drivetrain.actuator, []
    if actuator.lag > 0.0:
        lines.append(f"lag {given(actuator.lag, 's')}")
    if math.isfinite(actuator.torque_limit):
        lines.append(f"limit ±{given(actuator.torque_limit, 'Nm')}")
    if math.isfinite(actuator.rate_limit):
        lines.append(f"limit ±{given(actuator.rate_limit, 'Nm/s')}")
    start = tip - 46.0
    sheet.line((start, y), (tip, y), arrow=True, width=1.6)
    sheet.text(start + 20.0, y + 4.0, "M", va="bottom", weight="bold")
    if lines:
        lines = ["actuator", *lines]
        wide = max(text_width(line, SMALL) for line in lines) + 12.0
        high = LINE * SMALL * len(lines) + 8.0
        sheet.box(start - 0.5 * wide, y, wide, high)
        sheet.column(start - 0.5 * wide, y + 0.5 * high - 4.0, lines, size=SMALL)


def _inertia_lines(drivetrain: Drivetrain, i: int) -> list[str]:
    n = len(drivetrain.inertias)
    names = {0: "motor, ", n - 1: "load, "} if n > 1 else {0: "motor and load, "}
    number = str(i + 1).translate(_BELOW)
    return [f"{names.get(i, '')}φ{number}", f"J{number} = {given(drivetrain.inertias[i], 'kg m2')}"]


def _shaft_lines(part: Shaft, i: int, several: bool) -> list[str]:
    number = str(i + 1).translate(_BELOW) if several else ""
    lines = [f"k{number} = {given(part.stiffness, 'Nm/rad')}"]
    if part.damping > 0.0:
        lines.append(f"d{number} = {given(part.damping, 'Nm s/rad')}")
    if part.has_backlash:
        lines += [
            f"gap 2h{number} = {given(part.backlash, 'rad')}",
            f"contact: {part.contact.replace('_', ' ')}",
        ]
    return lines


def _friction_lines(part: Friction) -> list[str]:
    lines = []
    plus, minus = part.coulomb_plus, part.coulomb_minus
    if plus == minus and plus > 0.0:
        lines.append(f"Coulomb ±{given(plus, 'Nm')}")
    elif plus != minus:
        lines.append(f"Coulomb +{given(plus, 'Nm')}, −{given(minus, 'Nm')}")
    if part.stribeck:
        lines.append(f"Stribeck +{given(part.stribeck[0][1], 'Nm')} at rest")
    if part.breakaway is not None:
        lines.append(f"breakaway {given(part.breakaway, 'Nm')}")
    if part.viscous > 0.0:
        lines.append(f"viscous {given(part.viscous, 'Nm s/rad')}")
    return lines
