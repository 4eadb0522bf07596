"""Moving-horizon estimator: fits the last milliseconds with the piecewise-linear model, contacts included."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

import numpy as np

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...kernels.estimators.layout import HORIZON_PARAMETERS, MOST_NODES
from ...systems import Stepper
from ..arguments import positive
from .tracking_parameters import TRACKING_OUTPUTS, tracking_parameters
from .tuning import TRACKING_TORQUE, Tuning, measured_sensors
from .two_mass_parameters import stepper

#: Numerics: Gauss–Newton passes for each new sample, which starts near its minimum: the horizon of the one before.
PASSES = 2


def moving_horizon(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    horizon: float = 2e-3,
    **tuning: Unpack[Tuning],
) -> Stepper:
    """Moving-horizon estimator of a two-mass drivetrain: states, tuning and outputs of ``extended_kalman``.

    It minimises, over the states x of the last samples::

        |x₀ − arrival|²_P⁻¹ + Σ |x_{k+1} − model(x_k, torque_k)|²_Q⁻¹ + Σ |y_k − ŷ(x_k)|²_R⁻¹

    where the model is piecewise linear (three contact regions, friction slipping or sticking). The arrival estimate
    is the filter's at the horizon's start, along the smoothed trajectory.

    Parameters
    ----------
    horizon : float, s
        Length of the horizon; at least three samples, at most ``MOST_NODES``.
    drivetrain, measured, dt, **tuning
        As in ``extended_kalman``.

    Returns
    -------
    Stepper
        Inputs and outputs of ``extended_kalman``.

    Raises
    ------
    InvalidInput
        As ``extended_kalman``, and for a horizon of too many samples.

    Notes
    -----
    Rostalski, Besselmann, Barić, van Belzen & Morari 2007, Int. J. Control 80, 1729–1740, estimate backlash so by mixed
    integers; here the regions are iterated along the trajectory (Gauss–Newton), which fits the time of a sample.
    """
    measured = measured_sensors(measured)
    p = np.zeros((), HORIZON_PARAMETERS)
    p["common"] = tracking_parameters(drivetrain, measured, dt, TRACKING_TORQUE, tuning)
    nodes = max(3, round(positive("horizon", horizon) / dt))
    if nodes > MOST_NODES:
        raise InvalidInput(
            "horizon", f"{nodes} samples", f"at most {MOST_NODES}", "Shorten it or sample more slowly."
        )
    p["nodes"], p["passes"] = nodes, PASSES
    return stepper("moving_horizon", TRACKING_OUTPUTS, measured, dt, p)
