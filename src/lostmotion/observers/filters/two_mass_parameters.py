"""Parameters of the estimators' two-mass model and of their sensors, and the stepper that is made of them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...kernels.estimators.layout import PARAMETERS, flat
from ...systems import Stepper, zero_order_hold
from ...systems.input_check import HOLD
from ..arguments import flag, sample_time, two_masses
from ..model import observer_model
from ..scale import mode_rate, scale_of, sized
from .tuning import SENSOR_NOISE, STEPPER_SENSORS, chosen, speed_of_counts

Array = NDArray[np.float64]
#: One record of ``kernels.estimators.layout``.
Parameters = NDArray[np.void]

#: Standard deviation of the motor's turn by eigenmodes that no two-mass model has, rad: added to the error of a count.
#: Calibration: the virtual rigs 1 to 4, where half and double are 3 % worse in the load speed
#: (benchmarks/calibrations.py).
EIGENMODE_TURN = 1e-5

#: The same of the shaft's twist, rad: added to the error of a torque or twist sensor. Calibration: virtual rigs 1 to 4,
#: where the eigenmode at 750 Hz has 2 Nm on the shaft.
EIGENMODE_TWIST = 1.6e-4

#: A jump is an innovation beyond GATE of its own standard deviations and MISMATCH, in the sensor's unit. Calibration:
#: the virtual rigs 1 to 4, where of jumps of 8 rad/s for 20 ms the extended Kalman filter refuses the first 19.9 ms,
#: with half of it all, with double 18 ms (benchmarks/calibrations.py).
GATE = 4.0
#: Calibration: the same.
MISMATCH: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 0.75, "speed_load": 0.75, "twist": 2.5e-4, "torque_shaft": 7.5}
)
#: A sensor is frozen if the model has moved by so many of its deviations meanwhile. Numerics: of counts that is two and
#: a half, which no speed can hide.
FROZEN_MOVE = 6.0
#: Option: after this time of one value the signal is right and the estimate wrong, s; after ``HOLD`` of jumps, as in
#: laws with a fixed gain.
FROZEN_HOLD = 0.1
#: Option: what a missing motor torque may do to the motor's speed, rad/s² (20 Nm on the paper's rig): the speed then
#: follows its sensor.
TORQUE_MISSING = 1500.0
#: After all sensors were missing the twist drifts for as long again: its variance grows by the square of this, rad/s,
#: per time and per time that they were missing. Calibration: virtual rigs 1 to 4 (11 mrad, about the gap, after 20 ms).
SIDE_UNKNOWN = 0.8
#: Largest standard deviation of the speed while samples are refused as jumps, rad/s. Calibration: the same, where half
#: and double make no difference.
LARGEST_DEVIATION = 10.0
#: Numerics: a sample is predicted in substeps in which the shaft's closed mode turns by at most this angle, rad, since
#: the gap term is held over a substep; 0.25 ms on the paper's rig.
SUBSTEP_TURN = 0.16


def stepper(
    kind: str, outputs: tuple[str, ...], measured: tuple[str, ...], dt: float, parameters: Parameters
) -> Stepper:
    """The estimator of a kind with these parameters; its inputs are the motor torque and what is measured."""
    return Stepper(
        name=kind,
        inputs=("torque_motor", *measured),
        outputs=outputs,
        dt=dt,
        parameters=flat(parameters),
        estimator=kind,
    )


def substeps(drivetrain: Drivetrain, dt: float) -> int:
    """Into how many equal substeps a sample is split."""
    return max(1, math.ceil(mode_rate(drivetrain) * dt / SUBSTEP_TURN))


def transition(drivetrain: Drivetrain, dt: float) -> Array:
    """[Φ Γ] (5, 8): twist, speeds, actuator torque after dt, and the motor's turn.

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
) -> Parameters:
    """The record of model and sensors; start values and process noise are zero."""
    drivetrain, dt = two_masses(drivetrain), sample_time(dt)
    if flag("speed_from_counts", speed_from_counts) and "speed_motor" not in measured:
        raise InvalidInput("speed_from_counts", "True", "speed_motor among the measured signals", "Drop it.")
    shaft, friction = drivetrain.shaft, drivetrain.frictions[1]
    split = substeps(drivetrain, dt)
    rows = transition(drivetrain, dt / split)
    lead = 0.0 if shaft.contact == "dead_zone" else shaft.damping / shaft.stiffness
    level = drivetrain.coulomb
    limit = drivetrain.actuator.torque_limit
    scale = scale_of(drivetrain)
    p = np.zeros((), PARAMETERS)
    p["transition"], p["substeps"], p["dt"] = rows, split, dt
    p["lead_middle"], p["lead"] = lead + 0.5 * dt / split, lead
    p["stiffness"], p["damping"], p["viscous"] = shaft.stiffness, shaft.damping, drivetrain.viscous
    p["coulomb_motor"] = drivetrain.coulomb_motor
    p["inertia_motor"], p["inertia_load"] = drivetrain.inertias
    p["ratio_plus"] = friction.coulomb_plus / level if level > 0.0 else 1.0
    p["ratio_minus"] = friction.coulomb_minus / level if level > 0.0 else 1.0
    p["rest_motor"], p["rest_load"] = 1.0 / abs(rows[1, 6]), 1.0 / abs(rows[2, 7])
    p["torque_bound"] = 2.0 * limit if math.isfinite(limit) else 1e30
    p["torque_missing"] = TORQUE_MISSING * scale.speed * scale.rate
    p["largest_deviation"], p["side_unknown"] = LARGEST_DEVIATION * scale.speed, SIDE_UNKNOWN * scale.speed
    _fill_sensors(p, measured, drivetrain, sensor_noise, speed_from_counts)
    return p


def _fill_sensors(
    p: Parameters,
    measured: tuple[str, ...],
    drivetrain: Drivetrain,
    sensor_noise: Mapping[str, float] | None,
    speed_from_counts: bool,
) -> None:
    """What each sensor shows and how well; a speed from counts is judged by the angle turned, which has one error."""
    scale, dt = scale_of(drivetrain), float(p["dt"])
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
    p["sensors"], p["counted"] = len(measured), float(speed_from_counts)
    p["gate"], p["hold"] = GATE, max(1.0, round(HOLD / dt))
    p["frozen_hold"] = max(3.0, round(FROZEN_HOLD / dt))
    turn, twist = EIGENMODE_TURN * scale.angle, EIGENMODE_TWIST * scale.angle
    for i, name in enumerate(measured):
        counted = speed_from_counts and name == "speed_motor"
        unit = dt if counted else 1.0
        error = (noise[name] * unit) ** 2
        variance = 0.5 * error + turn**2 if counted else error
        if name in ("torque_shaft", "twist"):
            variance += (twist * (drivetrain.stiffness if name == "torque_shaft" else 1.0)) ** 2
        p["kind"][i], p["scale"][i], p["R"][i] = STEPPER_SENSORS.index(name), unit, variance
        p["mismatch"][i], p["still"][i] = mismatch[name] * unit, FROZEN_MOVE * noise[name]
