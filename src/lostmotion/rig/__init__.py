"""The virtual test rig, a finer plant than the models fitted to it, with sensors; and the zoo of random drives."""

from .equivalent import eigenfrequencies, motor_zeros, two_mass_equivalent
from .finer import finer_rig
from .nominal import TORQUE_LIMIT, Rig, nominal_rig, varied_rig
from .record import Truth, record
from .zoo.bench import Bench, bench
from .zoo.cramer_rao import cramer_rao
from .zoo.draws import SETS
from .zoo.drive import Drive, drive

__all__ = [
    "SETS",
    "TORQUE_LIMIT",
    "Bench",
    "Drive",
    "Rig",
    "Truth",
    "bench",
    "cramer_rao",
    "drive",
    "eigenfrequencies",
    "finer_rig",
    "motor_zeros",
    "nominal_rig",
    "record",
    "two_mass_equivalent",
    "varied_rig",
]
