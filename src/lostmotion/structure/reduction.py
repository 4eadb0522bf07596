"""Reduce a torsional model to a chain of few inertias with the same response and the same inertia on each side."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .from_frequencies import chain_from_frequencies, damped_chain
from .modes import modes, zeros
from .torsional_model import TorsionalModel, from_drivetrain

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]

#: Within this share of a zero or pole of the model the response is not scored: a shift of a thousandth dominates there.
#: (Option.)
AROUND_RESONANCE = 0.03
#: Points of the scored response on a logarithmic grid (numerics).
POINTS = 400
#: Weight of the first n − 1 zeros and poles beside the response (numerics): they decide only where the response does
#: not, because the band has too few frequencies.
RESONANCE_WEIGHT = 3e-3
#: Error of the response that counts as 1, in the logarithm of the magnitude: 0.1, so 0.9 dB (numerics).
SCALE = 0.1


@dataclass(frozen=True, eq=False)
class ChainReduction:
    """A chain of few inertias in place of a torsional model.

    Parameters
    ----------
    drivetrain : Drivetrain
        Linear: no backlash yet, no friction. Referred to the first shaft.
    gap_shaft : int, optional
        Index of the shaft with the gap: inertias up to it are the motor side. None: no gap was named.
    inertia_sides : tuple of floats, kg m²
        Motor and load side, or the total where no gap was named; of the chain and of the model alike.
    frequency : (m,) array, Hz
    model_response, chain_response : (m,) complex arrays, rad/Nm
        Motor angle over motor torque with modal damping.
    scored : (m,) bool array
        Away from the model's zeros and poles.
    """

    drivetrain: Drivetrain
    gap_shaft: int | None
    inertia_sides: tuple[float, ...]
    frequency: Floats
    model_response: Complexes
    chain_response: Complexes
    scored: NDArray[np.bool_]

    @property
    def error_db(self) -> Floats:
        """Chain over model in dB, (m,)."""
        return np.asarray(20.0 * np.log10(np.abs(self.chain_response / self.model_response)))

    @property
    def worst_db(self) -> float:
        """Largest scored error, dB."""
        return float(np.max(np.abs(self.error_db[self.scored])))


@checks_arguments
def reduce_to_chain(
    model: TorsionalModel,
    n: int,
    *,
    gap: str | int | None,
    band: tuple[float, float] = (5.0, 150.0),
    gap_shaft: int | None = None,
    motor: str | int = 0,
) -> ChainReduction:
    """The chain of n inertias that is closest to the model's response, with the same inertia on each side of the gap.

    Fitted are the stiffnesses and the distribution of the inertia on each side. With ``gap=None`` only the total is
    kept, as in the paper's four equations: two masses then follow the response better, but may take over inertia from
    beyond the gap. The start is the chain with the model's first n − 1 zeros and poles. The fit minimises the logarithm
    of chain over model on a logarithmic grid over the band, without ±3 % around the model's zeros and poles: first its
    square, then its fourth power, which is closer to the largest error.

    Parameters
    ----------
    model : TorsionalModel
        With the gap closed.
    n : int
        2 or more, fewer than the model's nodes.
    gap : str, int or None
        Last node of the motor side; the element behind it has the gap.
    band : (float, float), Hz
        Default: the paper's range of interest around zero and pole.
    gap_shaft : int, optional
        The chain's shaft with the gap, 0 … n − 2; default: the one with the smallest error.
    motor : str or int
        Node of the motor.
    """
    places: list[int | None] = (
        [None] if gap is None else [*range(n - 1)] if gap_shaft is None else [gap_shaft]
    )
    if not 2 <= n < len(model.names) or any(p is not None and not 0 <= p < n - 1 for p in places):
        raise InvalidInput(
            "reduce_to_chain",
            f"n = {n}, gap_shaft = {gap_shaft}",
            f"2 ≤ n < {len(model.names)} nodes and a shaft 0 … n − 2",
            "Choose fewer inertias.",
        )
    if not 0.0 < band[0] < band[1]:
        raise InvalidInput("reduce_to_chain: band", f"{band} Hz", "0 < lower < upper", "Give it in Hz.")
    target = _Target(model, None if gap is None else model.node(gap), model.node(motor), band)
    results = [target.fit(n, place) for place in places]
    return min(results, key=lambda result: result.worst_db)


class _Target:
    """The model's response and sides, and the fit of one chain to them."""

    def __init__(self, model: TorsionalModel, gap: int | None, motor: int, band: tuple[float, float]) -> None:
        self.model = model
        self.sides = (model.inertia_total,) if gap is None else model.inertia_sides(gap)
        if min(self.sides) <= 0.0:
            raise InvalidInput(
                "reduce_to_chain: gap", f"node {gap}", "a node with inertia on both sides", "Move it."
            )
        self.zeros, found = zeros(model, motor), modes(model)
        self.poles = found.frequency[1:]
        resonances = np.concatenate([self.zeros, self.poles])
        raster = np.geomspace(*band, POINTS)
        edges = np.concatenate([(1.0 - AROUND_RESONANCE) * resonances, (1.0 + AROUND_RESONANCE) * resonances])
        edges = edges[(edges > band[0]) & (edges < band[1])]
        self.frequency = np.union1d(raster, edges)
        near = np.abs(self.frequency[:, None] / resonances - 1.0)
        self.scored = np.all(near >= AROUND_RESONANCE * (1.0 - 1e-9), axis=1)
        self.response = found.transfer(motor, motor, self.frequency)

    def fit(self, n: int, place: int | None) -> ChainReduction:
        from scipy.optimize import least_squares

        first = self.zeros[: n - 1], self.poles[: n - 1]
        start = chain_from_frequencies(first[0], first[1], inertia_total=sum(self.sides))
        inertias = self._with_sides(np.array(start.inertias), place)
        theta = np.log(np.concatenate([inertias, [shaft.stiffness for shaft in start.shafts]]))
        # A factor of e³ either way is far beyond any reduction, and avoids overflow of trial chains.
        low, high = theta - 3.0, theta + 3.0
        results = []
        for power in (1, 2):
            # Squared residuals make fourth powers: closer to the largest error, but flat where the chain fits well. So
            # they come second, and are kept only if they help.
            def residual(trial: Floats, power: int = power) -> Floats:
                chain = self._chain(np.clip(trial, low, high), n, place)
                error = np.log(np.abs(self._respond(chain) / self.response))[self.scored]
                linear = from_drivetrain(chain)
                shift = np.concatenate([zeros(linear), modes(linear).frequency[1:]]) / np.concatenate(first)
                return np.concatenate([(error / SCALE) ** power, RESONANCE_WEIGHT * np.log(shift)])

            theta = np.clip(least_squares(residual, theta, method="lm", max_nfev=1000).x, low, high)
            results.append(self._result(self._chain(theta, n, place), place))
        return min(results, key=lambda result: result.worst_db)

    def _result(self, chain: Drivetrain, place: int | None) -> ChainReduction:
        return ChainReduction(
            chain, place, self.sides, self.frequency, self.response, self._respond(chain), self.scored
        )

    def _with_sides(self, inertias: Floats, place: int | None) -> Floats:
        """Inertias scaled so that each side has the model's sum."""
        if place is None:
            return np.asarray(inertias * self.sides[0] / inertias.sum())
        sides = inertias[: place + 1], inertias[place + 1 :]
        return np.concatenate(
            [side * kept / side.sum() for side, kept in zip(sides, self.sides, strict=True)]
        )

    def _chain(self, theta: Floats, n: int, place: int | None) -> Drivetrain:
        values = np.exp(theta)
        return damped_chain(self._with_sides(values[:n], place), values[n:], self.model.damping_ratio)

    def _respond(self, chain: Drivetrain) -> Complexes:
        linear = from_drivetrain(chain, damping_ratio=self.model.damping_ratio)
        return modes(linear).transfer(0, 0, self.frequency)
