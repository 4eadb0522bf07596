"""The virtual test rig's plant: finer than every model fitted to it, varied by a seed.

Made from the finite-element model of the powertrain of Fietzek & Rinderknecht, ``structure.paper_powertrain``: motor –
clutch – intermediate shaft – side shaft – tripod joint – wheel hub with brake disc; eigenmodes at 100 and 750 Hz, motor
zero at 38 Hz, 0.1292 kg m². It is reduced to four inertias with the gap in the third shaft.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import Actuator, Drivetrain, Friction, Shaft
from ..errors import InvalidInput
from ..simulation import Sensor

#: Motor; clutch and intermediate shaft; intermediate inertia at the end of the side shaft; hub with brake disc. kg m².
#: With the stiffnesses: ``reduce_to_chain(paper_powertrain(), 4, gap=GAP, band=(5, 900), gap_shaft=2)``, rounded.
#: (Physics.)
INERTIAS = (0.014204, 0.005137, 0.000450, 0.109409)
#: Clutch, side shaft, tripod joint, Nm/rad (physics).
STIFFNESSES = (80088.0, 7359.0, 88171.0)
#: The paper's damping ratio (section II), given to the 750 Hz eigenmode by the clutch, to the 100 Hz eigenmode by the
#: side shaft.
DAMPING_RATIO = 0.02
#: Relaxation rate k/d of the joint's contact in 1/s: that of the paper's Table I.
CONTACT_POLE = 15833.0
#: Total free angle of the tripod joint, rad (Table I).
BACKLASH = 0.012
#: Friction at the brake disc: Table I, and a Stribeck rise (option) of 15 % at rest that ends at 2 rad/s.
COULOMB, VISCOUS = 2.0, 0.0175
#: The rise: speed, rad/s, and torque, Nm (option).
STRIBECK = ((0.0, 0.30), (0.4, 0.16), (1.0, 0.05), (2.0, 0.0))
#: Torque lag of the current loop, s, and largest torque, Nm (lag option; torque: the paper's nominal torque).
LAG, TORQUE_LIMIT = 3e-4, 73.5

#: Range of the seeds' variation (option): inertias and stiffnesses, friction and backlash.
SPREAD_STRUCTURE, SPREAD_FRICTION = 0.10, 0.20

#: Motor encoder: 20 bit in one turn, as sin/cos encoders with interpolation have; speed from count differences.
#: (Option.)
MOTOR_ENCODER_BITS = 20
#: Validation encoder at the hub, interpolated to 24 bit; validation torque sensor on the side shaft, 0.3 Nm (option).
HUB_ENCODER_BITS, TORQUE_NOISE = 24, 0.3


@dataclass(frozen=True)
class Rig:
    """A virtual rig: its true plant and its sensors. No estimator may use its values."""

    drivetrain: Drivetrain
    sensors: dict[str, Sensor]
    seed: int | None


def nominal_rig() -> Rig:
    """The rig without variation."""
    return make_rig(INERTIAS, STIFFNESSES, BACKLASH, COULOMB, VISCOUS, seed=None)


@checks_arguments
def varied_rig(seed: int) -> Rig:
    """One rig of the family: every inertia and stiffness within ±10 %, friction and backlash within ±20 %."""
    if seed < 0:
        raise InvalidInput("varied_rig: seed", f"{seed}", "0 or a positive number", "Choose another seed.")
    rng = np.random.default_rng([seed, 20])
    structure = 1.0 + SPREAD_STRUCTURE * rng.uniform(-1.0, 1.0, 7)
    friction = 1.0 + SPREAD_FRICTION * rng.uniform(-1.0, 1.0, 3)
    return make_rig(
        tuple(float(j * f) for j, f in zip(INERTIAS, structure[:4], strict=True)),
        tuple(float(k * f) for k, f in zip(STIFFNESSES, structure[4:], strict=True)),
        float(BACKLASH * friction[0]),
        float(COULOMB * friction[1]),
        float(VISCOUS * friction[2]),
        seed=seed,
    )


def make_rig(
    inertias: tuple[float, ...],
    stiffnesses: tuple[float, ...],
    backlash: float,
    coulomb: float,
    viscous: float,
    seed: int | None,
) -> Rig:
    """A rig with the given structure and friction; damping, contact, sensors and actuator follow the nominal one."""
    clutch, side, joint = stiffnesses
    shafts = (
        Shaft(clutch, 2.0 * DAMPING_RATIO / (2.0 * math.pi * 750.0) * clutch),
        Shaft(side, 2.0 * DAMPING_RATIO / (2.0 * math.pi * 100.0) * side),
        Shaft(joint, joint / CONTACT_POLE, backlash, "physical"),
    )
    disc = Friction(coulomb, viscous, stribeck=tuple((s, t * coulomb / COULOMB) for s, t in STRIBECK))
    return Rig(
        drivetrain=Drivetrain(
            inertias, shafts, (Friction(), Friction(), Friction(), disc), Actuator(LAG, TORQUE_LIMIT)
        ),
        sensors={
            "speed_motor": Sensor("angle_motor", 2.0 * math.pi / 2**MOTOR_ENCODER_BITS, difference=True),
            "speed_load": Sensor("angle_load", 2.0 * math.pi / 2**HUB_ENCODER_BITS, difference=True),
            "torque_shaft": Sensor("torque_shaft", noise=TORQUE_NOISE),
            "twist": Sensor("twist", 2.0 * math.pi / 2**MOTOR_ENCODER_BITS),
        },
        seed=seed,
    )
