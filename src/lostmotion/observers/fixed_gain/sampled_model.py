"""What all observers of a fixed gain begin with: the model, its exact step over a sample, the rows of its sensors."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import zero_order_hold
from ..arguments import flag, sample_time
from ..model import ObserverModel, observer_model
from ..scale import mode_rate
from .assembly import Assembly

Array = NDArray[np.float64]

#: Largest angle, rad, by which the eigenmode of the closed shaft may turn in a sample, over which a fixed gain holds
#: its gap term (calibrated with the motor speed alone on Table I, a tenth of its stiffness, and gaps of 3 to 30 mrad:
#: the load speed is up to 3 % of its range off, with half the angle 0.4 %, with double 6 %;
#: benchmarks/calibrations.py).
LARGEST_TURN = 1.5


@dataclass(frozen=True, eq=False)
class SampledModel:
    """Common to all fixed-gain observers: the model, its step, the rows of its sensors.

    Parameters
    ----------
    model : ObserverModel
    measured : tuple of str
    dt : float, s
    c : (n_measured, n) array
        Measurement rows over the model's states and, if needed, the motor speed of the sample before.
    assembly : Assembly
    """

    model: ObserverModel
    measured: tuple[str, ...]
    dt: float
    c: Array
    assembly: Assembly

    def step(self, a: Array) -> Array:
        """Φ of ẋ = A x over one sample, with the memory."""
        from scipy.linalg import expm

        phi = np.asarray(expm(a * self.dt))
        if self.c.shape[1] == phi.shape[0]:
            return phi
        return np.pad(np.vstack([phi, self.model.row(speed_motor=1.0)]), ((0, 0), (0, 1)))

    def noise(self, a: Array, q: Array) -> Array:
        """Covariance that a continuous density q adds in one sample, with the memory."""
        return np.pad(_process_covariance_of_a_sample(a, q, self.dt), (0, self.c.shape[1] - a.shape[0]))


def sampled_model(
    drivetrain: Drivetrain,
    measured: Sequence[str],
    dt: float,
    speed_from_counts: bool = False,
    load_torque: bool = False,
) -> SampledModel:
    """The model of a fixed-gain observer; parameters as in ``kalman``."""
    model = observer_model(drivetrain, measured, flag("load_torque", load_torque))
    measured, dt = tuple(measured), sample_time(dt)
    if flag("speed_from_counts", speed_from_counts) and "speed_motor" not in measured:
        raise InvalidInput("speed_from_counts", "True", "speed_motor among the measured signals", "Drop it.")
    _check_turn(drivetrain, dt)
    c = np.array([model.measurement_row(signal) for signal in measured])
    phi, gamma = zero_order_hold(model.A, np.hstack([model.B, model.E_gap, model.E_motor, model.E_load]), dt)
    assembly = Assembly(model, phi, gamma, dt)
    if speed_from_counts:
        c = np.hstack([c, np.zeros((len(measured), 1))])
        c[measured.index("speed_motor"), [1, -1]] = 0.5
        assembly.add_state("speed_motor_previous", model.row(speed_motor=1.0))
    return SampledModel(model, measured, dt, c, assembly)


def _check_turn(drivetrain: Drivetrain, dt: float) -> None:
    turn = mode_rate(drivetrain) * dt
    if drivetrain.backlash > 0.0 and turn > LARGEST_TURN:
        raise InvalidInput(
            "dt",
            f"{dt:g} s, in which the closed shaft's eigenmode turns by {turn:.2g} rad",
            f"at most {LARGEST_TURN:g} rad ({LARGEST_TURN / mode_rate(drivetrain):.2g} s) for a fixed gain",
            "Sample faster, check the stiffness, or take extended_kalman, which predicts a sample in sub-steps.",
        )


def _process_covariance_of_a_sample(a: Array, q: Array, dt: float) -> Array:
    """∫ exp(As) Q exp(Aᵀs) ds over one sample (Van Loan 1978, IEEE Trans. Automatic Control 23, 395–404).

    Its exp(−As) overflows for a pole much faster than the sample: so over a short interval, then doubled.
    """
    from scipy.linalg import expm

    n = a.shape[0]
    fastest = float(np.max(np.abs(np.linalg.eigvals(a)))) * dt
    doublings = max(0, int(np.ceil(np.log2(max(fastest, 1.0)))))
    block = expm(np.block([[-a, q], [np.zeros((n, n)), a.T]]) * (dt / 2.0**doublings))
    step = block[n:, n:].T
    q_d = step @ block[:n, n:]
    for _ in range(doublings):
        q_d = q_d + step @ q_d @ step.T
        step = step @ step
    return np.asarray(0.5 * (q_d + q_d.T))
