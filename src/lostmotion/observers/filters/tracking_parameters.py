"""Start, its variances and the process noise of the filters that track parameters; what these filters give out."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ...drivetrain import Drivetrain
from ...kernels.estimators.layout import ANGLE_COUNTED, MOVING, TRACKED
from ..arguments import known_options
from ..estimates import ESTIMATES, deviations, estimated
from ..scale import scale_of
from .tuning import (
    DRIFT,
    EIGENMODE_SHARE,
    STEPPER_SENSORS,
    UNCERTAINTY,
    Tuning,
    chosen,
    eigenmode_numbers,
)
from .two_mass_parameters import Parameters, model_parameters

#: What is tracked beside the moving states, in the order of the states.
TRACKED_PARAMETERS = ("torque_load", "backlash", "coulomb", "stiffness", "inertia_motor", "inertia_load")

#: Outputs of the filters that track parameters.
TRACKING_OUTPUTS = (
    *ESTIMATES,
    *estimated(*TRACKED_PARAMETERS),
    *deviations("twist", "speed_motor", "speed_load", "torque_shaft", *TRACKED_PARAMETERS),
)

#: Standard deviations at the start: of the twist beside the gap, rad, and of both speeds, rad/s (options); and what the
#: twist drifts in a substep, rad, so that no variance vanishes (numerics).
START_TWIST, START_SPEED, SMALLEST_DRIFT = 1e-4, 0.5, 1e-7

#: The Coulomb level stays within this many start deviations above its start value (numerics: it hardly lies beyond):
#: an estimate that is far too high would hold the load for ever and never learn otherwise.
COULOMB_REACH = 4.0


def tracking_parameters(
    drivetrain: Drivetrain,
    measured: tuple[str, ...],
    dt: float,
    process_torque: Mapping[str, float],
    tuning: Tuning,
    drift: Mapping[str, float] = DRIFT,
) -> Parameters:
    """The record of a filter that tracks parameters.

    ``process_torque`` and ``drift`` are its defaults for a drivetrain of the paper's size.
    """
    known_options("tuning", tuning, Tuning)
    p = model_parameters(
        drivetrain, measured, dt, tuning.get("sensor_noise"), tuning.get("speed_from_counts", False)
    )
    p["eigenmode_share"], p["eigenmode_rate"] = eigenmode_numbers(
        "eigenmode_share", tuning.get("eigenmode_share", EIGENMODE_SHARE), dt
    )
    size = scale_of(drivetrain).torque
    default = {name: value * size for name, value in process_torque.items()}
    torque = chosen("process_torque", default, tuning.get("process_torque"), zero=True)
    drifts, known = (
        chosen(where, {**usual, "torque_load": usual["torque_load"] * size}, given, zero=True)
        for where, usual, given in (
            ("drift", {**DRIFT, **drift}, tuning.get("drift")),
            ("uncertainty", UNCERTAINTY, tuning.get("uncertainty")),
        )
    )
    _fill_start(p, drivetrain, known)
    _fill_process_noise(p, drivetrain, torque, drifts)
    return p


def _units(drivetrain: Drivetrain) -> np.ndarray:
    """Units of the tracked parameters' options; stiffness and inertias are states as factors."""
    return np.array([1.0, drivetrain.backlash, drivetrain.coulomb, 1.0, 1.0, 1.0])


def _fill_start(p: Parameters, drivetrain: Drivetrain, known: Mapping[str, float]) -> None:
    """Start values and their variances.

    The twist lies anywhere in the gap, the load turns about as fast as the motor; the actuator follows its set-point,
    and without variance it costs the unscented filter no points.
    """
    backlash, coulomb, scale = drivetrain.backlash, drivetrain.coulomb, scale_of(drivetrain)
    p["x0"][MOVING:TRACKED] = 0.0, backlash, coulomb, 1.0, 1.0, 1.0
    speed = (START_SPEED * scale.speed) ** 2
    p["P0"][:4] = (0.5 * backlash) ** 2 + (START_TWIST * scale.angle) ** 2, speed, speed, 0.0
    if p["counted"]:
        motor = list(p["kind"][: int(p["sensors"])]).index(STEPPER_SENSORS.index("speed_motor"))
        p["P0"][ANGLE_COUNTED] = p["R"][motor]
    p["P0"][MOVING:TRACKED] = (_units(drivetrain) * [known[name] for name in TRACKED_PARAMETERS]) ** 2
    p["coulomb_bound"] = (1.0 + COULOMB_REACH * known["coulomb"]) * coulomb


def _fill_process_noise(
    p: Parameters, drivetrain: Drivetrain, torque: Mapping[str, float], drifts: Mapping[str, float]
) -> None:
    """Process noise of a substep: unknown torques on both inertias, parameters that drift."""
    dt = float(p["dt"]) / float(p["substeps"])
    motor = (torque["motor"] / drivetrain.inertia_motor) ** 2 * dt
    load = (torque["load"] / drivetrain.inertia_load) ** 2 * dt
    p["Q"][:MOVING] = (SMALLEST_DRIFT * scale_of(drivetrain).angle) ** 2, motor, load, 0.0, 0.0
    p["Q"][MOVING:TRACKED] = (_units(drivetrain) * [drifts[name] for name in TRACKED_PARAMETERS]) ** 2 * dt
