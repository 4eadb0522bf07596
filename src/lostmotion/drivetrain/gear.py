"""Gear: refers a drivetrain to its other side, and back."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from ..recording import unit_of
from .chain import Drivetrain
from .friction import Friction
from .shaft import Shaft


@checks_arguments
@dataclass(frozen=True)
class Gear:
    """A gear without losses: refers what turns behind it to the side before it, and back.

    Behind a gear of ratio i = speed before / speed behind, angles and speeds are i times smaller and torques i times
    larger. Referred to the side before it, inertias, stiffnesses, dampings and viscous frictions are divided by
    i², torques by i, angles (backlash) and speeds multiplied by i: the chain then runs as one of a single speed.

    Parameters
    ----------
    ratio : float
        Speed before the gear over speed behind it; negative where the gear reverses the motion.
    """

    ratio: float

    def __post_init__(self) -> None:
        if not math.isfinite(self.ratio) or self.ratio == 0.0:
            raise InvalidInput(
                "Gear.ratio", repr(self.ratio), "a finite number other than 0", "Give n before / n behind."
            )

    def refer(self, drivetrain: Drivetrain) -> Drivetrain:
        """A drivetrain that stands behind the gear, as it is seen from before it."""
        i = abs(self.ratio)
        return replace(
            drivetrain,
            inertias=tuple(j / i**2 for j in drivetrain.inertias),
            shafts=tuple(
                replace(s, stiffness=s.stiffness / i**2, damping=s.damping / i**2, backlash=s.backlash * i)
                for s in drivetrain.shafts
            ),
            frictions=tuple(self._friction(f) for f in drivetrain.frictions),
            actuator=replace(
                drivetrain.actuator,
                torque_limit=drivetrain.actuator.torque_limit / i,
                rate_limit=drivetrain.actuator.rate_limit / i,
            ),
        )

    def refer_back(self, drivetrain: Drivetrain) -> Drivetrain:
        """The inverse of ``refer``: a referred drivetrain in the units of the side behind the gear."""
        return Gear(1.0 / self.ratio).refer(drivetrain)

    def join(self, before: Drivetrain, shaft: Shaft, behind: Drivetrain) -> Drivetrain:
        """One chain, referred to the side before: `before`, the gear, `shaft` at its output, then `behind`.

        `shaft` is given in the units of the side behind, like `behind`. The actuator is that of `before`.
        """
        link = self.refer(Drivetrain((1.0, 1.0), (shaft,))).shafts[0]
        referred = self.refer(behind)
        return Drivetrain(
            (*before.inertias, *referred.inertias),
            (*before.shafts, link, *referred.shafts),
            (*before.frictions, *referred.frictions),
            before.actuator,
            behind.locked if behind.locked == "load" else before.locked,
        )

    def behind(self, name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
        """A simulated signal of the referred part (``speed_load``, ``torque_shaft_2`` …) as it is behind the gear.

        By the unit of its name: angles and speeds are divided by the ratio, torques multiplied; energies stay.
        """
        factors = {"rad": 1.0 / self.ratio, "rad/s": 1.0 / self.ratio, "Nm": self.ratio, "J": 1.0}
        unit = unit_of(name)
        if unit not in factors:
            raise InvalidInput(
                "Gear.behind",
                repr(name),
                "the name of an angle, a speed, a torque or an energy",
                "Rename it.",
            )
        return np.asarray(factors[unit] * values)

    def _friction(self, friction: Friction) -> Friction:
        i = abs(self.ratio)
        levels = (friction.coulomb_plus / i, friction.coulomb_minus / i)
        return Friction(
            coulomb=levels if self.ratio > 0.0 else levels[::-1],
            viscous=friction.viscous / i**2,
            breakaway=None if friction.breakaway is None else friction.breakaway / i,
            stribeck=tuple((speed * i, torque / i) for speed, torque in friction.stribeck),
        )
