"""Extended Kalman filter that knows its backlash: what may be wrong or change is a state."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Unpack

from ...drivetrain import Drivetrain
from ...systems import Stepper
from .tracking_parameters import TRACKING_OUTPUTS, tracking_parameters
from .tuning import TRACKING_TORQUE, Tuning, measured_sensors
from .two_mass_parameters import stepper


def extended_kalman(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    **tuning: Unpack[Tuning],
) -> Stepper:
    """Extended Kalman filter of a two-mass drivetrain that tracks backlash, friction, load torque, stiffness, inertia.

    The model is that of ``kalman``. The dead zone enters by its mean over the estimate's own spread, so the filter
    knows that contact is uncertain near the edge of the gap. ``stiffness`` stands for the whole shaft: its damping is
    multiplied by the same factor.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; its backlash, Coulomb level, stiffness and inertias are the start values.
    measured : sequence of str
        Any of speed_motor, speed_load, twist, torque_shaft (SI units).
    dt : float, s
        Sample time.
    **tuning
        See ``tuning.Tuning``; defaults ``TRACKING_TORQUE``, ``DRIFT``, ``UNCERTAINTY``. Stiffness and inertias are
        held between half and twice of what the drivetrain says.

    Returns
    -------
    Stepper
        Inputs torque_motor and ``measured``; outputs ``TRACKING_OUTPUTS``. The estimates of a sample use the
        measurement of that sample.

    Raises
    ------
    InvalidInput
        For unknown names and for numbers out of range.

    Notes
    -----
    After Lagerberg & Egardt 2007, IEEE Trans. Control Systems Technology 15, 483–493; dead zone by statistical
    linearisation (Gelb 1974, Applied Optimal Estimation, chapter 6).
    """
    measured = measured_sensors(measured)
    parameters = tracking_parameters(drivetrain, measured, dt, TRACKING_TORQUE, tuning)
    return stepper("extended_kalman", TRACKING_OUTPUTS, measured, dt, parameters)
