"""Textbook Lur'e systems with known limits of the sector, through the very inequalities of the proofs."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from lostmotion.certificates.sampled_proof import SampledProof
from lostmotion.certificates.semidefinite import Inequalities, Unknowns

NOTHING = np.zeros((0, 0))


def continuous(a: np.ndarray, b: np.ndarray, c: np.ndarray, slope: float, dt: float = 0.05) -> SampledProof:
    """ẋ = A x − b·w(c x) with a curve in [0, slope]; at its samples nothing happens."""
    n = a.shape[0]
    return SampledProof(
        A=dt * a, E=-dt * b, Z=c, S=np.eye(n), S_w=np.zeros((n, 1)), S_v=np.zeros((n, 0)), N=np.zeros((0, n)),
        N_w=np.zeros((0, 1)), N_v=NOTHING, sectors=np.array([[0.0, slope]]), slopes=np.zeros(1),
        steepest=np.array([np.inf]), copies=(), of_state=(), seen=(), substeps=1,
    )  # fmt: skip


def discrete(a: np.ndarray, b: np.ndarray, c: np.ndarray, slope: float, integral: bool) -> SampledProof:
    """x⁺ = A x − b·v(c x) with a rising curve in [0, slope]; between samples nothing happens."""
    n = a.shape[0]
    return SampledProof(
        A=np.zeros((n, n)), E=np.zeros((n, 0)), Z=np.zeros((0, n)), S=a, S_w=np.zeros((n, 0)), S_v=-b, N=c,
        N_w=np.zeros((1, 0)), N_v=np.zeros((1, 1)), sectors=np.array([[0.0, slope]]), slopes=np.zeros(1),
        steepest=np.array([slope]), copies=(), of_state=(0,) if integral else (), seen=(), substeps=1,
    )  # fmt: skip


def provable(proof: SampledProof, popov: bool) -> bool:
    def conditions(unknowns: Unknowns) -> list[Any]:
        given = dict(unknowns)
        if not popov:
            given |= {name: 0.0 * given[name] for name in ("eta_plus", "eta_minus")}
        return proof.conditions(given)

    zeros = proof.layout().unknowns(np.zeros(proof.layout().size))
    scales = [np.ones(matrix.shape[0]) for matrix in proof.conditions(zeros)]
    found = Inequalities(conditions, proof.layout(), scales).largest_margin()
    if found is None:
        return False
    return all(np.linalg.eigvalsh(matrix)[0] > 0.0 for matrix in conditions(found[0]))


def limit(make: Any, popov: bool, low: float, high: float) -> float:
    """Largest slope that is proved, to a ten-thousandth."""
    assert provable(make(low), popov) and not provable(make(high), popov)
    while high - low > 1e-4 * high:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if provable(make(middle), popov) else (low, middle)
    return low


#: 1/(s + 1)³: Popov reaches Hurwitz, 8; the circle is −1/min Re G, 4 (numerics).
THIRD_ORDER = (
    np.array([[-1.0, 1.0, 0.0], [0.0, -1.0, 1.0], [0.0, 0.0, -1.0]]),
    np.array([[0.0], [0.0], [1.0]]),
    np.array([[1.0, 0.0, 0.0]]),
)


def test_popov_reaches_hurwitz_for_three_equal_lags() -> None:
    assert limit(lambda k: continuous(*THIRD_ORDER, k), True, 7.0, 8.5) == pytest.approx(8.0, rel=1e-3)


def test_circle_criterion_of_three_equal_lags() -> None:
    omega = np.linspace(0.01, 20.0, 2_000_001)
    expected = -1.0 / np.min((1.0 / (1j * omega + 1.0) ** 3).real)
    assert expected == pytest.approx(4.0, rel=1e-6)
    assert limit(lambda k: continuous(*THIRD_ORDER, k), False, 3.0, 5.0) == pytest.approx(expected, rel=1e-3)


#: 0.1 z/(z² − 1.8 z + 0.81), a usual example of discrete criteria: circle 0.7934, Tsypkin 3.80, Nyquist 36.1.
DISCRETE = (np.array([[1.8, -0.81], [1.0, 0.0]]), np.array([[1.0], [0.0]]), np.array([[0.1, 0.0]]))


def test_discrete_circle_and_integral() -> None:
    omega = np.linspace(1e-4, np.pi, 2_000_001)
    z = np.exp(1j * omega)
    g = 0.1 * z / (z**2 - 1.8 * z + 0.81)
    circle = -1.0 / np.min(g.real)
    assert circle == pytest.approx(0.7934, rel=1e-3)
    assert limit(lambda k: discrete(*DISCRETE, k, False), True, 0.5, 1.0) == pytest.approx(circle, rel=1e-3)
    with_integral = limit(lambda k: discrete(*DISCRETE, k, True), True, 1.0, 37.0)
    assert 3.80 < with_integral < 36.1, "better than Tsypkin's criterion, below the linear loop's limit"
