"""A sampled loop opened at the motor torque: continuous plant, discrete law, exact between them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...systems import zero_order_hold

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: Distance from 1 up to which a pole counts as a drift (numerics: rounding of a law's numbers; a pole of 0.1 rad/s at
#: 0.1 ms is at 1e-5).
DRIFT = 1e-9


@dataclass(frozen=True, eq=False, kw_only=True)
class OpenLoop:
    """A linear loop whose torque is held over each sample.

    ::

        ẋ  = A x + B u                     plant, u held
        c⁺ = reading·x + law·c             at a sample
        u⁺ = of_plant·x + of_law·c         L(z) = −u⁺(z)/u(z) in front of the hold: the loop is stable at gain 1

    Parameters
    ----------
    A : (n, n) array, B : (n, 1) array
    reading : (k, n) array, law : (k, k) array
    of_plant : (n,) array, of_law : (k,) array
    dt : float, s
    """

    A: Array
    B: Array
    reading: Array
    law: Array
    of_plant: Array
    of_law: Array
    dt: float

    def step(self, late: float = 0.0) -> tuple[Array, Array, Array]:
        """Φ, Γ of the torque of this sample and Γ of the last one, which acts on for the share ``late`` of it."""
        return _steps(self, late)

    def closed(self) -> Array:
        """From sample to sample, (n + k, n + k)."""
        phi, now, _ = self.step()
        return np.block([
            [phi + np.outer(now, self.of_plant), np.outer(now, self.of_law)],
            [self.reading, self.law],
        ])  # fmt: skip

    @property
    def is_stable(self) -> bool:
        """Whether all poles but a drift at z = 1 are inside the unit circle.

        A drift that the torque does not move, or that moves no torque, cancels in L: the estimated twist in the open
        gap, an integrator while the load is held. Were it the loop's, L(1) = −1, and no margin would be left.
        """
        poles = np.linalg.eigvals(self.closed())
        return bool(np.all((np.abs(poles) < 1.0) | (np.abs(poles - 1.0) < DRIFT)))

    def response(self, turns: Array, late: float = 0.0) -> Complex:
        """L over frequencies in rad per sample, (f,); with the torque late by a share of a sample."""
        z = np.exp(1j * np.asarray(turns))
        phi, now, before = self.step(late)
        plant = _resolvent(phi, z, now + before / z[:, None])
        law = _resolvent(self.law, z, plant @ self.reading.T)
        return np.asarray(-(plant @ self.of_plant + law @ self.of_law))

    def poles(self) -> Complex:
        """Of L, with those that cancel."""
        phi = self.step()[0]
        both = [np.linalg.eigvals(m) for m in (phi, self.law) if m.size]
        return np.asarray(np.concatenate([np.zeros(0), *both]), dtype=complex)


@lru_cache(maxsize=64)
def _steps(loop: OpenLoop, late: float) -> tuple[Array, Array, Array]:
    if not loop.A.size:
        return loop.A, np.zeros(0), np.zeros(0)
    phi, whole = zero_order_hold(loop.A, loop.B, loop.dt)
    if late == 0.0:
        return phi, whole[:, 0], 0.0 * whole[:, 0]
    if late == 1.0:
        return phi, 0.0 * whole[:, 0], whole[:, 0]
    _, now = zero_order_hold(loop.A, loop.B, (1.0 - late) * loop.dt)
    return phi, now[:, 0], (whole - now)[:, 0]


def _resolvent(matrix: Array, z: Complex, right: Complex) -> Complex:
    """(zI − matrix)⁻¹ right for each z: (f, n) of (n, n), (f,) and (f, n)."""
    n = matrix.shape[0]
    if n == 0:
        return np.zeros((z.size, 0), dtype=complex)
    return np.asarray(np.linalg.solve(z[:, None, None] * np.eye(n) - matrix, right[:, :, None])[:, :, 0])
