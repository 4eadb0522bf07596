"""A law as equations over signals and curves, from which the matrices of a DiscreteSystem follow."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ...curves import PiecewiseLinear
from ...systems import DiscreteSystem
from ...systems.limits import POSITIVE_PART

Array = NDArray[np.float64]

#: Most curves of a law (numerics: soft landing with all bounds has 17).
MOST = 17


class CurveChain:
    """Curves one behind the other. A sum of shares of the signals and of the curves so far is an array: so a law is
    written as its equations. The signals are the law's states, then its inputs."""

    def __init__(self, signals: Sequence[str]) -> None:
        self._shares = np.eye(len(signals) + MOST)
        self.signals = dict(zip(signals, self._shares, strict=False))
        self._arguments: list[Array] = []
        self._curves: list[PiecewiseLinear] = []

    def curve(self, curve: PiecewiseLinear, argument: Array) -> Array:
        """curve(argument)."""
        self._arguments.append(argument)
        self._curves.append(curve)
        return self._shares[len(self.signals) + len(self._curves) - 1]

    def both(
        self, curve: PiecewiseLinear, argument: Array, offset: Array | float = 0.0
    ) -> tuple[Array, Array]:
        """curve(offset + argument) and curve(offset − argument): of both directions."""
        return self.curve(curve, offset + argument), self.curve(curve, offset - argument)

    def least(self, first: Array, second: Array) -> Array:
        """min(first, second)."""
        return first - self.curve(POSITIVE_PART, first - second)

    def system(
        self, name: str, output: Array, inputs: tuple[str, ...], dt: float, following: Mapping[str, Array]
    ) -> DiscreteSystem:
        """The law with the torque ``output``, that of a curve; ``following`` is each state one sample later."""
        p, n, m = len(following), len(self.signals), len(self._curves)
        z = np.array(self._arguments)[:, : n + m]
        x = np.array(list(following.values()))[:, : n + m]
        return DiscreteSystem(
            inputs=inputs, outputs=("torque_motor",), states=tuple(following), dt=dt, name=name,
            curves=tuple(self._curves), F=z[:, :p], G=z[:, p:n], H=z[:, n:], A=x[:, :p], B=x[:, p:n], E=x[:, n:],
            J=output[None, n : n + m],
        )  # fmt: skip
