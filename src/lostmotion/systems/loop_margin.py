"""How far a sampled speed loop is from instability: poles and sensitivity of a linear law around a drivetrain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .design_model import DesignModel
from .discrete_system import DiscreteSystem

Array = NDArray[np.float64]

#: Frequencies of the evaluation: this many, down from the Nyquist frequency by this factor (numerics: 75
#: per decade).
FREQUENCIES, DECADES = 300, 1e-4


@dataclass(frozen=True)
class LoopMargin:
    """Of a loop that is closed over the motor speed.

    Parameters
    ----------
    sensitivity : float
        Largest |1/(1 + L)| over frequency; its inverse is the distance of the Nyquist curve from −1. inf: unstable.
    torque_per_speed_noise : float, Nm s/rad
        Standard deviation of the motor torque over that of white noise on the measured speed. inf: unstable.
    """

    sensitivity: float
    torque_per_speed_noise: float


@checks_arguments
def loop_margin(law: DiscreteSystem, model: DesignModel, speed_from_counts: bool = False) -> LoopMargin:
    """Margin of a linear law speed_motor → torque_motor around a drivetrain.

    Parameters
    ----------
    law : DiscreteSystem
        Without curves, see ``linearised``; it is designed for the sample time of the model.
    model : DesignModel
        With the computing delay of the drive.
    speed_from_counts : bool
        Whether the measured speed is the mean of the last two samples, as a count difference is.

    Raises
    ------
    InvalidInput
        If the law has curves.

    Notes
    -----
    Largest sensitivity as a margin: Åström & Hägglund 2006, Advanced PID Control, section 4.6 (1.4 to 2 are usual).
    """
    if law.curves:
        raise InvalidInput(
            "loop_margin.law", f"{len(law.curves)} curves", "a linear law", "Use linearised(law, slopes)."
        )
    A, b, c = _measured_plant(model, speed_from_counts)
    j, i = law.inputs.index("speed_motor"), law.outputs.index("torque_motor")
    a, g, k, d = law.A, law.B[:, j], law.C[i], float(law.D[i, j])
    loop = np.block([[A + d * np.outer(b, c), np.outer(b, k)], [np.outer(g, c), a]])
    if not float(np.max(np.abs(np.linalg.eigvals(loop)))) < 1.0:
        return LoopMargin(math.inf, math.inf)
    turns = np.geomspace(DECADES * math.pi, math.pi, FREQUENCIES)
    z = np.exp(1j * turns)
    controller = d + _response(a, g, k, z)
    sensitivity = 1.0 / (1.0 - controller * _response(A, b, c, z))
    # Variance of a filtered white noise: mean of |response|² over the frequencies from zero to Nyquist.
    torque = float(np.trapezoid(np.abs(controller * sensitivity) ** 2, turns)) / math.pi
    return LoopMargin(float(np.max(np.abs(sensitivity))), math.sqrt(torque))


def _measured_plant(model: DesignModel, speed_from_counts: bool) -> tuple[Array, Array, Array]:
    speed, n = model.row(speed_motor=1.0), len(model.states)
    if not speed_from_counts:
        return model.A, model.B, speed
    A = np.zeros((n + 1, n + 1))
    A[:n, :n], A[n, :n] = model.A, speed
    return A, np.append(model.B, 0.0), 0.5 * np.append(speed, 1.0)


def _response(A: Array, b: Array, c: Array, z: NDArray[np.complex128]) -> NDArray[np.complex128]:
    """c (zI − A)⁻¹ b over z."""
    n = A.shape[0]
    if n == 0:
        return np.zeros_like(z)
    x = np.linalg.solve(z[:, None, None] * np.eye(n) - A, np.broadcast_to(b[:, None], (z.size, n, 1)))
    return np.asarray(x[:, :, 0] @ c)
