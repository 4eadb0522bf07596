"""The linear drivetrain equivalent to one with gap and friction under a random torque: describing functions."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...argument_checks import checks_arguments, not_negative
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from .two_mass_response import two_mass_response

Floats = NDArray[np.float64]

#: Step towards the new gains, most steps, and relative change at which the iteration ends (numerics:
#: half steps damp the iteration).
STEP, MOST_STEPS, SETTLED = 0.5, 400, 1e-6
#: Least gain of the gap that is tried: below, the shaft is hardly ever in contact (numerics).
LEAST_GAIN = 1e-6


@dataclass(frozen=True)
class GaussianEquivalent:
    """A two-mass drivetrain linearised for one random torque.

    Parameters
    ----------
    drivetrain : Drivetrain
        Linear: reduced stiffness and damping, equivalent viscous friction, no gap.
    gap_gain : float
        Remaining share of stiffness and damping.
    twist, speed_load : float, rad and rad/s
        Their standard deviations.
    settled : bool
        Whether the iteration converged.
    """

    drivetrain: Drivetrain
    gap_gain: float
    twist: float
    speed_load: float
    settled: bool

    @property
    def zero(self) -> float:
        """Zero of motor angle over motor torque, undamped, Hz."""
        return self.drivetrain.zero_frequency

    @property
    def pole(self) -> float:
        """Torsional pole, undamped, Hz."""
        return self.drivetrain.pole_frequency


@checks_arguments
def gaussian_equivalent(drivetrain: Drivetrain, torque_motor: ArrayLike, dt: float) -> GaussianEquivalent:
    """Random-input describing functions of gap and Coulomb friction, solved together with the response they cause.

    For Gaussian signals around zero, the best linear gains are (Gelb & Vander Velde, Multiple-Input Describing
    Functions, 1968, appendix E)::

        dead zone ±h:  erfc(h/(√2·σ_twist))          Coulomb:  coulomb·√(2/π)/σ_speed_load  as viscous friction

    with the standard deviations of the linear response to the torque's spectrum, found by damped iteration.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; friction at motor and load.
    torque_motor : (n,) array, Nm
        Its mean is ignored: a shaft that is loaded to one side is less affected by its gap.
    dt : float, s

    Raises
    ------
    InvalidInput
        If the torque is not finite or does not change.
    """
    not_negative("gaussian_equivalent.dt", dt, positive=True)
    torque = np.asarray(torque_motor, dtype=float)
    if torque.ndim != 1 or torque.size < 2 or not np.all(np.isfinite(torque)) or not np.ptp(torque) > 0.0:
        raise InvalidInput(
            "gaussian_equivalent: torque_motor", "no varying signal", "a random torque", "Check it."
        )
    power = 2.0 * np.abs(np.fft.rfft(torque)[1:] / torque.size) ** 2
    lines = np.arange(1, power.size + 1)[power > 1e-12 * power.max()]
    s = np.asarray(2j * np.pi * lines / (torque.size * dt), dtype=complex)
    power = power[lines - 1]
    gain, viscous, viscous_motor, settled = 1.0, drivetrain.viscous, drivetrain.viscous_motor, False
    for _ in range(MOST_STEPS):
        linear = _linear(drivetrain, gain, viscous, viscous_motor)
        spread = {name: _spread(linear, name, s, power) for name in ("twist", "speed_load", "speed_motor")}
        wanted = math.erfc(0.5 * drivetrain.backlash / (math.sqrt(2.0) * spread["twist"]))
        slip = math.sqrt(2.0 / math.pi)
        load = drivetrain.viscous + drivetrain.coulomb * slip / spread["speed_load"]
        motor = drivetrain.viscous_motor + drivetrain.coulomb_motor * slip / spread["speed_motor"]
        change = math.log(max(wanted, LEAST_GAIN) / gain)
        settled = abs(change) < SETTLED and abs(load - viscous) <= SETTLED * max(load, 1e-12)
        if settled:
            break
        gain *= math.exp(STEP * change)
        viscous += STEP * (load - viscous)
        viscous_motor += STEP * (motor - viscous_motor)
    return GaussianEquivalent(linear, gain, spread["twist"], spread["speed_load"], settled)


def _linear(drivetrain: Drivetrain, gain: float, viscous: float, viscous_motor: float) -> Drivetrain:
    return drivetrain.with_parameters(
        stiffness=gain * drivetrain.stiffness,
        damping=gain * drivetrain.damping,
        backlash=0.0,
        coulomb=0.0,
        coulomb_motor=0.0,
        viscous=viscous,
        viscous_motor=viscous_motor,
    )


def _spread(linear: Drivetrain, output: str, s: NDArray[np.complex128], power: Floats) -> float:
    response = two_mass_response(linear.parameters(), output, s)
    return math.sqrt(float(np.sum(np.abs(response) ** 2 * power)))
