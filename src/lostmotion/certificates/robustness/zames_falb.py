"""Zames and Falb's multipliers for a loop in continuous time, all of whose curves are one: docs/proofs.md, 33 to 35.

Of a rising curve with slopes up to m, w and u = m·z − w rise together at any two moments. So w with u of an earlier or
a later moment has at most the integral of w·u. Means of many moments, which filters make, have no more.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..certificate import short
from ..lure import LureLoop
from ..rational import Matrix, identity, is_positive_definite, rational
from ..sampled_proof import twice_product, twice_sum
from ..scaling import power_of_two
from ..semidefinite import Inequalities, Layout, Unknowns

Array = NDArray[np.float64]

#: Poles of the filters over the geometric mean of the linear loop's (numerics: any are sound; more may prove more, and
#: take longer. One proves all of the paper's loops).
POLES = (1.0,)


@dataclass(frozen=True, eq=False)
class ZamesFalb:
    """The conditions for curves with slopes between 0 and ``share`` of their steepest; exact or in floats.

    Parameters
    ----------
    A, E, Z : (n, n), (n, p), (p, n) array
        As in ``LureLoop``, rates over its time unit.
    slope : number
        Largest slope.
    poles : sequence of numbers
        Over the time unit.
    odd : bool
        Whether the curve is odd about its rest: then impulse responses may have either sign.
    """

    A: Matrix
    E: Matrix
    Z: Matrix
    slope: Any
    poles: Sequence[Any]
    odd: bool

    @property
    def kinds(self) -> list[tuple[int, int, str]]:
        """What may be weighted: of curves i and j, past wᵢ with uⱼ, wᵢ with past uⱼ, and both at one moment."""
        p = self.E.shape[1]
        names = [f"{past} {f}" for f in range(len(self.poles)) for past in ("w", "u")]
        pairs = product(range(p), repeat=2)
        return [(i, j, name) for i, j in pairs for name in (*names, *(["now"] if i != j else []))]

    @property
    def layout(self) -> Layout:
        """Names and sizes of the unknowns of ``conditions``."""
        n, p = self.E.shape
        signs = ("minus", "plus") if self.odd else ("minus",)
        weights = {sign: len(self.kinds) for sign in signs}
        return Layout(
            {"P": n + 2 * p * len(self.poles)}, {"own": p, **weights, "popov_plus": p, "popov_minus": p}
        )

    def conditions(self, unknowns: Unknowns) -> list[Matrix]:
        """Matrices that must be positive definite: the fall (equation 35), and what keeps the weights sound (34)."""
        rows = self._rows
        form = twice_sum(unknowns["P"] @ rows["state"], rows["rate"])
        w, u = rows["w"], rows["u"]
        for i, own in enumerate(unknowns["own"]):
            if own:
                form = form + own * twice_product(w[i], u[i])
        minus, plus = unknowns["minus"], unknowns.get("plus", 0 * unknowns["minus"])
        for (i, j, kind), down, up in zip(self.kinds, minus, plus, strict=True):
            if down or up:
                past, _, pole = kind.partition(" ")
                of_w = rows["past w"][int(pole), i] if past == "w" else w[i]
                of_u = rows["past u"][int(pole), j] if past == "u" else u[j]
                form = form + (up - down) * twice_product(of_w, of_u)
        popov = unknowns["popov_plus"] - unknowns["popov_minus"]
        for weight, wi, faster in zip(popov, w, rows["faster"], strict=True):
            if weight:
                form = form + weight * twice_product(wi, faster)
        return [-form, *self._left(unknowns["own"], minus + plus)]

    def _left(self, own: Matrix, weights: Matrix) -> list[Matrix]:
        """What a curve's own weight leaves beyond those of its filtered w, and of its filtered u."""
        left = []
        for place in range(own.size):
            for side in (0, 1):
                used = sum(v for kind, v in zip(self.kinds, weights, strict=True) if kind[side] == place)
                left.append(np.array([[own[place] - used]]))
        return left

    @cached_property
    def _rows(self) -> dict[str, Matrix]:
        """Rows over (ξ, filtered w, filtered u, w)."""
        n, p = self.E.shape
        count = p * len(self.poles)
        size = n + 2 * count
        unit = identity(size + p) if self.A.dtype == object else np.eye(size + p)
        xi, w = unit[:n], unit[size:]
        u = self.slope * (self.Z @ xi) - w
        past_w, past_u = (unit[n + k * count :][:count].reshape(len(self.poles), p, -1) for k in (0, 1))
        rates = [self.A @ xi + self.E @ w]
        for past, now in ((past_w, w), (past_u, u)):
            rates += [pole * (now - own) for pole, own in zip(self.poles, past, strict=True)]
        return {
            "state": unit[:size], "rate": np.vstack(rates), "w": w, "u": u, "past w": past_w, "past u": past_u,
            "faster": self.Z @ rates[0],
        }  # fmt: skip

    def sizes(self, of_state: Array) -> list[Array]:
        """Typical sizes of the vectors of ``conditions``, from those of ξ; in floats."""
        w = power_of_two(self.slope * (np.abs(self.Z) @ of_state))
        filtered = np.tile(w, 2 * len(self.poles))
        return [np.concatenate([of_state, filtered, w]), *[np.ones(1)] * (2 * w.size)]


def is_stable_with_flow(A: Matrix) -> bool:
    """Whether ξ̇ = A ξ goes to zero, by an exact Lyapunov function."""
    from scipy.linalg import solve_continuous_lyapunov

    floats = A.astype(float)
    if np.max(np.linalg.eigvals(floats).real) >= 0.0:
        return False
    scale = np.diag(power_of_two(np.abs(np.linalg.inv(floats)).sum(axis=0)))
    found = rational(short(solve_continuous_lyapunov(floats.T, -scale)))
    found = (found + found.T) / 2
    return is_positive_definite(found) and is_positive_definite(-twice_sum(found, A))


def weights(loop: LureLoop, share: Fraction, of_state: Array) -> tuple[ZamesFalb, Unknowns] | None:
    """The conditions with this share of the curves' steepest slope, and numbers that satisfy them in fractions, if any.

    ``of_state`` (n,): typical sizes of ξ. They prove the loop if it is stable without curves (``is_stable_with_flow``).
    """
    rates = np.abs(np.linalg.eigvals(loop.A.astype(float)))
    middle = Fraction(float(power_of_two(np.exp(np.mean(np.log(rates)))))) * loop.dt
    steepest = loop.plant_curves[0].steepest or Fraction(0)
    exact = ZamesFalb(
        loop.A * loop.dt, loop.E * loop.dt, loop.Z, share * steepest, [Fraction(pole) * middle for pole in POLES],
        all(curve.is_odd for curve in loop.plant_curves),
    )  # fmt: skip
    floats = ZamesFalb(
        exact.A.astype(float), exact.E.astype(float), exact.Z.astype(float), float(exact.slope),
        [float(pole) for pole in exact.poles], exact.odd,
    )  # fmt: skip
    found = Inequalities(floats.conditions, floats.layout, floats.sizes(of_state)).largest_margin()
    if found is None:
        return None
    unknowns = {name: rational(short(value)) for name, value in found[0].items()}
    return (exact, unknowns) if all(map(is_positive_definite, exact.conditions(unknowns))) else None
