"""rig.bench: a drive of the zoo as a control law meets it, in the virtual rig's units; nothing is recorded."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...simulation import Sensor
from ..equivalent import friction_line, two_mass_equivalent
from ..nominal import Rig
from .draws import DELAY, Draw
from .drive import motor_sensor
from .motion import raster
from .plants import plant
from .truth import has_soft_clutch
from .units import Units

#: Delay, lag and hold together at most, in torsional periods (option: beyond it no law damps the mode; the rig has
#: 0.05).
LONGEST_DELAY = 0.125
#: Speeds over which the model's friction is the line closest to the true one, rad/s of the rig (option).
SPEEDS = np.linspace(-10.0, 10.0, 2000)


@dataclass(frozen=True, eq=False)
class Bench:
    """A drive with its motor sensor, ready for a law.

    Parameters
    ----------
    seed : int
        Of the drive, see ``drive``.
    rig : Rig
        The chain, limited to its rated torque, and the encoder.
    model : Drivetrain
        The equivalent two masses, the truth as a two-mass model can have it; delay beyond one sample counts as lag.
    dt : float, s
    delay : int
        Whole samples of computing delay.
    """

    seed: int
    rig: Rig
    model: Drivetrain
    dt: float
    delay: int


@checks_arguments
def bench(seed: int) -> Bench | None:
    """The drive of a seed in units in which total inertia, first mode and torque limit are those of the virtual rig.

    Time, torque and inertia have a unit each, and angle follows; so it is the same drive, exactly, and its numbers
    compare with the rig's. None if it has no gap or two, a soft clutch, a sensor without counts, or delays beyond
    ``LONGEST_DELAY``.
    """
    draw = Draw(seed)
    made = plant(draw)
    chain = made.drivetrain
    if not _is_one_gap(chain):
        return None
    dt, _ = raster(draw, made.pole)
    delay = max(1, math.ceil(draw.uniform("delay", *DELAY) / dt))
    sensor, _ = motor_sensor(draw, made, dt)
    if not sensor.difference or (chain.lag + (delay + 0.5) * dt) * made.pole > LONGEST_DELAY:
        return None
    units = Units.of(chain.inertia_total, made.pole, made.rating.torque)
    own = units.chain(chain, made.rating.torque)
    counts = Sensor("angle_motor", sensor.resolution / units.angle, difference=True)
    dt = dt / units.time
    return Bench(seed, Rig(own, {"speed_motor": counts}, seed), _model(own, (delay - 1) * dt), dt, delay)


def _is_one_gap(chain: Drivetrain) -> bool:
    return sum(shaft.has_backlash for shaft in chain.shafts) == 1 and not has_soft_clutch(chain)


def _model(chain: Drivetrain, delay: float) -> Drivetrain:
    values = two_mass_equivalent(chain, SPEEDS)
    ends = {"": chain.frictions[-1], "_motor": chain.frictions[0]}
    for end, friction in ends.items():
        mean = 0.5 * (friction.coulomb_plus + friction.coulomb_minus)
        coulomb, viscous = friction_line(replace(friction, coulomb=mean, breakaway=None), SPEEDS)
        # Where the Stribeck rise ends beyond these speeds the line may fall.
        values |= {f"coulomb{end}": max(coulomb or 0.0, 0.0), f"viscous{end}": max(viscous or 0.0, 0.0)}
    values["lag"] = (values["lag"] or 0.0) + delay
    return Drivetrain.two_mass(**values)  # type: ignore[arg-type]
