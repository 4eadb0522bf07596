"""Kalman observer with backlash and Coulomb friction (Fietzek & Rinderknecht, section III), discrete."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ..curves import PiecewiseLinear, dead_zone, saturation
from ..drivetrain import Drivetrain, Friction
from ..errors import InvalidInput
from ..systems import DiscreteSystem, zero_order_hold
from .model import ObserverModel, covariance, observer_model

Array = NDArray[np.float64]

#: Continuous process covariance per state. The first three: Fietzek & Rinderknecht, eq. 8. The actuator's
#: torque counts as known and the angle follows from the speed alone (chosen).
PROCESS_COVARIANCE: Mapping[str, float] = MappingProxyType(
    {"twist": 1.0, "speed_motor": 1000.0, "speed_load": 1000.0, "torque_actuator": 0.0, "angle_motor": 0.0}
)

#: Continuous measurement covariance per signal. speed_motor and torque_shaft: Fietzek & Rinderknecht, eq. 8.
#: Chosen: speed_load as speed_motor; angles with 1 mrad where a speed has 1 rad/s.
MEASUREMENT_COVARIANCE: Mapping[str, float] = MappingProxyType(
    {"speed_motor": 1.0, "speed_load": 1.0, "torque_shaft": 10.0, "twist": 1e-6, "angle_motor": 1e-6}
)

#: An error that decays slower than this rate (1/s) counts as one that the sensors cannot see (chosen).
SLOWEST_RATE = 1e-6

_UNDETECTABLE = (
    "Measure a speed or the motor angle too (torque or twist alone cannot tell how fast the whole drivetrain "
    "turns), or raise the process covariance."
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
    count_averaged: bool = False,
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
        Continuous-time density, default ``PROCESS_COVARIANCE``; names that are left out keep the default.
    measurement_covariance : mapping of measured signal → variance, optional
        Continuous-time density, default ``MEASUREMENT_COVARIANCE``; a sample has this value divided by dt.
    count_averaged : bool
        The measured motor speed is a mean over the last sample (a count difference divided by dt): it is
        compared with the mean of the last two estimated speeds, and the gain is that of the system with this
        memory.

    Returns
    -------
    DiscreteSystem
        Inputs torque_motor and ``measured``; outputs twist_estimated, twist_elastic_estimated (zero inside
        the gap), speed_motor_estimated, speed_load_estimated, torque_shaft_estimated, friction_load_estimated
        (Coulomb part of the sample just ended + viscous), and angle_motor_estimated if it is measured.

    Raises
    ------
    InvalidInput
        For unknown or doubled names, negative covariances, and sensors that cannot see the whole state.
    """
    measured = tuple(measured)
    model = observer_model(drivetrain, measured)
    if count_averaged and "speed_motor" not in measured:
        raise InvalidInput("count_averaged", "True", "speed_motor among the measured signals", "Drop it.")
    c = np.array([model.measurement_row(signal) for signal in measured])
    q, r = _covariances(model, measured, process_covariance, measurement_covariance)
    phi, gamma = zero_order_hold(model.A, np.hstack([model.B, model.E_gap, model.E_motor, model.E_load]), dt)
    q_d = _process_covariance_of_a_sample(model.A, q, dt)
    builder = _Builder(model, phi, gamma, dt)
    if count_averaged:
        memory = np.vstack([phi, model.row(speed_motor=1.0)])
        phi = np.hstack([memory, np.zeros((memory.shape[0], 1))])
        q_d = np.pad(q_d, (0, 1))
        c = np.hstack([c, np.zeros((len(measured), 1))])
        c[measured.index("speed_motor"), [1, -1]] = 0.5
        builder.add_state("speed_motor_previous", model.row(speed_motor=1.0))
    gain = _predictor_gain(phi, c, q_d, r / dt, measured, dt)
    return builder.system(measured, gain, c)


def _covariances(
    model: ObserverModel,
    measured: Sequence[str],
    process: Mapping[str, float] | None,
    measurement: Mapping[str, float] | None,
) -> tuple[Array, Array]:
    q = covariance("process_covariance", model.states, PROCESS_COVARIANCE, process, positive=False)
    r = covariance("measurement_covariance", measured, MEASUREMENT_COVARIANCE, measurement, positive=True)
    return q, r


def _process_covariance_of_a_sample(a: Array, q: Array, dt: float) -> Array:
    """∫ exp(As) Q exp(Aᵀs) ds over one sample (Van Loan 1978, IEEE Trans. Automatic Control 23, 395–404)."""
    from scipy.linalg import expm

    n = a.shape[0]
    block = expm(np.block([[-a, q], [np.zeros((n, n)), a.T]]) * dt)
    q_d = block[n:, n:].T @ block[:n, n:]
    return np.asarray(0.5 * (q_d + q_d.T))


def _predictor_gain(
    phi: Array, c: Array, q_d: Array, r_d: Array, measured: tuple[str, ...], dt: float
) -> Array:
    """Gain of x⁺ = Φx + … + K(y − ŷ) from the discrete Riccati equation."""
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


def _coulomb_curve(friction: Friction, speed_per_torque: float) -> PiecewiseLinear:
    """Torque that brings the speed z to rest within the sample, limited to the Coulomb levels."""
    plus, minus = friction.coulomb_plus, friction.coulomb_minus
    return PiecewiseLinear(((-minus * speed_per_torque, -minus), (plus * speed_per_torque, plus)))


class _Builder:
    """Collects states, curves and rows of the observer, then makes the DiscreteSystem.

    Columns of Γ: torque, gap, motor friction, load friction.
    """

    def __init__(self, model: ObserverModel, phi: Array, gamma: Array, dt: float) -> None:
        self.model = model
        self.dt = dt
        self.phi = phi
        self.gamma = gamma
        self.curves: dict[str, PiecewiseLinear] = {}
        self.arguments: dict[str, tuple[Array, float, dict[str, float]]] = {}
        self.extra: dict[str, Array] = {}
        self._add_gap()
        self._add_friction()

    def add_state(self, name: str, row: Array) -> None:
        """One more state whose next value is a row over the model's states."""
        self.extra[name] = row

    def _add_curve(
        self,
        name: str,
        curve: PiecewiseLinear,
        row: Array,
        torque: float = 0.0,
        curves: dict[str, float] | None = None,
    ) -> None:
        self.curves[name] = curve
        self.arguments[name] = (row, torque, curves or {})

    def _add_gap(self) -> None:
        model, shaft = self.model, self.model.drivetrain.shaft
        if not shaft.has_backlash:
            return
        half = 0.5 * shaft.backlash
        # The state feels the gap of the whole sample, best taken at its middle; the outputs belong to its
        # start.
        self._add_curve("gap", saturation(half), model.contact_argument(ahead=0.5 * self.dt))
        self._add_curve("torque", dead_zone(half), model.contact_argument())
        if shaft.contact != "dead_zone" and shaft.damping > 0.0:
            self._add_curve("elastic", dead_zone(half), model.row(twist=1.0))

    def _add_friction(self) -> None:
        for column, place in ((2, "motor"), (3, "load")):
            friction = self.model.drivetrain.frictions[column - 2]
            if max(friction.coulomb_plus, friction.coulomb_minus) > 0.0:
                i = self.model.states.index(f"speed_{place}")
                others = {
                    name: self.gamma[i, j] for name, j in (("gap", 1), ("motor", 2)) if name in self.curves
                }
                curve = _coulomb_curve(friction, abs(float(self.gamma[i, column])))
                self._add_curve(place, curve, self.phi[i], float(self.gamma[i, 0]), others)

    def system(self, measured: tuple[str, ...], gain: Array, c: Array) -> DiscreteSystem:
        """The observer with gain and measurement rows c, both over the model's states and the memory."""
        names = tuple(self.curves)
        n, n_w = len(self.model.states), len(names)
        n_known = gain.shape[0]
        phi = np.zeros((n_known, n_known))
        phi[:n, :n] = self.phi
        for i, row in enumerate(self.extra.values()):
            phi[n + i, :n] = row
        e = np.zeros((n_known, n_w))
        for name, column in (("gap", 1), ("motor", 2), ("load", 3)):
            if name in names:
                e[:n, names.index(name)] = self.gamma[:, column]
        c_x, c_w = self._measurement(measured, c, names)
        b = np.hstack([np.pad(self.gamma[:, [0]], ((0, n_known - n), (0, 0))), gain])
        a, e = phi - gain @ c_x, e - gain @ c_w
        states = (*self.model.states, *self.extra)
        if "load" in names:
            # The friction of the last sample is a state: taken at once, it would need this sample's torque,
            # which a controller may compute from it.
            states = (*states, "coulomb_load")
            a = np.pad(a, ((0, 1), (0, 1)))
            b = np.pad(b, ((0, 1), (0, 0)))
            e = np.vstack([e, np.eye(1, n_w, names.index("load"))])
        f, g, h = self._argument_matrices(names, len(states), b.shape[1])
        outputs, c_out, j_out = self._outputs(measured, states, names)
        return DiscreteSystem(
            inputs=("torque_motor", *measured), outputs=outputs, states=states, dt=self.dt, name="kalman",
            curves=tuple(self.curves.values()), A=a, B=b, E=e, F=f, G=g, H=h, C=c_out, J=j_out,
        )  # fmt: skip

    def _measurement(
        self, measured: tuple[str, ...], c: Array, names: tuple[str, ...]
    ) -> tuple[Array, Array]:
        """ŷ = c_x x + c_w w: the rows with the gap closed, but the shaft torque through its gap curve."""
        c_x, c_w = c.copy(), np.zeros((len(measured), len(names)))
        if "torque_shaft" in measured and "torque" in names:
            i = measured.index("torque_shaft")
            c_x[i, : len(self.model.states)], c_w[i] = self._torque_rows(names)
        return c_x, c_w

    def _torque_rows(self, names: tuple[str, ...]) -> tuple[Array, Array]:
        """Shaft torque as rows over the model's states and the curves."""
        model, shaft, w = self.model, self.model.drivetrain.shaft, np.zeros(len(names))
        if "torque" not in names:
            return model.measurement_row("torque_shaft"), w
        w[names.index("torque")] = shaft.stiffness
        damping = shaft.damping if shaft.contact == "dead_zone" else 0.0
        return model.row(speed_motor=damping, speed_load=-damping), w

    def _argument_matrices(self, names: tuple[str, ...], n_x: int, n_u: int) -> tuple[Array, Array, Array]:
        f, g, h = np.zeros((len(names), n_x)), np.zeros((len(names), n_u)), np.zeros((len(names), len(names)))
        for i, (row, torque, others) in enumerate(self.arguments.values()):
            f[i, : row.size] = row
            g[i, 0] = torque
            for name, value in others.items():
                h[i, names.index(name)] = value
        return f, g, h

    def _outputs(
        self, measured: tuple[str, ...], states: tuple[str, ...], names: tuple[str, ...]
    ) -> tuple[tuple[str, ...], Array, Array]:
        model, no_curve = self.model, np.zeros(len(names))
        elastic = "elastic" if "elastic" in names else "torque"
        in_gap = elastic in names
        friction = model.row(speed_load=model.drivetrain.viscous)
        rows: dict[str, tuple[Array, Array]] = {
            "twist": (model.row(twist=1.0), no_curve),
            "twist_elastic": (
                model.row(twist=0.0 if in_gap else 1.0),
                np.eye(1, len(names), names.index(elastic))[0] if in_gap else no_curve,
            ),
            "speed_motor": (model.row(speed_motor=1.0), no_curve),
            "speed_load": (model.row(speed_load=1.0), no_curve),
            "torque_shaft": self._torque_rows(names),
            "friction_load": (friction, no_curve),
        }
        if "angle_motor" in measured:
            rows["angle_motor"] = (model.row(angle_motor=1.0), no_curve)
        c = np.zeros((len(rows), len(states)))
        c[:, : len(model.states)] = [row for row, _ in rows.values()]
        if "coulomb_load" in states:
            c[list(rows).index("friction_load"), states.index("coulomb_load")] = 1.0
        return tuple(f"{name}_estimated" for name in rows), c, np.array([w for _, w in rows.values()])
