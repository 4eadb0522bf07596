"""Events as the kernel leaves them, made into ``Events``."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..events import KINDS, Events
from .contact_states import GAP
from .tables import Plant

Array = NDArray[np.float64]


def events_of(plant: Plant, rows: Array) -> Events:
    """Impacts, separations, sticking and slipping out of (events, 5 or more) rows.

    A row holds the time in samples, the element, its old and its new digit, the speed. A change from one segment of
    a friction curve to the next is none of these, nor is a speed that only passes through rest.
    """
    kinds = [KINDS.index(name) for name in ("impact", "separation", "stick", "slip")]
    impact, separation, stick, slip = kinds
    parts = plant.elements
    shaft = np.array([e.kind == "shaft" for e in parts], dtype=bool)
    friction = np.array([e.kind == "friction" for e in parts], dtype=bool)
    rest = np.array([e.rest for e in parts], dtype=np.int64)
    element, old, new = (rows[:, j].astype(np.int64) for j in (1, 2, 3))
    at_rest, left_rest = new == rest[element], old == rest[element]
    of_shaft = np.where(new == GAP, separation, impact)
    of_friction = np.where(at_rest, stick, slip)
    kind = np.where(shaft[element], of_shaft, of_friction)
    told = (shaft[element] | (friction[element] & (at_rest | left_rest))) & ~_passing(rows)
    kind, element = kind[told], element[told]
    time, speed = rows[told, 0] * plant.dt, rows[told, 4]
    energy = np.where(kind == impact, 0.5 * speed**2 / _inverse_inertias(plant)[element], 0.0)
    return Events(time, kind, element, speed, energy, tuple(f"{e.kind} {e.index + 1}" for e in parts))


def _inverse_inertias(plant: Plant) -> Array:
    """Of each element that is a shaft 1/J of its ends, which move together; a held end is infinitely heavy."""
    held, inertias = plant.drivetrain.locked_inertia, plant.drivetrain.inertias
    inverse = [0.0 if i == held else 1.0 / inertia for i, inertia in enumerate(inertias)]
    return np.array(
        [inverse[e.index] + inverse[e.index + 1] if e.kind == "shaft" else 1.0 for e in plant.elements]
    )


def _passing(rows: Array) -> NDArray[np.bool_]:
    """Pairs of events that enter and leave one digit at once: a speed that passes through rest does not stick."""
    again = (rows[1:, 0] == rows[:-1, 0]) & (rows[1:, 1] == rows[:-1, 1]) & (rows[1:, 2] == rows[:-1, 3])
    passing = np.zeros(len(rows), dtype=bool)
    passing[1:] |= again
    passing[:-1] |= again
    return passing
