"""Laws as block diagrams (Figs. 10, 11 and 14 of Fietzek & Rinderknecht)."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...argument_checks import checks_arguments
from ...display.numbers import given
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem, Stepper
from .dynamic_law import draw_dynamic
from .joined_laws import draw_joined
from .law_parts import draw_inputs, draw_outputs, present
from .sheet import LINE, QUIET, SMALL, Sheet, text_width
from .static_law import draw_static

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Law = DiscreteSystem | Stepper


@checks_arguments
def block_diagram(
    law: Law | Sequence[Law],
    *,
    plant: Drivetrain | None = None,
    outputs: Sequence[str] | None = None,
    title: str | None = None,
) -> Figure:
    """The equations of one law, or how several laws and the plant are joined by the names of their signals.

    One law shows inputs, outputs and states with their units, its matrices with their shapes, and a picture of every
    curve; a matrix of zeros is left out. A connected law is one law: give its parts to see how they are joined. Where a
    law without states sums its inputs once, each input shows its gain.

    Parameters
    ----------
    law : DiscreteSystem, Stepper, or sequence of them
        A sequence as for ``connect`` or ``simulate``.
    plant : Drivetrain, optional
        Closes the loop: it reads the torques that laws make, and gives the signals that no law makes.
    outputs : sequence of str, optional
        Of several laws, or of a loop: what leaves; default: all that is not read in it.
    title : str, optional
        Default: the laws' names.

    Returns
    -------
    Figure
        Its size follows from what is on it.

    Raises
    ------
    InvalidInput
        If there is no law, two have the same output, or one of ``outputs`` is none.
    """
    laws = (law,) if isinstance(law, Law) else tuple(law)
    if not laws:
        raise InvalidInput("plot.block_diagram", "no law", "one law or more", "Give it.")
    sheet = Sheet()
    if len(laws) == 1 and plant is None and outputs is None:
        draw_law(sheet, laws[0])
    else:
        draw_joined(sheet, laws, plant, outputs)
    return sheet.figure(title or " + ".join(part.name.replace("_", " ") for part in laws))


def draw_law(sheet: Sheet, law: Law) -> None:
    """One law's diagram, and below it what its symbols mean."""
    if isinstance(law, Stepper):
        _draw_stepper(sheet, law)
        lines = [f"a stepper: state and y from step(parameters, state, u) every {given(law.dt, 's')}"]
    else:
        (draw_dynamic if law.states else draw_static)(sheet, law)
        lines = _legend(law)
    sheet.column(sheet.left, sheet.bottom - 10.0, lines, size=SMALL, ha="left", color=QUIET)


def _legend(law: DiscreteSystem) -> list[str]:
    parts = ["u inputs"]
    if law.states:
        parts.append("x states, x⁺ those of the next sample")
    if law.curves:
        parts.append("z arguments and w values of the curves")
    lines = [f"{', '.join(parts)}, y outputs", f"all in SI units, every {given(law.dt, 's')}"]
    if law.checks:
        used = [k + v for k, v in (("P·", "x"), ("Q·", "u"), ("R·", "w")) if present(getattr(law, k[0]))]
        lines.append(f"check: {' + '.join(used)} in place of an input that is missing, jumps or is frozen")
    return lines


def _draw_stepper(sheet: Sheet, law: Stepper) -> None:
    lines = [law.estimator.rpartition(".")[2].replace("_", " "), f"{law.parameters.size} parameters"]
    wide = max(text_width(line, SMALL) for line in lines) + 30.0
    ports = [*draw_inputs(sheet, law.inputs, 0.0), *draw_outputs(sheet, law.outputs, wide)]
    sheet.box(0.5 * wide, 0.0, wide, 2.0 * max(*ports, LINE * SMALL) + 24.0)
    sheet.column(0.5 * wide, LINE * SMALL, lines, size=SMALL)
