"""The numbers of Fietzek & Rinderknecht: what the paper prints, and what follows from it."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from ..drivetrain import Drivetrain

#: Table I, SI; the backlash is the total free angle.
TABLE_I: Mapping[str, float] = MappingProxyType({
    "inertia_motor": 0.0182, "inertia_load": 0.111, "stiffness": 6285.896, "damping": 0.397, "backlash": 0.012,
    "coulomb": 2.0, "viscous": 0.0175,
})  # fmt: skip
#: The paper's symbols for them.
SYMBOLS: Mapping[str, str] = MappingProxyType({
    "inertia_motor": "θ_e", "inertia_load": "θ_w", "stiffness": "k", "damping": "d", "backlash": "β_max",
    "coulomb": "M_c", "viscous": "d_v",
})  # fmt: skip
#: What they are called.
WORDS: Mapping[str, str] = MappingProxyType({
    "inertia_motor": "motor inertia", "inertia_load": "load inertia", "stiffness": "stiffness", "damping": "damping",
    "backlash": "backlash", "coulomb": "Coulomb friction", "viscous": "viscous friction",
})  # fmt: skip
#: First zero, second and third eigenfrequency, Hz; damping ratio; total inertia, kg m² (section II, Table I).
ZERO, POLE, THIRD, DAMPING_RATIO, INERTIA_TOTAL = 38.0, 100.0, 750.0, 0.02, 0.1292

#: Q of equation (8) (section III).
PROCESS_COVARIANCE: Mapping[str, float] = MappingProxyType(
    {"twist": 1.0, "speed_motor": 1000.0, "speed_load": 1000.0}
)
#: R₁ and R₂ of equation (8) (section III).
R_1: Mapping[str, float] = MappingProxyType({"speed_motor": 1.0})
R_2: Mapping[str, float] = MappingProxyType({"torque_shaft": 10.0, "speed_motor": 1.0})  # section III

#: What follows from equations (3) to (8), section V and Table I; the paper prints none of it. Recomputed by hand when
#: the paper was read, and written here to the digits of that reading. Rows of L: twist, motor speed, load speed.
L_1 = (("-0.39988",), ("503.061",), ("-50.4388",))
L_2 = (("0.30749", "-0.031170"), ("-14.8505", "122.939"), ("-4.40545", "3.48512"))
K = ("1345.88", "21.378", "-0.80919")
V, FRICTION_GAIN = "20.5687", "1.2141"

#: The step of the set-point, rad/s, its time and the span of Fig. 12 and 13, s (section IV).
LOW, HIGH, STEP_TIME, SPAN = -2.0, 2.0, 1.0, (0.95, 1.1)
#: Sample time, s (option: 10 kHz).
DT = 1e-4
#: All three poles, 1/s (section V).
POLE_PLACED = -400.0
#: Nominal torque of the motor, Nm (section I).
TORQUE_LIMIT = 73.5

#: Table II: gains of the converter's controllers, in units that the paper does not give (section IV).
TABLE_II: Mapping[str, float] = MappingProxyType(
    {"speed kp": 100.0, "speed ki": 20.0, "current kp": 84.6, "current ki": 50.0}
)
#: Its reading, Nm s/rad and Nm/rad: the one that has the torque and the overshoot of Fig. 12 (section IV).
PI_KP, PI_KI = 10.0, 200.0


def paper_drivetrain(**changed: float) -> Drivetrain:
    """Table I with the paper's own contact law, whose damper acts inside the gap too (equation 3)."""
    return Drivetrain.two_mass(**{**TABLE_I, **changed}, contact="dead_zone")
