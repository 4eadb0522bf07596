"""Friction of one inertia: viscous, Coulomb, breakaway, Stribeck."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

from ..argument_checks import checks_arguments, not_negative
from ..errors import InvalidInput
from .short_repr import call_of


@checks_arguments
@dataclass(frozen=True, repr=False)
class Friction:
    """Friction of one inertia: set-valued at rest, Coulomb + Stribeck + viscous when it turns.

    At speed w ≠ 0 the torque against the motion is ``coulomb + stribeck(abs(w)) + viscous·abs(w)``. At rest the
    inertia stays at rest, exactly, until the torque on it exceeds the breakaway level.

    Parameters
    ----------
    coulomb : float or (float, float), Nm
        One level, or one for positive and one for negative speed.
    viscous : float, Nm s/rad
    breakaway : float, optional, Nm
        Torque that starts the motion; default: the friction torque just above rest.
    stribeck : tuple of (speed, torque)
        Extra torque above Coulomb at the given absolute speeds (rad/s, Nm): the first speed is 0, the last
        torque is 0, linear between, zero beyond.
    """

    coulomb: float | tuple[float, float] = 0.0
    viscous: float = 0.0
    breakaway: float | None = None
    stribeck: tuple[tuple[float, float], ...] = ()

    def __post_init__(self) -> None:
        if isinstance(self.coulomb, (tuple, list)):
            plus, minus = self.coulomb
            levels = (not_negative("Friction.coulomb[0]", plus), not_negative("Friction.coulomb[1]", minus))
            object.__setattr__(self, "coulomb", levels)
        else:
            object.__setattr__(self, "coulomb", not_negative("Friction.coulomb", self.coulomb))
        object.__setattr__(self, "viscous", not_negative("Friction.viscous", self.viscous))
        points = tuple(
            (not_negative("Friction.stribeck", s), not_negative("Friction.stribeck", t))
            for s, t in self.stribeck
        )
        increasing = all(b[0] > a[0] for a, b in zip(points, points[1:], strict=False))
        if points and (points[0][0] != 0.0 or points[-1][1] != 0.0 or not increasing):
            raise InvalidInput(
                "Friction.stribeck",
                repr(points),
                "speeds increasing from 0 and a last torque of 0",
                "Give the torque above the Coulomb level at each absolute speed.",
            )
        object.__setattr__(self, "stribeck", points)
        if self.breakaway is not None:
            level = not_negative("Friction.breakaway", self.breakaway)
            if level < max(self.level_at_rest) * (1.0 - 1e-12):
                raise InvalidInput(
                    "Friction.breakaway",
                    f"{level} Nm",
                    f"at least the friction just above rest, {max(self.level_at_rest)} Nm",
                    "Raise it, or lower coulomb or stribeck.",
                )
            object.__setattr__(self, "breakaway", level)

    def __repr__(self) -> str:
        return call_of(self)

    @property
    def coulomb_plus(self) -> float:
        """Coulomb level at positive speed, Nm."""
        return self.coulomb[0] if isinstance(self.coulomb, tuple) else self.coulomb

    @property
    def coulomb_minus(self) -> float:
        """Coulomb level at negative speed, Nm (a positive number)."""
        return self.coulomb[1] if isinstance(self.coulomb, tuple) else self.coulomb

    @property
    def level_at_rest(self) -> tuple[float, float]:
        """Friction torque just above rest for positive and negative speed, Nm."""
        extra = self.stribeck[0][1] if self.stribeck else 0.0
        return (self.coulomb_plus + extra, self.coulomb_minus + extra)

    @property
    def sticks(self) -> bool:
        """Whether there is a set-valued part: anything but viscous friction."""
        return max(self.level_at_rest) > 0.0 or bool(self.breakaway)

    def _changed(self, values: dict[str, Any]) -> Friction:
        """A copy with some fields changed; the breakaway level is dropped where it is now too low."""
        changed = replace(self, **values, breakaway=None)
        if self.breakaway is None or self.breakaway < max(changed.level_at_rest):
            return changed
        return replace(changed, breakaway=self.breakaway)

    def torque(self, speed: float) -> float:
        """Friction torque (Nm) against the motion at a speed ≠ 0 (rad/s); 0 at rest."""
        if speed == 0.0:
            return 0.0
        magnitude = abs(speed)
        extra = 0.0
        for (s0, t0), (s1, t1) in zip(self.stribeck, self.stribeck[1:], strict=False):
            if s0 <= magnitude < s1:
                extra = t0 + (t1 - t0) * (magnitude - s0) / (s1 - s0)
        level = self.coulomb_plus if speed > 0.0 else self.coulomb_minus
        return math.copysign(level + extra + self.viscous * magnitude, speed)
