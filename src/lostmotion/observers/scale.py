"""How large a drivetrain's torques, angles and speeds are: what the observers' defaults are measured in."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

from ..drivetrain import Drivetrain


class Scale(NamedTuple):
    """A drivetrain's natural units over those of the rig on which the defaults were chosen (the paper's Table I)."""

    torque: float
    angle: float
    speed: float
    rate: float  # 1/s, of the closed shaft's mode
    inertia: float  # of both masses

    @property
    def impedance(self) -> float:
        """Torque over speed."""
        return self.torque / self.speed


#: Friction counts at least as this part of the torque that winds the shaft by its backlash, and that torque at least as
#: so many times the friction (option: a drive without one of them still has a size).
LEAST_FRICTION, LEAST_WINDING = 5e-3, 5.0


def mode_rate(drivetrain: Drivetrain) -> float:
    """Angular frequency of the closed shaft's mode without damping, 1/s."""
    return math.sqrt(drivetrain.stiffness * sum(1.0 / inertia for inertia in drivetrain.inertias))


def scale_of(drivetrain: Drivetrain) -> Scale:
    """The scale of a two-mass drivetrain.

    Its torque is the geometric mean of Coulomb friction and of what winds the shaft by the backlash (12 Nm for the
    paper's rig, which works with 4 to 20 Nm), its angle what this torque winds, its speed that angle at the frequency
    of the closed shaft. A drivetrain with neither friction nor backlash counts as the paper's rig wound as far.
    """
    paper, inertia = PAPER.inertias, sum(drivetrain.inertias)
    angle, rate = _angle(drivetrain) / _angle(PAPER), mode_rate(drivetrain) / mode_rate(PAPER)
    torque = angle * drivetrain.stiffness / PAPER.stiffness
    return Scale(torque, angle, angle * rate, rate, inertia / sum(paper))


def sized(values: Mapping[str, float], scale: Scale) -> dict[str, float]:
    """Numbers of signals as they are on the paper's rig, for a drivetrain of this scale."""
    unit = {"speed_motor": scale.speed, "speed_load": scale.speed, "torque_shaft": scale.torque}
    return {name: value * unit.get(name, scale.angle) for name, value in values.items()}


def _angle(drivetrain: Drivetrain) -> float:
    winding = max(drivetrain.stiffness * drivetrain.backlash, LEAST_WINDING * drivetrain.coulomb)
    friction = max(drivetrain.coulomb, LEAST_FRICTION * winding)
    return math.sqrt(winding * friction) / drivetrain.stiffness or _angle(PAPER)


#: Table I of Fietzek & Rinderknecht.
PAPER = Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
    viscous=0.0175,
)  # fmt: skip
