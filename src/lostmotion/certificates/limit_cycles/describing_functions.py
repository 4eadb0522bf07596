"""Describing functions: what a static curve makes of a sine on a mean."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..static_curves import StaticCurve

Array = NDArray[np.float64]

#: Points over one period (numerics: the first harmonic of a jump is met to half a percent).
POINTS = 240
_SINE = np.sin(2.0 * np.pi * (np.arange(POINTS) + 0.5) / POINTS)
#: Shift of the mean for the gain of the mean, over the amplitude (numerics: some points wide, so that a jump counts).
SHIFT = 0.05
#: Smallest amplitude that differs from none, over 1 and the mean (numerics).
LEAST = 1e-9


@dataclass(frozen=True, eq=False)
class CurveValues:
    """A static curve in floats: its points, its values there, and the slope of every segment."""

    points: Array
    heights: Array
    slopes: Array

    @classmethod
    def of(cls, curve: StaticCurve) -> CurveValues:
        return cls(
            np.array([point for point, _ in curve.points], dtype=float),
            np.array([height for _, height in curve.points], dtype=float),
            np.array([0.0 if slope is None else float(slope) for slope in curve.slopes]),
        )

    def __call__(self, z: Array) -> Array:
        """The curve at z, elementwise; at a jump its value left of it."""
        segment = np.searchsorted(self.points, z, side="left")
        anchor = np.maximum(segment - 1, 0)
        return np.asarray(self.heights[anchor] + self.slopes[segment] * (z - self.points[anchor]))


def describing_function(curve: CurveValues, mean: float, amplitude: float) -> tuple[float, float, float]:
    """(mean of the output, gain of the first harmonic, gain of the mean) for an input mean + amplitude·sin.

    The gain of the mean is the slope of the output's mean over the input's. A static curve turns no phase. Gelb &
    Vander Velde 1968, Multiple-Input Describing Functions, chapters 2 and 6.
    """
    amplitude = max(amplitude, LEAST * (1.0 + abs(mean)))
    shift = SHIFT * amplitude
    means = np.array([[mean], [mean - shift], [mean + shift]])
    w, below, above = curve(means + amplitude * _SINE)
    gain = 2.0 * float(np.dot(w, _SINE)) / (POINTS * amplitude)
    return float(w.mean()), gain, float(above.mean() - below.mean()) / (2.0 * shift)
