"""Moving-horizon estimator: fits the last milliseconds with the piecewise-linear model, contacts included."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

import numpy as np

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import Stepper
from ..arguments import positive
from .extended_kalman import PROCESS_TORQUE, TRACKING_OUTPUTS, tracking_parameters
from .tuning import Tuning, measured_sensors

#: Most samples of a horizon, and Gauss–Newton passes for each new sample (chosen: 200 µs per sample).
MAX_NODES, PASSES = 60, 2


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
        Length of the horizon; at least three samples, at most ``MAX_NODES``.
    drivetrain, measured, dt, **tuning
        As in ``extended_kalman``.

    Returns
    -------
    Stepper
        Inputs torque_motor and ``measured``; outputs ``extended_kalman.TRACKING_OUTPUTS``.

    Raises
    ------
    InvalidInput
        For unknown names, numbers out of range, a horizon of too many samples.

    Notes
    -----
    Rostalski, Besselmann, Barić, van Belzen & Morari 2007, Int. J. Control 80, 1729–1740, estimate backlash so by mixed
    integers; here the regions are iterated along the trajectory (Gauss–Newton), which fits the time of a sample.
    """
    from ...kernels.estimators import moving_horizon as kernel
    from ...kernels.estimators import two_mass_model as at

    measured = measured_sensors(measured)
    p = np.zeros(kernel.PASSES + 1)
    p[: at.OWN] = tracking_parameters(drivetrain, measured, dt, PROCESS_TORQUE, tuning)
    nodes = max(3, round(positive("horizon", horizon) / dt))
    if nodes > MAX_NODES:
        raise InvalidInput(
            "horizon", f"{nodes} samples", f"at most {MAX_NODES}", "Shorten it or sample more slowly."
        )
    p[kernel.NODES], p[kernel.PASSES] = nodes, PASSES
    return Stepper(
        name="moving_horizon",
        inputs=("torque_motor", *measured),
        outputs=TRACKING_OUTPUTS,
        dt=dt,
        parameters=p,
        estimator="moving_horizon",
    )
