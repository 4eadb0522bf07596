"""The modes of a drivetrain: which states it has, and which elements' digits make a mode."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

from ..drivetrain import Drivetrain, Shaft

#: Digits of a shaft with backlash, ordered along the twist.
MINUS, GAP, PLUS = 0, 1, 2


@dataclass(frozen=True)
class Layout:
    """Where each state stands: twists, speeds, motor angle, shaft angles (physical law), actuator torque.

    For two masses: ``twist, speed_motor, speed_load, angle_motor``, then what the laws add.
    """

    drivetrain: Drivetrain
    inputs: tuple[str, ...]

    @cached_property
    def n(self) -> int:
        return len(self.drivetrain.inertias)

    def twist(self, shaft: int) -> int:
        return shaft

    def speed(self, inertia: int) -> int:
        return self.n - 1 + inertia

    @property
    def angle_motor(self) -> int:
        return 2 * self.n - 1

    @cached_property
    def physical(self) -> tuple[int, ...]:
        """Shafts that carry a state of their own."""
        return tuple(i for i, shaft in enumerate(self.drivetrain.shafts) if relaxes(shaft))

    def shaft_angle(self, shaft: int) -> int:
        return 2 * self.n + self.physical.index(shaft)

    @cached_property
    def actuator(self) -> int | None:
        return 2 * self.n + len(self.physical) if self.drivetrain.actuator.lag > 0.0 else None

    @cached_property
    def states(self) -> int:
        return 2 * self.n + len(self.physical) + (self.actuator is not None)

    @cached_property
    def columns(self) -> int:
        return self.states + len(self.inputs) + 1

    def names(self) -> tuple[str, ...]:
        n = self.n
        twists = ["twist"] if n == 2 else [f"twist_{i + 1}" for i in range(n - 1)]
        speeds = [
            "speed_motor",
            *(f"speed_{i + 1}" for i in range(1, n - 1)),
            *(["speed_load"] if n > 1 else []),
        ]
        angles = [f"shaft_angle_{i + 1}" for i in self.physical]
        actuator = ["torque_actuator"] if self.actuator is not None else []
        return (*twists, *speeds, "angle_motor", *angles, *actuator)


#: Signs on which a contact law depends, see ``Element``.
_SIGNS = {"limited": ("sum", "difference"), "clipped": ("sum",)}


def relaxes(shaft: Shaft) -> bool:
    """Whether the shaft's own angle is a state: the physical law with damping (without, it relaxes at once)."""
    return shaft.has_backlash and shaft.contact == "physical" and shaft.damping > 0.0


@dataclass(frozen=True)
class Element:
    """One thing that changes the mode.

    ``shaft``: a shaft with backlash; ``friction``: an inertia with set-valued friction; ``sum`` and ``difference``:
    the sign of k·dz(twist) ± d·rate (digit 1: positive), on which the laws "limited" and "clipped" depend.
    """

    kind: str
    index: int
    digits: int

    @property
    def rest(self) -> int:
        """Digit of the gap, or of standstill."""
        return self.digits // 2


def elements(drivetrain: Drivetrain) -> tuple[Element, ...]:
    shafts = [Element("shaft", i, 3) for i, shaft in enumerate(drivetrain.shafts) if shaft.has_backlash]
    signs = [
        Element(kind, e.index, 2)
        for e in shafts
        for kind in _SIGNS.get(drivetrain.shafts[e.index].contact, ())
    ]
    frictions = [
        Element("friction", i, 2 * max(1, len(friction.stribeck)) + 1)
        for i, friction in enumerate(drivetrain.frictions)
        if friction.sticks and i != drivetrain.locked_inertia
    ]
    return (*shafts, *frictions, *signs)
