"""Innovations of an observer with any measured channels, an unknown load torque, and either contact law."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from .innovations import Bandwidth, Predictor

Array = NDArray[np.float64]

#: Channels in the order in which ``kernels.innovations.channels`` numbers them.
CHANNELS = ("speed_motor", "speed_load", "twist", "angle_motor", "torque_shaft")


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
    def replicable(self) -> bool:
        """Not with further channels or an unknown load torque."""
        return False

    @property
    def measured(self) -> tuple[str, ...]:
        return ("speed_motor", *self.channels)

    def part(self, rows: slice) -> Predictor:
        """The same over some rows."""
        cut = {name: np.ascontiguousarray(values[rows]) for name, values in self.channels.items()}
        return replace(super().part(rows), channels=cut)  # type: ignore[call-arg]

    def _innovations(self, thetas: Array, bandwidth: Bandwidth) -> Array:
        from ...kernels.innovations.channels import channel_innovations

        residuals = channel_innovations(
            self._parameters(thetas),
            (bandwidth.motor, bandwidth.load),
            self.load_rate,
            self.dt,
            self.base.contact == "dead_zone",
            np.array([CHANNELS.index(name) for name in self.measured]),
            np.array([name in self.averaged for name in self.measured], dtype=np.int64),
            np.array([self.levels[name] / self.levels["speed_motor"] for name in self.measured]),
            np.array(self.bounds, dtype=np.int64),
            self.torque,
            np.column_stack([self.speed, *self.channels.values()]),
        )
        for settling in self.settling():
            residuals[:, settling] = 0.0
        return np.asarray(residuals.reshape(len(thetas), self.torque.size * len(self.measured)))

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
