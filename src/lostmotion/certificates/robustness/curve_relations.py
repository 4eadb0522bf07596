"""What a curve's argument and value, and bounded signals beside them, have to do with each other: quadratic forms.

Each form is at least zero along every motion, so that any multiple of it may be taken off a condition (Yakubovich's
S-procedure). docs/proofs.md, equation 29.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from ...errors import InvalidInput
from ..rational import Matrix
from ..static_curves import StaticCurve


class CurveShape(NamedTuple):
    """A curve that saturates at ±high, with slope ``steepest`` around zero, or that jumps from −low to high (or −high
    to low) at zero, where ``steepest`` is None."""

    low: Any
    high: Any
    steepest: Any

    def floats(self) -> CurveShape:
        """The same in floats."""
        return CurveShape(
            float(self.low), float(self.high), None if self.steepest is None else float(self.steepest)
        )


def shape_of(curve: StaticCurve, name: str) -> CurveShape:
    """The shape; raises ``InvalidInput`` for any other curve."""
    (first, down), (last, up) = curve.points[0], curve.points[-1]
    jumps = len(curve.points) == 2 and first == last == 0 and down <= 0 <= up
    saturates = len(curve.points) == 2 and curve.is_odd and first < last
    if not (jumps or saturates) or curve.left or curve.right:
        raise InvalidInput(
            f"peak_bounds: {name}",
            f"a curve through {len(curve.points)} points with slopes {curve.slopes}",
            "a saturation, or a jump at zero",
            "Leave the curve out, or simulate the loop.",
        )
    return CurveShape(min(-down, up), max(-down, up), curve.steepest)


class Reading(NamedTuple):
    """One curve at one moment: its number among all curves, and rows of argument and value over the vector."""

    curve: int
    argument: Matrix
    value: Matrix


@dataclass(frozen=True, eq=False)
class Moment:
    """The vector of a condition.

    Parameters
    ----------
    readings : sequence of Reading
    signals : sequence of rows, each of which stays within ±1
    one : row of the constant 1; None where a condition is homogeneous
    rates : mapping of curve → rows of the argument's and the value's rate
    """

    readings: Sequence[Reading]
    signals: Sequence[Matrix]
    one: Matrix | None = None
    rates: dict[int, tuple[Matrix, Matrix]] = field(default_factory=dict)


def square(row: Matrix) -> Matrix:
    """The form (row·x)²."""
    return np.outer(row, row)


def product(a: Matrix, b: Matrix) -> Matrix:
    """The form (a·x)(b·x)."""
    form = np.outer(a, b)
    return np.asarray((form + form.T) / 2)


def relations(
    moment: Moment, shapes: Sequence[CurveShape], widths: Sequence[Any]
) -> tuple[list[Matrix], list[Matrix]]:
    """Forms that are at least zero, and forms that are zero; ``widths`` bound the arguments (None: no bound)."""
    positive: list[Matrix] = []
    zero: list[Matrix] = []
    one = moment.one
    if one is not None:
        positive += [square(one) - square(signal) for signal in moment.signals]
    for own in moment.readings:
        others = [r.value / shapes[r.curve].high for r in moment.readings if r is not own]
        more, none = _of_curve(own, shapes[own.curve], widths[own.curve], [*moment.signals, *others], moment)
        positive += more
        zero += none
    return positive + _of_copies(moment.readings, shapes), zero


def _of_curve(
    own: Reading, shape: CurveShape, width: Any, signals: Sequence[Matrix], moment: Moment
) -> tuple[list[Matrix], list[Matrix]]:
    """Of one curve; each signal stays within ±1."""
    share, zero = own.value / shape.high, []
    if shape.steepest is None:
        # What is beyond the curve has the curve's sign: of a jump, all of its argument.
        beyond, sign, room = own.argument, own.value / (shape.low or shape.high), width
    else:
        beyond, sign = own.argument * (shape.steepest / shape.high) - share, share
        room = None if width is None else width * shape.steepest / shape.high - 1
        if own.curve in moment.rates:
            # The value moves as the argument does, or not at all, and never beyond.
            faster, rate = moment.rates[own.curve]
            zero += [product(rate, shape.steepest * faster - rate), product(rate, beyond)]
    positive = [product(sign, beyond)]
    if moment.one is not None:
        positive.append(square(moment.one) - square(share))
    if room is not None and room <= 0:
        zero.append(square(beyond))
    elif room is not None and (shape.low or shape.steepest is not None):
        positive.append(product(sign, beyond) - square(beyond) / room)
    if shape.low:
        # |beyond| is at least signal·beyond.
        for signal in signals:
            positive += [product(beyond, sign + signal), product(beyond, sign - signal)]
    return positive, zero


def _of_copies(readings: Sequence[Reading], shapes: Sequence[CurveShape]) -> list[Matrix]:
    """Two arguments of one rising curve: docs/proofs.md, equation 8."""
    forms = []
    for i, first in enumerate(readings):
        for second in readings[:i]:
            shape = shapes[first.curve]
            # A jump that is not odd may be turned round in the other curve: its shape does not tell.
            if shapes[second.curve] == shape and shape.low == shape.high:
                value = first.value - second.value
                rest = first.argument - second.argument
                if shape.steepest is not None:
                    rest = rest * shape.steepest - value
                forms.append(product(value / shape.high, rest / shape.high))
    return forms
