"""Sensors of a simulated plant: encoder counts, speed from count differences, noise, bias."""

from __future__ import annotations

import math
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments, not_negative
from ..errors import InvalidInput

Array = NDArray[np.float64]


@checks_arguments
@dataclass(frozen=True)
class Sensor:
    """One measured channel of a simulated plant.

    Parameters
    ----------
    source : str
        The plant's signal that is sensed.
    resolution : float
        Step of the quantisation in the source's unit (an encoder of b bit: 2π/2ᵇ rad); 0: none.
    difference : bool
        The channel is the difference of two samples over the sample time: a speed from counts, which is the mean
        speed of the sample that just ended.
    noise : float
        Standard deviation of white Gaussian noise, in the channel's unit.
    bias : float
        Constant error, in the channel's unit.
    dropout : float
        Probability that a sample is lost: it shows NaN.
    """

    source: str
    resolution: float = 0.0
    difference: bool = False
    noise: float = 0.0
    bias: float = 0.0
    dropout: float = 0.0

    def __post_init__(self) -> None:
        for name in ("resolution", "noise"):
            value = getattr(self, name)
            if not (math.isfinite(value) and value >= 0.0):
                raise InvalidInput(f"Sensor.{name}", repr(value), "zero or a positive number", "Check it.")
        if not 0.0 <= self.dropout <= 1.0:
            raise InvalidInput("Sensor.dropout", repr(self.dropout), "a probability from 0 to 1", "Check it.")

    @property
    def exact(self) -> bool:
        """Whether it shows the true value."""
        return self == Sensor(self.source)


def disturbance(sensors: Mapping[str, Sensor], channels: Sequence[str], length: int, seed: int) -> Array:
    """Bias and noise, (length, channels), or (1, channels) where they are the same in every sample.

    A channel's noise depends on the seed and its name alone.
    """
    if not any(
        sensors[name].noise > 0.0 or sensors[name].dropout > 0.0 for name in channels if name in sensors
    ):
        length = 1
    columns = []
    for name in channels:
        sensor = sensors.get(name, Sensor(name))
        column = np.full(length, sensor.bias)
        if sensor.noise > 0.0:
            rng = np.random.default_rng([seed, zlib.crc32(name.encode())])
            column = column + sensor.noise * rng.standard_normal(length)
        if sensor.dropout > 0.0:
            rng = np.random.default_rng([seed, zlib.crc32(name.encode()), 1])
            column = np.where(rng.random(length) < sensor.dropout, np.nan, column)
        columns.append(column)
    return np.column_stack(columns) if columns else np.zeros((length, 0))


@checks_arguments
def measure(
    sensors: Mapping[str, Sensor], signals: Mapping[str, Array], dt: float, seed: int
) -> dict[str, Array]:
    """What the sensors show of true signals sampled at dt (s): (n,) arrays, equal to those a law in the loop sees."""
    from ..kernels.loop.sensors import over_a_recording

    lengths = {np.shape(values) for values in signals.values()}
    if len(lengths) != 1 or len(shape := lengths.pop()) != 1:
        raise InvalidInput("measure.signals", "no rows of one length", "(n,) arrays", "Cut them alike.")
    length = shape[0]
    not_negative("measure.dt", dt, positive=True)
    shown = {}
    for name, sensor in sensors.items():
        if sensor.source not in signals:
            raise InvalidInput(
                f"sensor {name!r}", f"source {sensor.source!r}", f"{sorted(signals)}", "Check the name."
            )
        value = np.array(signals[sensor.source], dtype=float)
        noise = disturbance(sensors, (name,), length, seed)[:, 0]
        shown[name] = over_a_recording(value, sensor.resolution, int(sensor.difference), dt, noise)
    return shown
