"""Innovations of an observer with any measured channels, an unknown load torque, and either contact law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..observers.assembly import Assembly
from ..observers.model import ObserverModel, observer_model
from ..systems import DiscreteSystem, zero_order_hold
from .predictor import NAMES, Bandwidth, Predictor, from_theta

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class ChannelPredictor(Predictor):
    """As ``Predictor``, from the project's observer with more than the motor speed.

    The residual holds the innovations of all channels, row by row, each times level of the motor speed / own level, so
    that all count by their own noise.

    Parameters
    ----------
    channels : mapping of name → (n,) array
        Measured beside ``speed_motor``: speed_load (rad/s), twist, angle_motor (rad), torque_shaft (Nm).
    averaged : tuple of str
        Speeds that are means over the sample before.
    levels : mapping of name → float
        Rms of each channel's innovations in its own unit, ``speed_motor`` included.
    load_rate : float, 1/s
        How fast an unknown load torque is followed; 0: there is none.
    """

    channels: Mapping[str, Array] = field(default_factory=dict)
    averaged: tuple[str, ...] = ()
    levels: Mapping[str, float] = field(default_factory=lambda: {"speed_motor": 1.0})
    load_rate: float = 0.0

    @property
    def measured(self) -> tuple[str, ...]:
        return ("speed_motor", *self.channels)

    def part(self, rows: slice) -> Predictor:
        """The same over some rows."""
        cut = {name: np.ascontiguousarray(values[rows]) for name, values in self.channels.items()}
        return replace(super().part(rows), channels=cut)  # type: ignore[call-arg]

    def drivetrain(self, theta: Array) -> Drivetrain:
        """Two-mass drivetrain of a parameter vector, with the contact law of ``base``."""
        return self.base.with_parameters(**dict(zip(NAMES, from_theta(theta, self.dt), strict=True)))

    def observer(self, theta: Array, bandwidth: Bandwidth) -> DiscreteSystem:
        """The observer; its outputs are the innovations of the channels."""
        model = observer_model(self.drivetrain(theta), self.measured, self.load_rate > 0.0)
        phi, gamma = zero_order_hold(
            model.A, np.hstack([model.B, model.E_gap, model.E_motor, model.E_load]), self.dt
        )
        assembly = Assembly(model, phi, gamma, self.dt)
        n, extra = len(model.states), len(self.averaged)
        full = np.zeros((n + extra, n + extra))
        full[:n, :n] = phi
        c = np.pad([model.measurement_row(name) for name in self.measured], ((0, 0), (0, extra)))
        for i, name in enumerate(self.averaged):
            row = model.row(**{name: 1.0})
            assembly.add_state(f"{name}_previous", row)
            full[n + i, :n] = row
            c[self.measured.index(name), [model.states.index(name), n + i]] = 0.5
        noise = np.zeros_like(full)
        noise[:n, :n] = self._process(model, bandwidth)
        gain = _gain(full, c, noise, self._measurement())
        law = assembly.system(self.measured, gain, c, innovation=True)
        rows = slice(len(law.outputs) - len(self.measured), None)
        return replace(law, outputs=law.outputs[rows], C=law.C[rows], D=law.D[rows], J=law.J[rows])

    def _process(self, model: ObserverModel, bandwidth: Bandwidth) -> Array:
        """Covariance added in one sample, for a measurement density of 1 of the motor speed."""
        density = {"speed_motor": bandwidth.motor**2, "speed_load": bandwidth.load**2}
        # A random-walk torque q on an inertia J that is seen by its speed is followed at the rate √(√q/J).
        density["torque_load"] = (model.drivetrain.inertia_total * self.load_rate**2) ** 2
        q = np.diag([density.get(state, 0.0) for state in model.states])
        # Simpson's rule over the sample: exact to the fifth power of rate · dt.
        half = zero_order_hold(model.A, np.zeros((len(q), 1)), 0.5 * self.dt)[0]
        whole = half @ half
        return np.asarray(self.dt / 6.0 * (q + 4.0 * half @ q @ half.T + whole @ q @ whole.T))

    def _measurement(self) -> Array:
        """Covariance of one sample, 1/dt for the motor speed."""
        ratio = [self.levels[name] / self.levels["speed_motor"] for name in self.measured]
        return np.diag(np.square(ratio)) / self.dt

    def _innovations(self, thetas: Array, bandwidth: Bandwidth) -> Array:
        from ..kernels.prediction_channels import channel_innovations

        inputs = np.column_stack([self.torque, self.speed, *self.channels.values()])
        weights = np.array([self.levels["speed_motor"] / self.levels[name] for name in self.measured])
        bounds = np.array(self.bounds, dtype=np.int64)
        residuals = np.empty((len(thetas), *inputs[:, 1:].shape))
        for residual, theta in zip(residuals, thetas, strict=True):
            law = self.observer(theta, bandwidth)
            starts = np.array([self._start(law, row) for row in self.bounds[:-1]])
            residual[:] = channel_innovations(law.tables(), starts, bounds, inputs, weights)
        for settling in self.settling():
            residuals[:, settling] = 0.0
        return residuals.reshape(len(thetas), inputs[:, 1:].size)

    def _start(self, law: DiscreteSystem, row: int) -> Array:
        """State at the first row of a piece: what is measured, and the motor's speed for the load's."""
        speed = self.speed[row]
        load = self.channels["speed_load"][row] if "speed_load" in self.channels else speed
        known = {
            "speed_motor": speed, "speed_motor_previous": speed, "speed_load": load, "speed_load_previous": load,
            "torque_actuator": self.torque[row],
        }  # fmt: skip
        known.update(
            {name: self.channels[name][row] for name in ("twist", "angle_motor") if name in self.channels}
        )
        return np.array([known.get(state, 0.0) for state in law.states])

    def channel(self, residual: Array, name: str) -> Array:
        """(n,) innovations of a channel in its own unit, out of a residual."""
        column = residual.reshape(self.torque.size, -1)[:, self.measured.index(name)]
        return column * (self.levels[name] / self.levels["speed_motor"])

    def speed_residual(self, residual: Array) -> Array:
        """(n,) innovations of the motor speed, rad/s."""
        return self.channel(residual, "speed_motor")

    def noise_levels(self, residual: Array) -> dict[str, float]:
        """Rms of each channel's innovations in its own unit."""
        rows = self.settled()
        return {
            name: float(np.sqrt(np.mean(self.channel(residual, name)[rows] ** 2))) for name in self.measured
        }


def _gain(phi: Array, c: Array, q: Array, r: Array) -> Array:
    """Predictor gain from the discrete Riccati equation, by doubling (Anderson 1978, Int. J. Control 28, 295–306).

    No pole needs to be moved that is not seen: an unexcited parameter must not stop the fit.
    """
    a, g, p = phi.T.copy(), c.T @ np.linalg.solve(r, c), q
    for _ in range(60):
        w = np.linalg.inv(np.eye(a.shape[0]) + g @ p)
        change = a.T @ p @ w @ a
        g, p, a = g + a @ w @ g @ a.T, p + 0.5 * (change + change.T), a @ w @ a
        if np.max(np.abs(change)) <= 1e-14 * np.max(np.abs(p)):
            break
    return np.asarray(np.linalg.solve(c @ p @ c.T + r, c @ p @ phi.T).T)
