"""A cell: its parameters enter where the proof says, and between its corners the inequalities hold too."""

from __future__ import annotations

from functools import partial
from itertools import product

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.certificates.box.cell import RATE_OF, Cell, flow_corners, in_torque, scaled
from lostmotion.certificates.box.cell_solver import CellClaim, solve_cell
from lostmotion.certificates.continuous.continuous_law import continuous_pi
from lostmotion.certificates.continuous.continuous_loop import continuous_loop
from lostmotion.certificates.lure import LureLoop, lure_loop
from lostmotion.certificates.running import Unproved
from lostmotion.controllers import pi

CELL: Cell = {
    "inertia_load": (0.9, 1.1),
    "stiffness": (0.95, 1.1),
    "coulomb": (0.9, 1.05),
    "backlash": (0.8, 1.1),
}


def loop_with(**shares: float) -> LureLoop:
    plant = scaled(PAPER, shares)
    return in_torque(lure_loop(plant, pi(dt=1e-4)), plant)


def test_in_units_of_torque_each_parameter_is_in_one_row_of_the_flow() -> None:
    nominal = loop_with()
    for name in ("inertia_load", "stiffness", "inertia_motor", "coulomb", "backlash"):
        loop = loop_with(**{name: 1.25})
        others = [i for i in range(len(loop.states)) if i != RATE_OF.get(name)]
        assert np.array_equal(loop.A[others], nominal.A[others]) and np.array_equal(
            loop.E[others], nominal.E[others]
        )
        for key in ("Z", "S", "S_w", "N", "N_w", "R"):
            assert np.array_equal(getattr(loop, key), getattr(nominal, key)), (name, key)
        if name in RATE_OF:
            assert not np.array_equal(loop.A, nominal.A)


def test_units_change_no_eigenvalue() -> None:
    plant = scaled(PAPER, {"stiffness": 1.1})
    given = continuous_loop(plant, continuous_pi())
    in_nm = in_torque(given, plant)
    for slopes in ((0.0, 0.0), (70.0, 1.0)):
        # A slope of a curve of height 1, and of the same curve in Nm over Nm, or Nm over rad/s.
        w = plant.backlash * slopes[0], 2 * plant.coulomb * slopes[1]
        poles = np.linalg.eigvals((given.A + given.E @ np.diag(slopes) @ given.Z).astype(float))
        same = np.linalg.eigvals((in_nm.A + in_nm.E @ np.diag(w) @ in_nm.Z).astype(float))
        assert np.sort_complex(poles) == pytest.approx(np.sort_complex(same), rel=1e-6)


@pytest.mark.parametrize("continuous", [True, False])
def test_between_the_corners_the_interpolated_proof_holds(continuous: bool) -> None:
    if continuous:
        claim = CellClaim(
            PAPER, partial(continuous_loop, law=continuous_pi()), (1.0, 1000.0), continuous=True
        )
    else:
        claim = CellClaim(PAPER, partial(lure_loop, law=pi(dt=1e-4)), (1.0, 1000.0))
    found = solve_cell(claim, CELL)
    proof, corners = found.proof, flow_corners(CELL)
    numbers = [proof.at_corner(found.unknowns, i) for i in range(len(corners))]
    rng = np.random.default_rng(5)
    for _ in range(20):
        shares = {name: float(rng.uniform(*ends)) for name, ends in CELL.items()}
        weights = interpolation(shares, corners)
        own = {name: sum(w * n[name] for w, n in zip(weights, numbers, strict=True)) for name in numbers[0]}
        plant = scaled(PAPER, shares)
        loop = in_torque(claim.loop_of(plant), plant)
        step = float(loop.dt)
        here = proof.proofs[0].__class__(
            **{**vars_of(proof.proofs[0]), "A": loop.A.astype(float) * step, "E": loop.E.astype(float) * step}
        )
        matrices = [here.positive(own, 0), here.falls(own, 0, 0)] if continuous else here.conditions(own)
        for matrix in matrices:
            size = 1.0 / np.sqrt(np.diag(matrix))
            assert np.linalg.eigvalsh(matrix * np.outer(size, size))[0] > 0.0


def vars_of(proof: object) -> dict[str, object]:
    """The fields of a proof, without what it has worked out."""
    from dataclasses import fields

    return {field.name: getattr(proof, field.name) for field in fields(proof)}  # type: ignore[arg-type]


def interpolation(shares: dict[str, float], corners: list[dict[str, float]]) -> list[float]:
    """Weights of the corners at a point: one over an inertia, and the stiffness, are what enters linearly."""
    found = []
    for corner in corners:
        weight = 1.0
        for name, value in corner.items():
            low, high, here = (*CELL[name], shares[name])
            if name != "stiffness":
                low, high, here, value = 1.0 / low, 1.0 / high, 1.0 / here, 1.0 / value
            up = (here - low) / (high - low)
            weight *= up if value == high else 1.0 - up
        found.append(weight)
    assert sum(found) == pytest.approx(1.0)
    return found


def test_corners_are_all_combinations() -> None:
    names = ("stiffness", "inertia_load")
    assert flow_corners(CELL) == [
        dict(zip(names, ends, strict=True)) for ends in product(*(sorted(CELL[name]) for name in names))
    ]


def test_a_cell_that_is_too_large_is_not_proved() -> None:
    claim = CellClaim(PAPER, partial(continuous_loop, law=continuous_pi()), (1.0, 1000.0), continuous=True)
    with pytest.raises(Unproved):
        solve_cell(claim, dict.fromkeys(CELL, (0.3, 3.0)))
