"""Gains of the PI speed controller by optimisation: the nonlinear drive itself, with gap and friction, is simulated."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...simulation import simulate
from ...systems import DesignModel, DiscreteSystem, loop_margin
from ..pi import pi
from .symmetrical_optimum import LARGEST_SENSITIVITY, in_contact_states, symmetrical_optimum

Array = NDArray[np.float64]

#: Length of each part of the experiment in time constants of the symmetrical optimum (numerics: that settles in 20).
SETTLES = 40.0
#: Filter of the set-point at the start of the search, over that of the symmetrical optimum (numerics).
FILTERED = 0.2
#: Evaluations at most, of 5 ms each on the paper's rig, and accuracy of the gains' logarithms (numerics).
EVALUATIONS, ACCURACY = 120, 0.02
#: Largest overshoot, as a share of the step (option).
LARGEST_OVERSHOOT = 0.05
#: What a sensitivity or an overshoot beyond the largest one adds to the cost, relative (numerics: steep enough to be a
#: limit, and no wall that the search would stop at).
STEEP, STEEP_OVERSHOOT = 10.0, 50.0


@dataclass(frozen=True)
class OptimisedPi:
    """Gains for ``pi``, to be used with ``friction_of`` the same drivetrain.

    Parameters
    ----------
    kp, ki : float, Nm s/rad, Nm/rad
    filter_time : float, s
        Of the set-point filter.
    sensitivity : float
        Largest of the sampled loop, with the gap closed and at its edges.
    cost : float
        Of the experiment, see ``optimised_pi``.
    """

    kp: float
    ki: float
    filter_time: float
    sensitivity: float
    cost: float

    def gains(self) -> dict[str, float]:
        """The arguments of ``pi``."""
        return {"kp": self.kp, "ki": self.ki, "filter_time": self.filter_time}


@checks_arguments
def optimised_pi(
    drivetrain: Drivetrain,
    *,
    dt: float,
    torque_limit: float,
    speed: float,
    torque_load: float,
    speed_from_counts: bool = False,
) -> OptimisedPi:
    """The PI gains and set-point filter with which the drive itself follows a step across its gap best.

    ::

        minimise  Σ t·|speed_reference − speed_load| over a step −speed → speed and over a step of the load torque,
        t from the last of the two on; largest sensitivity ≤ 2, overshoot ≤ 5 %

    The drive is simulated with its gap, its friction, the torque limit and one sample of delay; friction is fed
    forward. Without friction in the cost the optimum has no integral action, and leaves a steady error on a real drive.
    The search starts at the symmetrical optimum (Nelder–Mead).

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses.
    dt : float, s
    torque_limit : float, Nm
    speed : float, rad/s
        Half the step.
    torque_load : float, Nm
        The step of the load torque, against the motion.
    speed_from_counts : bool
        Whether the measured speed is a mean over the sample, for the sensitivity.

    Raises
    ------
    InvalidInput
        If there are not two masses, or ``torque_limit``, ``speed`` or ``torque_load`` is not positive.

    Notes
    -----
    Graham & Lathrop 1953, AIEE Trans. 72, 273–288 (integral of time times absolute error).
    """
    for name, value in (("torque_limit", torque_limit), ("speed", speed), ("torque_load", torque_load)):
        if not (math.isfinite(value) and value > 0.0):
            raise InvalidInput(
                f"optimised_pi.{name}", repr(value), "a positive number in SI units", "Check it."
            )
    from scipy.optimize import minimize

    start = symmetrical_optimum(drivetrain, dt=dt, spread=None, speed_from_counts=speed_from_counts)
    experiment = _Experiment(
        drivetrain, dt, torque_limit, speed, torque_load, start.time_constant, speed_from_counts,
        in_contact_states(drivetrain, dt, 1),
    )  # fmt: skip
    first = np.log([start.kp, start.kp / start.ki, FILTERED * start.filter_time])
    options = {"maxfev": EVALUATIONS, "xatol": ACCURACY, "fatol": 0.0}
    found = minimize(experiment.cost, first, method="Nelder-Mead", options=options)
    kp, reset, filtered = np.exp(found.x).tolist()
    sensitivity = experiment.sensitivity(kp, kp / reset)
    return OptimisedPi(kp, kp / reset, filtered, sensitivity, float(found.fun))


@dataclass(frozen=True, eq=False)
class _Experiment:
    """Rest at −speed, a step to speed, then one of the load torque; times in units of ``unit`` (s)."""

    drivetrain: Drivetrain
    dt: float
    torque_limit: float
    speed: float
    torque_load: float
    unit: float
    speed_from_counts: bool
    models: tuple[DesignModel, ...]

    def cost(self, logarithms: Array) -> float:
        """Of gain, reset time and filter time, each by its logarithm; inf where the loop is not stable."""
        kp, reset, filtered = np.exp(logarithms).tolist()
        if not self.dt < reset:
            return math.inf
        sensitivity = self.sensitivity(kp, kp / reset)
        if math.isinf(sensitivity):
            return math.inf
        law = pi(
            dt=self.dt, kp=kp, ki=kp / reset, torque_limit=self.torque_limit, filter_time=filtered,
            friction_of=self.drivetrain,
        )  # fmt: skip
        beyond = max(0.0, sensitivity - LARGEST_SENSITIVITY)
        return self._error(law) * (1.0 + STEEP * beyond)

    def sensitivity(self, kp: float, ki: float) -> float:
        law = pi(dt=self.dt, kp=kp, ki=ki)
        return max(loop_margin(law, model, self.speed_from_counts).sensitivity for model in self.models)

    def _error(self, law: DiscreteSystem) -> float:
        """Time-weighted error of both steps, and what the overshoot adds."""
        n = round(SETTLES * self.unit / self.dt)
        lead, part = n // 2, np.arange(n) * self.dt / self.unit
        reference = self.speed * np.concatenate([np.full(lead, -1.0), np.ones(2 * n)])
        load = -self.torque_load * np.concatenate([np.zeros(lead + n), np.ones(n)])
        run = simulate(
            self.drivetrain, law=law, dt=self.dt, delay=1, speed_reference=reference, torque_load=load,
            state=(0.0, -self.speed, -self.speed),
        )  # fmt: skip
        weight = np.concatenate([np.zeros(lead), part, part])
        error = (reference - run["speed_load"]) / self.speed
        overshoot = -0.5 * float(np.min(error[lead : lead + n]))
        beyond = 1.0 + STEEP_OVERSHOOT * max(0.0, overshoot - LARGEST_OVERSHOOT)
        return float(np.sum(weight * np.abs(error))) * self.dt / self.unit * beyond
