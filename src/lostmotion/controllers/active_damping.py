"""Active damping (anti-jerk) of a drive that is asked for a torque."""

from __future__ import annotations

import math

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from ..systems.checks import sample_time
from .feedback.limited_torque import limited_torque

#: Damping ratio of the shaft's eigenmode by default (option: no overshoot worth mentioning, and no slower than needed).
DAMPING_RATIO = 0.5


@checks_arguments
def active_damping(
    drivetrain: Drivetrain,
    *,
    dt: float,
    damping_ratio: float = DAMPING_RATIO,
    torque_limit: float = math.inf,
) -> DiscreteSystem:
    """Torque as asked for, less what damps the shaft: a virtual damper between motor and load.

    ::

        torque_motor = clip(torque_reference − D·(speed_motor − speed_load), ±torque_limit)
        D = inertia_motor·(2·damping_ratio·ω − damping/inertia_reduced)
        ω = √(stiffness/inertia_reduced)        1/inertia_reduced = 1/inertia_motor + 1/inertia_load

    Both speeds are equal in steady state and under a steady acceleration, so the drive gives the torque that it is
    asked for. Current loop and computing delay are left out: they take away damping where ω·(lag + 1.5·dt) nears 1.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
    damping_ratio : float
        Of the eigenmode with the gap closed; at least what the shaft has itself.
    torque_limit : float, Nm
        inf: no limit.

    Returns
    -------
    DiscreteSystem
        Inputs torque_reference, speed_motor_estimated, speed_load_estimated; output torque_motor.

    Raises
    ------
    InvalidInput
        If there are not two masses, a number is not positive, or the shaft's own damping is larger than asked for.

    Notes
    -----
    Amann, Böcker & Prenner 2004, IEEE/ASME Trans. Mechatronics 9, 305–311 (damping of drivetrain oscillations by an
    observer); soft landing behind it takes care of the gap.
    """
    dt = sample_time("active_damping.dt", dt)
    reduced = 1.0 / (1.0 / drivetrain.inertia_motor + 1.0 / drivetrain.inertia_load)
    own = drivetrain.damping / (2.0 * math.sqrt(drivetrain.stiffness * reduced))
    if not (math.isfinite(damping_ratio) and damping_ratio >= own):
        raise InvalidInput(
            "active_damping.damping_ratio",
            repr(damping_ratio),
            f"at least the shaft's own, {own:.3g}",
            "0.5 is usual.",
        )
    rate = 2.0 * math.sqrt(drivetrain.stiffness / reduced) * (damping_ratio - own)
    gain = drivetrain.inertia_motor * rate
    gains = {"torque_reference": 1.0, "speed_motor_estimated": -gain, "speed_load_estimated": gain}
    return limited_torque("active_damping", gains, dt=dt, torque_limit=torque_limit)
