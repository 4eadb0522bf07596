"""Intelligent observer: networks of radial basis functions learn the friction and the gap curve while it runs."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from ...drivetrain import Drivetrain
from ...kernels.estimators.layout import GAP_CENTRES, GAP_WEIGHTS, NETWORK_PARAMETERS
from ...systems import Stepper
from ..arguments import positive
from ..estimates import ESTIMATES
from ..filters.two_mass_parameters import Array, stepper
from ..fixed_gain.kalman import kalman
from ..scale import scale_of
from .parameters import Following, speed_only_parameters

OUTPUTS = (*ESTIMATES, "backlash_estimated")

#: Standard deviation of the innovation that the learning expects, rad/s. Calibration: the virtual rigs 1 to 4 with a
#: load inertia 20 % too small, where half is a tenth worse and double as good (benchmarks/calibrations.py).
INNOVATION = 0.16

#: Option: defaults of the arguments on the paper's rig, Nm, rad, rad/s and rad; the two angles at least so large.
FRICTION_ERROR, GAP_ERROR, SPEED_RANGE, TWIST_RANGE = 1.4, 1e-3, 30.0, 8e-3

#: Process covariance of the gain soon after all inputs were missing, (unit of the state)²/s. Calibration: virtual
#: rigs 1 to 4; with Observer 1's own, whose slow pole is at 20 1/s, it is not back within 50 ms.
AFTER_BLACKOUT: Mapping[str, float] = MappingProxyType(
    {"twist": 40.0, "speed_motor": 1e7, "speed_load": 42.0}
)


def neural_network(
    drivetrain: Drivetrain,
    *,
    dt: float,
    friction_error: float | None = None,
    gap_error: float | None = None,
    learning_time: float = 3.0,
    speed_range: float | None = None,
    twist_range: float | None = None,
    sensor_noise: float | Mapping[str, float] | None = None,
    speed_from_counts: bool = False,
) -> Stepper:
    """Observer 1 with two networks: one adds to the friction over the load speed, one to the gap curve over the twist.

    ::

        friction = model + Σ θᵢ φᵢ(speed_load),   gap = clip(z, ±backlash/2) + Σ βⱼ ψⱼ(z)
        θ⁺ = θ + η χ e / (r + Σ η χ²),   χ = H(z)·φ: the basis, filtered by the observer's own dynamics

    After all inputs were missing at once, it corrects by a faster gain (``AFTER_BLACKOUT``) and learns nothing for a
    while.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; its friction and backlash are the start, what they miss is learned.
    dt : float, s
    friction_error, gap_error : float, Nm and rad, optional
        How far the start may be off; defaults ``FRICTION_ERROR``, by ``scale.scale_of`` for a drivetrain of another
        size, and half of the backlash.
    learning_time : float, s
        Time in which an error of that size is learned where the drivetrain dwells.
    speed_range, twist_range : float, rad/s and rad
        The networks cover ± these (defaults ``SPEED_RANGE``, by ``scale.scale_of``, and 1.5 backlashes), denser at
        low speeds; beyond, the curves go on as constants.
    sensor_noise, speed_from_counts
        See ``parameters.Following``.

    Returns
    -------
    Stepper
        Inputs torque_motor, speed_motor; outputs ``OUTPUTS``. ``backlash_estimated`` is the total height of the learned
        gap curve.

    Raises
    ------
    InvalidInput
        If an error, a range or a time is not positive, or for another number out of range.

    Notes
    -----
    Schröder (ed.) 2000, Intelligent Observer and Control Design for Nonlinear Systems: separable
    nonlinearities at known places, error transfer function, normalised radial basis (GRNN). Gain: that of ``kalman``.
    """
    from ...kernels.estimators.motor_speed.neural_network import basis

    sensor = Following(sensor_noise=sensor_noise, speed_from_counts=speed_from_counts)
    p = speed_only_parameters(drivetrain, dt, sensor, NETWORK_PARAMETERS)
    scale, backlash = scale_of(drivetrain), drivetrain.backlash
    twist_range = max(1.5 * backlash, TWIST_RANGE * scale.angle) if twist_range is None else twist_range
    gap_error = max(0.5 * backlash, GAP_ERROR * scale.angle) if gap_error is None else gap_error
    friction_error = FRICTION_ERROR * scale.torque if friction_error is None else friction_error
    speed_range = SPEED_RANGE * scale.speed if speed_range is None else speed_range
    gap, friction = positive("gap_error", gap_error), positive("friction_error", friction_error)
    share = dt / positive("learning_time", learning_time)
    p["gain"] = _gain(drivetrain, dt, speed_from_counts)
    p["fast_gain"] = _gain(drivetrain, dt, speed_from_counts, AFTER_BLACKOUT)
    p["twist_range"] = positive("twist_range", twist_range)
    p["speed_range"] = positive("speed_range", speed_range)
    p["step_gap"], p["step_friction"] = gap**2 * share, friction**2 * share
    p["innovation_variance"] = (INNOVATION * scale.speed) ** 2
    p["bound_gap"], p["bound_friction"] = 5.0 * gap, 5.0 * friction
    ends = np.empty(GAP_CENTRES)
    basis(1.0, GAP_CENTRES, ends)
    p["end_basis"] = ends[GAP_WEIGHTS + 1 :] - ends[:GAP_WEIGHTS][::-1]
    return stepper("neural_network", OUTPUTS, ("speed_motor",), dt, p)


def _gain(
    drivetrain: Drivetrain, dt: float, speed_from_counts: bool, process: Mapping[str, float] | None = None
) -> Array:
    """Observer 1's gain on twist, speed_motor, speed_load, torque_actuator, speed_motor_previous."""
    observer = kalman(drivetrain, dt=dt, speed_from_counts=speed_from_counts, process_covariance=process)
    column = observer.B[:, observer.inputs.index("speed_motor")]
    order = ("twist", "speed_motor", "speed_load", "torque_actuator", "speed_motor_previous")
    at = {name: float(column[i]) for i, name in enumerate(observer.states)}
    return np.array([at.get(name, 0.0) for name in order])
