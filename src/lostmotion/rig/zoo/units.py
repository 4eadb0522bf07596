"""A drive of any size in the virtual rig's units: time, torque and inertia have one each, and angle follows."""

from __future__ import annotations

from dataclasses import dataclass, replace

from ...drivetrain import Actuator, Drivetrain, Friction, Shaft
from ..equivalent import eigenfrequencies
from ..nominal import TORQUE_LIMIT, nominal_rig


@dataclass(frozen=True)
class Units:
    """Units of time (s), torque (Nm) and inertia (kg m²) in which a drive's numbers compare with the virtual rig's."""

    time: float
    torque: float
    inertia: float

    @classmethod
    def of(cls, inertia: float, pole: float, torque: float) -> Units:
        """Those of a drive of this total inertia (kg m²), first mode (Hz) and torque limit (Nm)."""
        rig = nominal_rig().drivetrain
        return cls(float(eigenfrequencies(rig)[1]) / pole, torque / TORQUE_LIMIT, inertia / rig.inertia_total)

    @property
    def angle(self) -> float:
        return self.torque * self.time**2 / self.inertia

    @property
    def speed(self) -> float:
        return self.angle / self.time

    def chain(self, chain: Drivetrain, limit: float) -> Drivetrain:
        """In these units, with that torque limit (Nm)."""
        return replace(
            chain,
            inertias=tuple(inertia / self.inertia for inertia in chain.inertias),
            shafts=tuple(self._shaft(shaft) for shaft in chain.shafts),
            frictions=tuple(self._friction(friction) for friction in chain.frictions),
            actuator=Actuator(chain.lag / self.time, limit / self.torque),
        )

    def _shaft(self, shaft: Shaft) -> Shaft:
        stiffness = self.torque / self.angle
        return replace(
            shaft, stiffness=shaft.stiffness / stiffness, damping=shaft.damping / (stiffness * self.time),
            backlash=shaft.backlash / self.angle,
        )  # fmt: skip

    def _friction(self, friction: Friction) -> Friction:
        return Friction(
            (friction.coulomb_plus / self.torque, friction.coulomb_minus / self.torque),
            friction.viscous * self.speed / self.torque,
            None if friction.breakaway is None else friction.breakaway / self.torque,
            tuple((w / self.speed, torque / self.torque) for w, torque in friction.stribeck),
        )
