"""Notch filter of a torque: what a converter has against an eigenmode that its speed controller excites."""

from __future__ import annotations

import math

import numpy as np

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from ..systems import DiscreteSystem
from ..systems.checks import sample_time


@checks_arguments
def notch(
    signal: str,
    output: str,
    *,
    frequency: float,
    dt: float,
    width: float = 0.7,
    depth: float = 0.1,
) -> DiscreteSystem:
    """Second-order notch filter, (s² + 2·depth·width·ω·s + ω²)/(s² + 2·width·ω·s + ω²) with ω = 2π·frequency.

    Discretised by Tustin's rule with the frequency kept (prewarping); gain 1 at zero and at high frequencies, ``depth``
    at the frequency.

    Parameters
    ----------
    signal, output : str
        Filtered signal, result.
    frequency : float, Hz
    dt : float, s
    width : float
        Damping ratio of the poles.
    depth : float
        Gain at the frequency: 0 removes it, 1 is no filter.

    Raises
    ------
    InvalidInput
        If the frequency is not between zero and half the sample rate, or another number not positive.

    Notes
    -----
    Åström & Wittenmark 1997, Computer-Controlled Systems, section 8.3 (Tustin's rule with prewarping).
    """
    dt = sample_time("notch.dt", dt)
    if not 0.0 < frequency < 0.5 / dt:
        raise InvalidInput(
            "notch.frequency", repr(frequency), f"between 0 and 1/(2·dt) = {0.5 / dt:g} Hz", "Sample faster."
        )
    if not (math.isfinite(width) and width > 0.0 and 0.0 <= depth <= 1.0):
        raise InvalidInput(
            "notch.width, notch.depth",
            f"{width!r}, {depth!r}",
            "a positive width, a depth from 0 to 1",
            "Check them.",
        )
    warped = math.tan(math.pi * frequency * dt)
    square, damped = warped**2, 2.0 * width * warped
    zeros = np.array([1.0 + depth * damped + square, 2.0 * (square - 1.0), 1.0 - depth * damped + square])
    poles = np.array([1.0 + damped + square, 2.0 * (square - 1.0), 1.0 - damped + square])
    b, a = zeros / poles[0], poles / poles[0]
    # Transposed direct form II.
    return DiscreteSystem(
        inputs=(signal,), outputs=(output,), states=(f"{output}_1", f"{output}_2"), dt=dt, name=f"notch of {signal}",
        A=np.array([[-a[1], 1.0], [-a[2], 0.0]]), B=(b[1:] - a[1:] * b[0])[:, None], C=np.eye(1, 2), D=b[:1, None],
    )  # fmt: skip
