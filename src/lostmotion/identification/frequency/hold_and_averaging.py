"""From sampled signals to the response of the continuous system, and back for a model that is fitted to it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...recording import Recording

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Most images of the spectrum on either side that ``fold`` adds, and the relative error above which it adds more
#: (numerics): image k of an inertia's speed has (frequency/(k·sample rate))², all further ones about 2k times that.
MOST_IMAGES, IMAGE_ERROR = 20, 1e-4


@dataclass(frozen=True)
class Sampling:
    """How a response was measured.

    Parameters
    ----------
    dt : float, s
    source : str
        The recorded signal that stands for the output.
    power : {-1, 0, 1}
        Power of s = j·ω that converts it to the output.
    held : bool
        The input is held over each sample.
    averaged : bool
        Each value is the mean of the sample before its row, as count differences are.
    """

    dt: float
    source: str
    power: int
    held: bool
    averaged: bool

    def conversion(self, frequency: Floats) -> Complexes:
        """Factor from the ratio of the sampled signals to the continuous response, images left out, (m,)."""
        s = 2j * np.pi * frequency
        mean = -np.expm1(-s * self.dt) / (s * self.dt)
        return np.asarray(s**self.power / mean ** (self.held + self.averaged), dtype=complex)

    def fold(self, source_response: Callable[[Complexes], Complexes], frequency: Floats) -> Complexes:
        """What ``frequency_response`` shows of a system whose continuous source over input is source_response(s), (m,).

        A held input excites all images of a frequency: they come back in the samples. At 1 kHz they shift the response
        of an inertia by 1 % at 55 Hz, and a zero, where little else is left, by more.
        """
        s = np.asarray(2j * np.pi * frequency, dtype=complex)
        total = source_response(s) + self.images(source_response, frequency)
        return np.asarray(total * s**self.power, dtype=complex)

    def images(self, source_response: Callable[[Complexes], Complexes], frequency: Floats) -> Complexes:
        """What the images add to source over input, (m,)."""
        s = np.asarray(2j * np.pi * frequency, dtype=complex)
        total = np.zeros_like(s)
        if self.held:
            share = float(np.max(frequency)) * self.dt
            count = min(max(math.ceil(2.0 * share**2 / IMAGE_ERROR), 1), MOST_IMAGES)
            for k in range(1, count + 1):
                for image in (s + 2j * np.pi * k / self.dt, s - 2j * np.pi * k / self.dt):
                    total += source_response(np.asarray(image, dtype=complex)) * (s / image) ** (
                        1 + self.averaged
                    )
        return total


def sampling(recording: Recording, input: str, output: str, input_held: bool | None) -> Sampling:
    """The signal to use for an output, and how it was sampled; see ``frequency_response``."""
    speed, angle = output.replace("angle_", "speed_", 1), output.replace("speed_", "angle_", 1)
    source, power = output, 0
    # A speed has no drift and so less leakage: it is preferred for the angle too.
    if output.startswith("angle_") and speed in recording:
        source, power = speed, -1
    elif output.startswith("speed_") and output not in recording and angle in recording:
        source, power = angle, 1
    usually = input in ("torque_motor", "torque_load") or input.endswith("_reference")
    averaged = source.startswith("speed_") and bool(recording.meta.get("speed_from_counts"))
    return Sampling(recording.dt, source, power, usually if input_held is None else input_held, averaged)
