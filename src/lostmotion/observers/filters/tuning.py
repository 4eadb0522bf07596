"""How a filter is tuned, in physical terms: one list of options for all of them, their defaults, their check.

Each constant says what kind it is: an option's default, physics or numerics, or a calibration and on which data.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TypedDict

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ..arguments import mapping, positive, sample_time, sensors


class Tuning(TypedDict, total=False):
    """How the Kalman family and the moving horizon are tuned, each a keyword that may be left out.

    Attributes
    ----------
    sensor_noise : mapping of signal → float
        Standard deviation of one sample, in the signal's unit; default ``SENSOR_NOISE``, with ``speed_from_counts``
        that of a 20-bit encoder at this sample time (``speed_of_counts(dt, counts)`` gives it for another one).
    process_torque : mapping
        Torque on ``motor`` and ``load`` that the model leaves out, as the root of its density, Nm·√s: 0.02 is 0.63 Nm
        held for 1 ms each.
    drift, uncertainty : mapping
        How far a parameter drifts within a second, and how well it is known at the start, as standard deviations:
        ``torque_load`` in Nm, all others as fractions of what the drivetrain says. Zero for both holds a parameter.
    eigenmode_share : float
        Standard deviation that eigenmodes beyond the model give to the shaft torque, as a share of its own standard
        deviation over the last ``EIGENMODE_MEMORY``. Counts in torque_shaft_deviation alone; default
        ``EIGENMODE_SHARE``, zero where the model is the plant.
    speed_from_counts : bool
        The measured motor speed is a difference of counts over dt: the sum of its samples, an angle, is filtered, in
        which a count has one error instead of two. Default False.

    Defaults in Nm, rad and rad/s are those of the paper's rig; another drivetrain gets them by ``scale.scale_of``.
    """

    sensor_noise: Mapping[str, float] | None
    process_torque: Mapping[str, float] | None
    drift: Mapping[str, float] | None
    uncertainty: Mapping[str, float] | None
    eigenmode_share: float
    speed_from_counts: bool


#: Sensors of a stepper, in the order of their kinds in ``kernels.estimators.sensor_check``.
STEPPER_SENSORS = ("speed_motor", "speed_load", "twist", "torque_shaft")

#: Option: standard deviation of one sample, but for a speed from counts. Speeds: a 20-bit encoder differenced at 0.1 ms
#: has 0.025 rad/s; torque: a drive's test-rig sensor; twist: 20 bit.
SENSOR_NOISE: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 0.03, "speed_load": 0.03, "twist": 1e-5, "torque_shaft": 0.3}
)

#: Option: encoder that a speed from counts is taken to come from, counts in a turn (20 bit).
COUNTS = 2**20

#: Option: torque that the model does not know, as the root of its density, Nm·√s: 0.02 is 0.63 Nm held for 1 ms each.
PROCESS_TORQUE: Mapping[str, float] = MappingProxyType({"motor": 0.02, "load": 0.02})

#: The same for the filters that track parameters. Calibration: virtual rigs 1 to 4, where with less on the motor a
#: filter grows too sure of itself, and with more it follows an unknown load torque worse and finds the gap worse under
#: control.
TRACKING_TORQUE: Mapping[str, float] = MappingProxyType({"motor": 0.05, "load": 0.02})

#: Option: how far each parameter drifts within a second (standard deviation): ``torque_load`` in Nm, the others as
#: fractions of what the drivetrain says (0.015 follows a wear of 1 % per second, 0.003 a shaft that grows warm).
DRIFT: Mapping[str, float] = MappingProxyType(
    {
        "backlash": 0.015,
        "coulomb": 0.02,
        "torque_load": 0.5,
        "stiffness": 0.003,
        "inertia_motor": 0.003,
        "inertia_load": 0.003,
    }
)

#: Option: how well each is known at the start (standard deviation), in the same units. Stiffness and inertias as an
#: identification gives them: what is 20 % off is found as well, only some tenths of a second later.
UNCERTAINTY: Mapping[str, float] = MappingProxyType(
    {
        "backlash": 0.3,
        "coulomb": 0.15,
        "torque_load": 0.1,
        "stiffness": 0.01,
        "inertia_motor": 0.01,
        "inertia_load": 0.01,
    }
)

#: Option: what eigenmodes beyond a two-mass model add to the shaft torque's standard deviation, as a share of the
#: torque's own over the last EIGENMODE_MEMORY (s): the torque's changes make them swing. Calibration: virtual rigs 1 to
#: 4, where the eigenmode at 750 Hz has 5 Nm on the shaft when the joint opens under hard reversals. (A fixed twist as
#: ``EIGENMODE_TWIST``, right for those, is six times too large in quiet work.)
EIGENMODE_SHARE, EIGENMODE_MEMORY = 0.073, 0.02


def measured_sensors(measured: Sequence[str]) -> tuple[str, ...]:
    """The sensors of a stepper, checked."""
    return sensors(measured, STEPPER_SENSORS)


def chosen(
    where: str, default: Mapping[str, float], given: Mapping[str, float] | None, zero: bool
) -> dict[str, float]:
    """The defaults, changed by what the user gave."""
    given = mapping(where, given)
    unknown = sorted(set(given) - set(default))
    if unknown:
        raise InvalidInput(where, f"{unknown}", f"names out of {tuple(default)}", "Check the names.")
    return {name: positive(f"{where}[{name!r}]", v, zero) for name, v in {**default, **given}.items()}


@checks_arguments
def speed_of_counts(dt: float, counts: float = COUNTS) -> float:
    """Standard deviation (rad/s) of a speed that is a difference of counts over dt: two errors, each even in ±½."""
    counts, dt = positive("counts", counts), sample_time(dt)
    return 2.0 * math.pi / counts / (dt * math.sqrt(6.0))


def eigenmode_numbers(where: str, share: float, dt: float) -> tuple[float, float]:
    """Share and rate for ``kernels.estimators.two_mass_model.eigenmode_variance``."""
    return positive(where, share, zero=True), -math.expm1(-dt / EIGENMODE_MEMORY)
