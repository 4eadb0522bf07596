"""Every number of the estimators by name: their parameters, and what they remember from one sample to the next.

Parameters and memory of an estimator are flat float64 arrays, so that a law is data and a run can go on from any
state. These records say what stands where; ``records.reads`` makes them readable for kernels, and numpy's ``view`` for
everyone else. SI units. The order is that of saved laws: new fields go to the end.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Record = np.dtype[Any]

#: Most sensors of an estimator (layout).
SENSORS = 4

# States of the two-mass model. ``ANGLE_COUNTED`` is the angle that the motor has turned since its encoder last counted.
TWIST, SPEED_MOTOR, SPEED_LOAD, TORQUE_ACTUATOR, ANGLE_COUNTED = 0, 1, 2, 3, 4
#: These states move; what a filter adds to them are parameters that drift (random walks) (layout).
MOVING = 5
#: Inputs of the model: columns of ``transition`` beside those of the first four states.
TORQUE, GAP, FRICTION_MOTOR, FRICTION_LOAD = 4, 5, 6, 7

# States of the filters that track parameters. The last three are factors: of the shaft's torque and of both inverse
# inertias.
TORQUE_LOAD, BACKLASH, COULOMB, STIFFNESS, INVERSE_INERTIA_MOTOR, INVERSE_INERTIA_LOAD = 5, 6, 7, 8, 9, 10
#: Layout.
TRACKED = 11

# States of each interacting model beside those of the two-mass model and ``TORQUE_LOAD`` (layout).
MODEL_COULOMB, MODEL_STATES, MODELS = 6, 7, 3

#: Most samples of a horizon (layout).
MOST_NODES = 60

# Network of the gap curve and of the friction. The gap curve is odd: each weight serves two of its centres, and the one
# in the middle is zero. (A constant in the gap curve only moves the zero of the twist, which no speed can tell.)
#: (Option: how fine the curves are.)
GAP_CENTRES, GAP_WEIGHTS, FRICTION_WEIGHTS = 17, 8, 13
WEIGHTS = GAP_WEIGHTS + FRICTION_WEIGHTS


def record(*fields: Any) -> Record:
    """A record of float64; each field is a name, or a name and a shape, or a name, its record and how many of them."""
    return np.dtype([_field(field) for field in fields])


def _field(field: Any) -> Any:
    if isinstance(field, str):
        return field, float
    name, *what = field
    return (name, float, *what) if isinstance(what[0], tuple) else field


def size(layout: Record) -> int:
    """How many numbers a record holds."""
    return layout.itemsize // 8


def place(layout: Record, field: str) -> int:
    """Where a field of a record begins, in numbers."""
    assert layout.fields is not None
    return int(layout.fields[field][1]) // 8


def flat(values: NDArray[np.void]) -> NDArray[np.float64]:
    """The numbers of one record as a flat array."""
    return values.reshape(1).view(np.float64)


def estimate(states: int) -> Record:
    """Mean x and covariance P of an estimate."""
    return record(("x", (states,)), ("P", (states, states)))


#: Parameters of every estimator: the two-mass model, noise, sensors, and what is done about missing and bad samples.
PARAMETERS = record(
    # [Φ Γ] over a substep; rows: the four moving states and the motor's turn; columns: four states, four inputs.
    ("transition", (5, 8)),
    # s: z = twist + lead·rate, at the middle of the substep and at its start.
    "lead_middle", "lead",
    "stiffness", "damping", "viscous", "coulomb_motor",
    # Coulomb level of each direction over their mean.
    "ratio_plus", "ratio_minus",
    # Nm per rad/s that bring an inertia to rest within a substep.
    "rest_motor", "rest_load",
    "substeps",  # of a sample
    "counted",  # 1 if the measured motor speed comes from counts
    "torque_bound",  # a motor torque beyond it is missing
    # Limit of an innovation in its standard deviations; samples that may be refused in a row; s.
    "gate", "hold", "dt",
    # Start values, their variances, process noise of a substep.
    ("x0", (TRACKED,)), ("P0", (TRACKED,)), ("Q", (TRACKED,)),
    # Of each sensor: what it measures, factor on its value (see ``sensor_check``), variance of that, further innovation
    # that the model's own error may make, change of the predicted value below which it may stand still.
    ("kind", (SENSORS,)), ("scale", (SENSORS,)), ("R", (SENSORS,)), ("mismatch", (SENSORS,)), ("still", (SENSORS,)),
    "sensors",  # how many there are
    "coulomb_bound",  # largest Coulomb level that is accepted
    "frozen_hold",  # samples
    "inertia_motor", "inertia_load",
    "eigenmode_share", "eigenmode_rate",  # see ``two_mass_model.eigenmode_variance``
    # See ``missing_inputs``: rad/s², rad/s, rad/s.
    "torque_missing", "largest_deviation", "side_unknown",
)  # fmt: skip

#: What a sensor showed: its last value, how often that came in a row, how far the model has moved since, samples
#: refused in a row, and the smallest step that the value ever made (0 if none): its resolution.
SENSOR_MEMORY = record("value", "repeats", "moved", "refused", "resolution")

#: Recent mean and variance of the estimated shaft torque.
TORQUE_MOMENTS = record("mean", "variance")

#: A contact that is predicted but may be none, see ``contact``: torque that it should make, variances of the twist
#: against the edge and of the load speed before it, log-odds against it, its impulse so far.
CONTACT = record("torque", "variance", "speed_variance", "log_odds", "impulse")

TRACKED_ESTIMATE = estimate(TRACKED)

#: Memory of the filters that track parameters: whether there was a sample; the last motor torque; the load's Coulomb
#: torque; the four moving states before the last prediction; ``blind``: see ``missing_inputs``.
TRACKING = record(
    ("estimate", TRACKED_ESTIMATE), "started", "torque", "friction", ("before", (4,)),
    ("sensors", SENSOR_MEMORY, SENSORS), ("torque_moments", TORQUE_MOMENTS), "blind", ("contact", CONTACT),
)  # fmt: skip

#: A sample of the horizon: trajectory, torque, measurements, 1 where one is used, 1 if the torque was missing,
#: ``blind``.
NODE = record(
    ("x", (TRACKED,)), "torque", ("value", (SENSORS,)), ("used", (SENSORS,)), "torque_missing", "blind"
)
HORIZON_PARAMETERS = record(("common", PARAMETERS), "nodes", "passes")
#: Memory of the moving horizon: the newest estimate, nodes in use, the arrival estimate, the nodes.
HORIZON = record(("filter", TRACKING), "count", ("arrival", TRACKED_ESTIMATE), ("nodes", NODE, MOST_NODES))

#: Half of the backlash; chance, within a substep, that a model begins anew; exponent of the likelihood; process noise
#: of the twist in the gap.
INTERACTING_PARAMETERS = record(("common", PARAMETERS), "half_gap", "anew", "likelihood_share", "gap_Q")
#: Memory of the interacting models: one estimate for each, their probabilities; ``before`` as above, of the mixture.
INTERACTING = record(
    ("models", estimate(MODEL_STATES), MODELS), ("probability", (MODELS,)), "started", "torque", "friction",
    ("before", (3,)), ("sensors", SENSOR_MEMORY, SENSORS), ("torque_moments", TORQUE_MOMENTS), "blind",
)  # fmt: skip

#: Parameters of the observers with one sensor, the motor speed: half of the backlash, Coulomb level; largest innovation
#: expected, and its growth per sample without a used measurement, both over the gate; the sensor's deviation as given,
#: and how much that of its resolution adds.
SPEED_PARAMETERS = record(
    ("common", PARAMETERS), "half_gap", "coulomb", "expected", "growth", "noise", "coarser"
)
#: Memory of these observers; ``moved``: change of the motor speed by the model over the last sample; ``unused``:
#: samples of the speed refused in a row; ``given``: what a value that came again has corrected so far; ``blind``:
#: samples without torque and speed, which fade.
SPEED_OBSERVER = record(
    ("x", (MOVING,)), "started", "torque", "friction", "moved", "unused", "given", "blind",
    ("sensor", SENSOR_MEMORY),
)  # fmt: skip

#: Largest correction of the motor speed per sample, innovation at which it is reached; corrections of twist and load
#: speed per correction of the motor speed, correction of the angle per innovation.
SLIDING_PARAMETERS = record(("common", SPEED_PARAMETERS), "reach", "layer", "to_twist", "to_load", "to_angle")

#: Gain on the root of the innovation and gain of the integral (both per sample), bound of the integral, innovation
#: below which the sign is a line, corrections of twist and load speed per integral, inertia over sample time,
#: correction of the angle per innovation.
TWISTING_PARAMETERS = record(
    ("common", SPEED_PARAMETERS), "root", "integral", "bound", "layer", "to_twist", "to_load", "inertia", "to_angle",
)  # fmt: skip
#: The integral, which is the correction of the motor speed per sample, and what it was before the sensor's value came.
TWISTING = record(("common", SPEED_OBSERVER), "integral", "integral_before")

#: Gain of the observer, that soon after all inputs were missing; range of the twist and of the load speed; learning
#: steps; variance of the innovation; largest weights; the gap's basis at the end of its range.
NETWORK_PARAMETERS = record(
    ("common", SPEED_PARAMETERS), ("gain", (MOVING,)), ("fast_gain", (MOVING,)), "twist_range", "speed_range",
    "step_gap", "step_friction", "innovation_variance", "bound_gap", "bound_friction", ("end_basis", (GAP_WEIGHTS,)),
)  # fmt: skip
#: Weights, and the filtered response to each: twist, speed_motor, speed_load, speed_motor of the sample before.
NETWORK = record(("common", SPEED_OBSERVER), ("weights", (WEIGHTS,)), ("responses", (WEIGHTS, 4)))
