"""Events as the kernel leaves them, made into ``Events`` when they are looked at."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..events import KINDS, Events
from .contact_states import GAP, Element

Array = NDArray[np.float64]


class KernelEvents(Events):
    """Impacts, separations, sticking and slipping out of the kernel's rows; its columns are made at the first look.

    Parameters
    ----------
    rows : (events, 5 or more) array
        Time in samples, element, old and new digit, speed.
    drivetrain, elements
        What moves, and what has digits.
    dt : float, s
    """

    def __init__(self, rows: Array, drivetrain: Drivetrain, elements: tuple[Element, ...], dt: float) -> None:
        self._rows, self._drivetrain, self._elements, self._dt = rows, drivetrain, elements, dt

    def __getattr__(self, name: str) -> Any:
        if name not in ("time", "kind", "place", "speed", "energy", "places"):
            raise AttributeError(name)
        super().__init__(*_columns(self._rows, self._drivetrain, self._elements, self._dt))
        return getattr(self, name)


def _columns(
    rows: Array, drivetrain: Drivetrain, elements: tuple[Element, ...], dt: float
) -> tuple[Array, NDArray[np.int64], NDArray[np.int64], Array, Array, tuple[str, ...]]:
    """The columns of ``Events``.

    A change from one segment of a friction curve to the next is no event, nor is a speed that only passes through rest.
    """
    impact, separation, stick, slip = (KINDS.index(k) for k in ("impact", "separation", "stick", "slip"))
    shaft = np.array([e.kind == "shaft" for e in elements], dtype=bool)
    friction = np.array([e.kind == "friction" for e in elements], dtype=bool)
    rest = np.array([e.rest for e in elements], dtype=np.int64)
    element, old, new = (rows[:, j].astype(np.int64) for j in (1, 2, 3))
    at_rest, left_rest = new == rest[element], old == rest[element]
    of_shaft = np.where(new == GAP, separation, impact)
    kind = np.where(shaft[element], of_shaft, np.where(at_rest, stick, slip))
    told = (shaft[element] | (friction[element] & (at_rest | left_rest))) & ~_passing(rows)
    kind, element = kind[told], element[told]
    time, speed = rows[told, 0] * dt, rows[told, 4]
    inverse = _inverse_inertias(drivetrain, elements)
    energy = np.where(kind == impact, 0.5 * speed**2 / inverse[element], 0.0)
    return time, kind, element, speed, energy, tuple(f"{e.kind} {e.index + 1}" for e in elements)


def _inverse_inertias(drivetrain: Drivetrain, elements: tuple[Element, ...]) -> Array:
    """Of each element that is a shaft 1/J of its ends, which move together; a held end is infinitely heavy."""
    held = drivetrain.locked_inertia
    inverse = [0.0 if i == held else 1.0 / inertia for i, inertia in enumerate(drivetrain.inertias)]
    return np.array([inverse[e.index] + inverse[e.index + 1] if e.kind == "shaft" else 1.0 for e in elements])


def _passing(rows: Array) -> NDArray[np.bool_]:
    """Pairs of events that enter and leave one digit at once: a speed that passes through rest does not stick.

    Changes at once are paired from the first on: of three the last one stands, which is what they come to.
    """
    from ..kernels.plant.layout import AT_ONCE

    again = np.zeros(len(rows), dtype=bool)
    again[1:] = (
        (np.diff(rows[:, 0]) <= AT_ONCE) & (np.diff(rows[:, 1]) == 0.0) & (rows[1:, 2] == rows[:-1, 3])
    )
    first = np.flatnonzero(~again)
    length = np.diff(first, append=len(rows))
    place = np.arange(len(rows)) - np.repeat(first, length)
    return place < np.repeat(length - length % 2, length)
