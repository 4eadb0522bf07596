"""Free modal analysis of a torsional model, its transfer functions, and the zeros at one node."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .torsional_model import TorsionalModel

Floats = NDArray[np.float64]

#: An eigenvalue below this multiple of n·eps·(largest) is a rigid rotation (numerics: zero up to rounding).
RIGID = 100.0


@dataclass(frozen=True, eq=False)
class Modes:
    """Eigenmodes of a free torsional model.

    Parameters
    ----------
    model : TorsionalModel
    frequency : (n,) array, Hz
        Undamped, rising; exactly 0 for rigid rotation.
    shapes : (n nodes, n modes) array, 1/√(kg m²)
        Of unit modal mass, angles referred to the first shaft; the first node moves in the positive direction.
    """

    model: TorsionalModel
    frequency: Floats
    shapes: Floats

    def own_shapes(self) -> Floats:
        """Shapes in the angles of each node's own shaft (behind gears), (n nodes, n modes)."""
        return self.shapes / self.model.ratios[:, None]

    def transfer(
        self,
        torque_at: str | int,
        angle_at: str | int,
        frequency: ArrayLike,
        *,
        damping_ratio: float | None = None,
    ) -> NDArray[np.complex128]:
        """Angle over torque, rad/Nm, each on its node's own shaft: Σ φᵢφⱼ/(ω_r² − ω² + 2j·D·ω_r·ω).

        Parameters
        ----------
        torque_at, angle_at : str or int
            Nodes, by name or index.
        frequency : (m,) array, Hz, above 0 for a free model
        damping_ratio : float, optional
            Default: the model's.

        Returns
        -------
        (m,) complex array
        """
        f = np.asarray(frequency, dtype=float)
        if self.frequency[0] == 0.0 and np.any(f <= 0.0):
            raise InvalidInput(
                "transfer: frequency",
                f"{f.min()} Hz",
                "above 0 Hz",
                "The response of a free model is infinite at 0 Hz.",
            )
        ratio = self.model.damping_ratio if damping_ratio is None else damping_ratio
        i, j = self.model.node(torque_at), self.model.node(angle_at)
        shapes = self.own_shapes()
        w, poles = 2.0 * np.pi * f[:, None], 2.0 * np.pi * self.frequency
        terms = shapes[i] * shapes[j] / (poles**2 - w**2 + 2j * ratio * poles * w)
        return np.asarray(terms.sum(axis=1), dtype=complex)


@checks_arguments
def modes(model: TorsionalModel) -> Modes:
    """Eigenfrequencies and mass-normalised shapes of K·φ = ω²·M·φ."""
    squares, shapes = _eigen(model.stiffness, model.mass)
    shapes = shapes * np.where(shapes[0] < 0.0, -1.0, 1.0)
    return Modes(model, np.sqrt(squares) / (2.0 * np.pi), shapes)


@checks_arguments
def zeros(model: TorsionalModel, at: str | int = 0) -> Floats:
    """Zeros (Hz, undamped) of angle over torque at one node: eigenfrequencies with that node locked, (n − 1,)."""
    i = model.node(at)
    squares, _ = _eigen(
        np.delete(np.delete(model.stiffness, i, 0), i, 1), np.delete(np.delete(model.mass, i, 0), i, 1)
    )
    return np.asarray(np.sqrt(squares) / (2.0 * np.pi))


def _eigen(stiffness: Floats, mass: Floats) -> tuple[Floats, Floats]:
    if stiffness.size == 0:
        return np.empty(0), np.empty((0, 0))
    from scipy.linalg import eigh

    squares, shapes = eigh(stiffness, mass)
    noise = RIGID * len(squares) * np.finfo(float).eps * squares[-1]
    return np.where(squares < noise, 0.0, squares), shapes
