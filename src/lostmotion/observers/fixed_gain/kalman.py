"""Kalman observer with backlash and Coulomb friction (Fietzek & Rinderknecht, section III), discrete."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem, zero_order_hold
from ..arguments import flag, mapping, sample_time
from ..model import ObserverModel, covariance, in_the_gap, observer_model
from ..scale import mode_rate, scale_of
from .assembly import Assembly
from .injection import injection_of

Array = NDArray[np.float64]

#: Continuous process covariance per state. The first three: Fietzek & Rinderknecht, eq. 8. Options: no noise on the
#: actuator's torque and on the angle; an unknown load torque is followed at about 20 1/s, the observer's own slow pole
#: (on the paper's rig; in proportion to the inertia squared).
PROCESS_COVARIANCE: Mapping[str, float] = MappingProxyType(
    {
        "twist": 1.0, "speed_motor": 1000.0, "speed_load": 1000.0, "torque_actuator": 0.0, "angle_motor": 0.0,
        "torque_load": 10000.0,
    }
)  # fmt: skip

#: Continuous measurement covariance per signal. speed_motor and torque_shaft: Fietzek & Rinderknecht, eq. 8. Options:
#: speed_load as speed_motor; angles with 1 mrad where a speed has 1 rad/s. Calibrated on Table I at 1 ms without noise
#: (benchmarks/calibrations.py): the twist with 3, since with 1 the gap term held over the sample disturbs the load
#: speed (0.41 instead of 0.03 % of its range). The torque's is that of the paper's rig, in proportion to the square of
#: torque over speed (``scale.scale_of``).
MEASUREMENT_COVARIANCE: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 1.0, "speed_load": 1.0, "torque_shaft": 10.0, "twist": 1e-5, "angle_motor": 1e-6}
)

#: An error that decays slower than this rate (1/s) counts as not observable (numerics).
SLOWEST_RATE = 1e-6

#: Largest angle, rad, by which the eigenmode of the closed shaft may turn in a sample, over which a fixed gain holds
#: its gap term (calibrated with the motor speed alone on Table I, a tenth of its stiffness, and gaps of 3 to 30 mrad:
#: the load speed is up to 3 % of its range off, with half the angle 0.4 %, with double 6 %;
#: benchmarks/calibrations.py).
LARGEST_TURN = 1.5

#: Decay of every state of the drivetrain inside the gap, 1/s, see ``_gain_in_the_gap`` (numerics: small
#: against every pole, and enough to make it detectable).
GAP_DECAY = 0.1

_UNDETECTABLE = (
    "Measure a speed or the motor angle too (from torque or twist alone the speed of the whole drivetrain is "
    "not observable), or raise the process covariance."
)


def kalman_gain(
    drivetrain: Drivetrain,
    measured: Sequence[str] = ("speed_motor",),
    process_covariance: Mapping[str, float] | None = None,
    measurement_covariance: Mapping[str, float] | None = None,
) -> Array:
    """Continuous-time gain L = P Cᵀ R⁻¹ with the gap closed (Fietzek & Rinderknecht, eq. 6).

    Parameters as in ``kalman``. The paper's L₁ and L₂ leave viscous friction to the nonlinear part: give a
    drivetrain with ``viscous=0`` to get them.

    Returns
    -------
    (n_states, n_measured) array
        Rows: twist, speed_motor, speed_load (torque_actuator, angle_motor); columns in the order of
        ``measured``.

    Raises
    ------
    InvalidInput
        For unknown or doubled names, negative covariances, and sensors from which the state is not observable.

    Notes
    -----
    Fietzek & Rinderknecht, eq. 6 to 8; the filter: Kalman & Bucy 1961, J. Basic Engineering 83, 95–108.
    """
    from scipy.linalg import solve_continuous_are

    model = observer_model(drivetrain, measured)
    c = np.array([model.measurement_row(signal) for signal in measured])
    q, r = _covariances(model, measured, process_covariance, measurement_covariance)
    try:
        gain = np.asarray(solve_continuous_are(model.A.T, c.T, q, r) @ c.T @ np.linalg.inv(r))
        rate = -float(np.max(np.linalg.eigvals(model.A - gain @ c).real))
    except np.linalg.LinAlgError:
        rate = -np.inf
    if not rate > SLOWEST_RATE:
        raise InvalidInput("measured", repr(tuple(measured)), "a detectable system", _UNDETECTABLE)
    return gain


def kalman(
    drivetrain: Drivetrain,
    *,
    measured: Sequence[str] = ("speed_motor",),
    dt: float,
    process_covariance: Mapping[str, float] | None = None,
    measurement_covariance: Mapping[str, float] | None = None,
    speed_from_counts: bool = False,
    load_torque: bool = False,
    contact_scheduling: bool = False,
    injection: Mapping[str, float] | None = None,
    largest_innovation: Mapping[str, float] | None = None,
) -> DiscreteSystem:
    """Kalman observer of a two-mass drivetrain with backlash and Coulomb friction.

    The model steps exactly (matrix exponential) with torque, gap, friction and innovation held over the
    sample; the gain comes from the discrete Riccati equation with the gap closed. The gap curve that drives
    the state is evaluated at the mid-sample prediction of its argument, a second one at the sample itself
    gives outputs and innovation. Coulomb friction takes whatever torque between its two levels brings the
    load to rest at the end of the sample, so a stuck load rests (to rounding) instead of chattering. Stribeck
    and breakaway are left out.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses; ``contact`` "physical" is observed as "viscoelastic". With an actuator lag,
        ``torque_motor`` is the set-point and the lag is one more state.
    measured : sequence of str
        Any of speed_motor, speed_load, twist, torque_shaft, angle_motor (SI units).
    dt : float, s
        Sample time.
    process_covariance : mapping of state → variance, optional
        Continuous-time density, (unit of the state)²/s, default ``PROCESS_COVARIANCE``; names that are left out keep
        the default. An unknown torque of σ Nm·√s on an inertia J makes (σ/J)² for its speed.
    measurement_covariance : mapping of measured signal → variance, optional
        Continuous-time density, (unit of the signal)²·s, default ``MEASUREMENT_COVARIANCE``: the variance of one sample
        times dt.
    speed_from_counts : bool
        The measured motor speed is a mean over the last sample (a count difference divided by dt): it is
        compared with the mean of the last two estimated speeds, and the gain is that of the system with this
        memory.
    load_torque : bool
        Estimate an unknown torque on the load as one more state, ``torque_load`` (Nm, positive in the direction
        of positive speed): a random walk whose density is ``process_covariance["torque_load"]`` (Nm²/s).
    contact_scheduling : bool
        While the estimate is inside the gap, correct by the gain of the drivetrain without its shaft: what is not
        observable there is predicted, not corrected. See ``gates``.
    injection : mapping of measured signal → κ, optional
        The gap curve also sees κ·(measured − expected); κ in rad per unit of the signal, below 1/stiffness for the
        shaft torque. See ``injection``; which κ: docs/stability.md.
    largest_innovation : mapping of measured signal → float, optional
        Largest accepted difference between measured and predicted value, in the signal's unit; names that are left out
        keep the default ``input_checks.LARGEST_INNOVATION``. Choose it several times the innovations of good samples.
        A sample beyond it, a missing and a frozen one are replaced by the prediction, see ``InputCheck``;
        ``without_checks()`` gives an observer that accepts every sample.

    Returns
    -------
    DiscreteSystem
        Inputs torque_motor and ``measured``; outputs twist_estimated, twist_elastic_estimated (zero inside
        the gap), speed_motor_estimated, speed_load_estimated, torque_shaft_estimated, friction_load_estimated
        (Coulomb part of the sample just ended + viscous), angle_motor_estimated if it is measured, and
        torque_load_estimated with ``load_torque``.

    Raises
    ------
    InvalidInput
        For unknown or doubled names, negative covariances, an injection that leaves the gap no single value, sensors
        from which the state is not observable, and a sample in which the eigenmode of the closed shaft turns by more
        than ``LARGEST_TURN``.

    Notes
    -----
    Fietzek & Rinderknecht, section III: Observer 1 measures the motor speed, Observer 2 the shaft torque too. Theirs is
    continuous; the discrete gain: Kalman 1960, J. Basic Engineering 82, 35–45. Load torque as a state, contact
    scheduling and checks are additions; their defaults are chosen.
    """
    design = sampled_model(drivetrain, measured, dt, speed_from_counts, load_torque)
    q, r = covariances_of(design, process_covariance, measurement_covariance)
    gain = predictor_gain(design, design.model.A, q, r)
    if flag("contact_scheduling", contact_scheduling):
        design.assembly.close_in_gap(_gain_in_the_gap(design, q, r))
    if (seen := injection_of(design.model, design.measured, design.c, injection)) is not None:
        design.assembly.inject(seen, design.measured)
    return design.assembly.system(
        design.measured, gain, design.c, limits=mapping("largest_innovation", largest_innovation)
    )


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


def covariances_of(
    design: SampledModel, process: Mapping[str, float] | None, measurement: Mapping[str, float] | None
) -> tuple[Array, Array]:
    """Continuous densities of process and measurement: the defaults, changed by what the user gave."""
    return _covariances(design.model, design.measured, process, measurement)


def expected_innovation(design: SampledModel, q: Array, r: Array) -> Array:
    """Covariance that the innovations should have, (n_measured, n_measured)."""
    from scipy.linalg import solve_discrete_are

    a, r_d = design.model.A, r / design.dt
    p = solve_discrete_are(design.step(a).T, design.c.T, design.noise(a, q), r_d)
    return np.asarray(design.c @ p @ design.c.T + r_d)


def predictor_gain(design: SampledModel, a: Array, q: Array, r: Array) -> Array:
    """Gain of x⁺ = Φx + … + K(y − ŷ) from the discrete Riccati equation; q, r continuous densities."""
    return _riccati_gain(
        design.step(a), design.c, design.noise(a, q), r / design.dt, design.measured, design.dt
    )


def _gain_in_the_gap(design: SampledModel, q: Array, r: Array) -> Array:
    """The gain inside the gap, for the drivetrain without its shaft.

    States that are not observable get no correction. A slow decay of every state (chosen: 0.1 1/s) makes the Riccati
    equation solvable and changes nothing else.
    """
    a = in_the_gap(design.model)
    c = design.c.copy()
    for i, signal in enumerate(design.measured):
        if signal == "torque_shaft":
            c[i] = 0.0
    slack = replace(design, c=c)
    return predictor_gain(slack, a - GAP_DECAY * np.eye(a.shape[0]), q, r)


def _covariances(
    model: ObserverModel,
    measured: Sequence[str],
    process: Mapping[str, float] | None,
    measurement: Mapping[str, float] | None,
) -> tuple[Array, Array]:
    scale = scale_of(model.drivetrain)
    sized = {"torque_load": PROCESS_COVARIANCE["torque_load"] * scale.inertia**2}
    q = covariance(
        "process_covariance", model.states, {**PROCESS_COVARIANCE, **sized}, process, positive=False
    )
    sized = {"torque_shaft": MEASUREMENT_COVARIANCE["torque_shaft"] * scale.impedance**2}
    r = covariance(
        "measurement_covariance", measured, {**MEASUREMENT_COVARIANCE, **sized}, measurement, positive=True
    )
    return q, r


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


def _riccati_gain(
    phi: Array, c: Array, q_d: Array, r_d: Array, measured: tuple[str, ...], dt: float
) -> Array:
    from scipy.linalg import solve_discrete_are

    try:
        p = solve_discrete_are(phi.T, c.T, q_d, r_d)
        gain = np.asarray(np.linalg.solve(c @ p @ c.T + r_d, c @ p @ phi.T).T)
        radius = float(np.max(np.abs(np.linalg.eigvals(phi - gain @ c))))
    except np.linalg.LinAlgError:
        radius = np.inf
    if not radius < np.exp(-SLOWEST_RATE * dt):
        raise InvalidInput("measured", repr(measured), "a detectable system", _UNDETECTABLE)
    return gain
