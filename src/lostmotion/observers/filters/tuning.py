"""Parameters of the observers that are steppers: the model, and a tuning in physical terms."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TypedDict

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import zero_order_hold
from ..arguments import flag, mapping, positive, sample_time, sensors, two_masses
from ..model import observer_model
from ..scale import mode_rate, scale_of, sized

Array = NDArray[np.float64]


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
        How far a parameter wanders within a second, and how well it is known at the start, as standard deviations:
        ``torque_load`` in Nm, all others as fractions of what the drivetrain says. Zero for both holds a parameter.
    mode_share : float
        Standard deviation that modes beyond the model give to the shaft torque, as a share of its own standard
        deviation over the last ``MODE_MEMORY``. Counts in torque_shaft_deviation alone; default ``MODE_SHARE``, zero
        where the model is the plant.
    speed_from_counts : bool
        The measured motor speed is a difference of counts over dt: the sum of its samples, an angle, is filtered, in
        which a count has one error instead of two. Default False.

    Defaults in Nm, rad and rad/s are those of the paper's rig; another drivetrain gets them by ``scale.scale_of``.
    """

    sensor_noise: Mapping[str, float] | None
    process_torque: Mapping[str, float] | None
    drift: Mapping[str, float] | None
    uncertainty: Mapping[str, float] | None
    mode_share: float
    speed_from_counts: bool


#: Sensors of the steppers, in the order of their kinds in ``kernels.estimators.two_mass_model``.
STEPPER_SENSORS = ("speed_motor", "speed_load", "twist", "torque_shaft")

#: Standard deviation of one sample, but for a speed from counts. Speeds: a 20-bit encoder differenced at 0.1 ms has
#: 0.025 rad/s; torque: a drive's test-rig sensor; twist: 20 bit (chosen).
SENSOR_NOISE: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 0.03, "speed_load": 0.03, "twist": 1e-5, "torque_shaft": 0.3}
)

#: Standard deviation of the motor's turn by modes that no two-mass model has, rad: added to the error of a count
#: (chosen: the innovations on the virtual rig are five times those of a 20-bit encoder).
MODES = 1e-5

#: The same of the shaft's twist, rad: added to the error of a torque or twist sensor (chosen on virtual rigs 1 to 4,
#: where the 750 Hz mode has 2 Nm on the shaft).
TWIST_MODES = 1.6e-4

#: What modes beyond a two-mass model add to the shaft torque's standard deviation, as a share of the torque's own over
#: the last MODE_MEMORY (s): the torque's changes make them swing. Chosen on virtual rigs 1 to 4, where the 750 Hz mode
#: has 5 Nm on the shaft when the joint opens under hard reversals. (A fixed twist as TWIST_MODES, right for those, is
#: six times too large in quiet work.)
MODE_SHARE, MODE_MEMORY = 0.073, 0.02

#: Encoder that a speed from counts is taken to come from, counts in a turn (chosen: 20 bit).
COUNTS = 2**20

#: Torque that the model does not know, as the root of its density, Nm·√s: 0.02 is 0.63 Nm held for 1 ms each (chosen).
PROCESS_TORQUE: Mapping[str, float] = MappingProxyType({"motor": 0.02, "load": 0.02})

#: A jump is an innovation beyond GATE of its own standard deviations and MISMATCH, in the sensor's unit: the virtual
#: rig's modes beyond the model throw 0.6 rad/s at hard impacts. A sensor is frozen if the model has moved by FREEZE of
#: its deviations meanwhile (of counts: two and a half, which no speed can hide). All chosen.
GATE, FREEZE = 4.0, 6.0
MISMATCH: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 0.75, "speed_load": 0.75, "twist": 2.5e-4, "torque_shaft": 7.5}
)
#: After this time of rejected samples the signal is right and the estimate wrong, s (chosen): jumps, the same value.
HOLD, FROZEN_HOLD = 0.03, 0.1
#: What a missing motor torque may do to its speed, rad/s² (chosen: 20 Nm on the paper's rig): the speed then follows
#: its sensor.
MISSING_TORQUE = 1500.0
#: After all sensors were missing the twist wanders for as long again: its variance grows by the square of this, rad/s,
#: per time and per time that they were missing (chosen on rigs 1 to 4: by 11 mrad, about the gap, after 20 ms).
BLIND_TWIST = 0.8
#: Largest standard deviation of the speed while samples are refused as jumps, rad/s (chosen: a jump of 8 rad/s is
#: refused for 20 ms).
WORST = 10.0
#: A sample is predicted in pieces in which the shaft's closed mode turns by at most this angle, rad (chosen: the gap
#: term is held over a piece; 0.25 ms on the paper's rig).
PIECE = 0.16


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


def checked_names(tuning: Tuning) -> Tuning:
    """The tuning, if it has no unknown names (which ``**tuning`` lets through)."""
    unknown = sorted(set(tuning) - set(Tuning.__annotations__))
    if unknown:
        raise InvalidInput(
            "tuning", f"{unknown}", f"names out of {tuple(Tuning.__annotations__)}", "Check the names."
        )
    return tuning


def speed_of_counts(dt: float, counts: float = COUNTS) -> float:
    """Standard deviation (rad/s) of a speed that is a difference of counts over dt: two errors, each even in ±½."""
    return 2.0 * math.pi / counts / (dt * math.sqrt(6.0))


def mode_numbers(where: str, share: float, dt: float) -> tuple[float, float]:
    """Share and rate for ``kernels.estimators.two_mass_model.by_modes``."""
    return positive(where, share, zero=True), -math.expm1(-dt / MODE_MEMORY)


def pieces(drivetrain: Drivetrain, dt: float) -> int:
    """Into how many equal pieces a sample is split."""
    return max(1, math.ceil(mode_rate(drivetrain) * dt / PIECE))


def step_matrix(drivetrain: Drivetrain, dt: float) -> Array:
    """(5, 8): twist, speeds, actuator torque after dt, and the motor's turn.

    Columns: the four before, torque, gap, frictions held.
    """
    model = observer_model(drivetrain, ("speed_motor", "angle_motor"))
    b = np.hstack([model.B, model.E_gap, model.E_motor, model.E_load])
    phi, gamma = zero_order_hold(model.A, b, dt)
    rows = np.zeros((5, 8))
    n = phi.shape[0] - 1
    to = [*range(n), 4]
    rows[to, :n], rows[to, 4:] = phi[:, :n], gamma
    return rows


def model_parameters(
    drivetrain: Drivetrain,
    measured: tuple[str, ...],
    dt: float,
    sensor_noise: Mapping[str, float] | None,
    speed_from_counts: bool,
) -> Array:
    """The part of the parameter array that ``kernels.estimators.two_mass_model`` reads; the rest is zero."""
    from ...kernels.estimators import two_mass_model as at

    drivetrain, dt = two_masses(drivetrain), sample_time(dt)
    if flag("speed_from_counts", speed_from_counts) and "speed_motor" not in measured:
        raise InvalidInput("speed_from_counts", "True", "speed_motor among the measured signals", "Drop it.")
    shaft, friction = drivetrain.shaft, drivetrain.frictions[1]
    split = pieces(drivetrain, dt)
    rows = step_matrix(drivetrain, dt / split)
    lead = 0.0 if shaft.contact == "dead_zone" else shaft.damping / shaft.stiffness
    level = drivetrain.coulomb
    limit = drivetrain.actuator.torque_limit
    scale = scale_of(drivetrain)
    p = np.zeros(at.OWN)
    p[at.STEP_MATRIX : at.STEP_MATRIX + 40] = rows.ravel()
    p[at.LEAD_MIDDLE], p[at.LEAD], p[at.PIECES] = lead + 0.5 * dt / split, lead, split
    p[at.STIFFNESS], p[at.DAMPING], p[at.VISCOUS] = shaft.stiffness, shaft.damping, drivetrain.viscous
    p[at.COULOMB_MOTOR] = drivetrain.coulomb_motor
    p[at.INERTIA_MOTOR], p[at.INERTIA_LOAD] = drivetrain.inertias
    p[at.RATIO_PLUS] = friction.coulomb_plus / level if level > 0.0 else 1.0
    p[at.RATIO_MINUS] = friction.coulomb_minus / level if level > 0.0 else 1.0
    p[at.REST_MOTOR], p[at.REST_LOAD] = 1.0 / abs(rows[1, 6]), 1.0 / abs(rows[2, 7])
    p[at.AVERAGED] = float(speed_from_counts)
    p[at.TORQUE_BOUND] = 2.0 * limit if math.isfinite(limit) else 1e30
    p[at.GATE], p[at.HOLD], p[at.DT] = GATE, max(1.0, round(HOLD / dt)), dt
    p[at.N_SENSORS], p[at.FROZEN_HOLD] = len(measured), max(3.0, round(FROZEN_HOLD / dt))
    p[at.MISSING_TORQUE] = MISSING_TORQUE * scale.speed * scale.rate
    p[at.WORST], p[at.BLIND_TWIST] = WORST * scale.speed, BLIND_TWIST * scale.speed
    _fill_sensors(p, measured, dt, drivetrain, sensor_noise, speed_from_counts)
    return p


def _fill_sensors(
    p: Array,
    measured: tuple[str, ...],
    dt: float,
    drivetrain: Drivetrain,
    sensor_noise: Mapping[str, float] | None,
    speed_from_counts: bool,
) -> None:
    """What each sensor shows and how well; a speed from counts is judged by the angle turned, which has one error."""
    from ...kernels.estimators import two_mass_model as at

    scale, stiffness = scale_of(drivetrain), drivetrain.stiffness
    usual = {**SENSOR_NOISE, "torque_shaft": SENSOR_NOISE["torque_shaft"] * scale.torque}
    if speed_from_counts:
        usual["speed_motor"] = speed_of_counts(dt)
    mismatch = sized(MISMATCH, scale)
    noise = chosen("sensor_noise", usual, sensor_noise, zero=False)
    others = sorted(set(sensor_noise or {}) - set(measured))
    if others:
        raise InvalidInput(
            "sensor_noise", f"{others}", f"names out of {measured}", "Measure them, or drop them."
        )
    for i, name in enumerate(measured):
        counted = speed_from_counts and name == "speed_motor"
        unit = dt if counted else 1.0
        p[at.KIND + i], p[at.SCALE + i] = STEPPER_SENSORS.index(name), unit
        error = (noise[name] * unit) ** 2
        p[at.VARIANCE + i] = 0.5 * error + (MODES * scale.angle) ** 2 if counted else error
        if name in ("torque_shaft", "twist"):
            p[at.VARIANCE + i] += (
                TWIST_MODES * scale.angle * (stiffness if name == "torque_shaft" else 1.0)
            ) ** 2
        p[at.MISMATCH + i], p[at.STILL + i] = mismatch[name] * unit, FREEZE * noise[name]


def process_of_torque(drivetrain: Drivetrain, torque: Mapping[str, float], dt: float) -> tuple[float, float]:
    """Variance that the unknown torque adds to the speeds of motor and load in one sample, (rad/s)²."""
    return (
        (torque["motor"] / drivetrain.inertia_motor) ** 2 * dt,
        (torque["load"] / drivetrain.inertia_load) ** 2 * dt,
    )
