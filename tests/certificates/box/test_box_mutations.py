"""Damaged certificates of boxes: the verifier's verdict is that of a check that is written on its own.

The check takes the package's inequalities, and each drivetrain of a cell from the nominal loop by equation 24: the
stiffness and the inertias multiply one row of the flow each, backlash and friction the curves alone.
"""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import combinations, product
from typing import Any

import numpy as np
import pytest
from damaged_certificates import drivetrain_of, leaves, mutated, said
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import ContinuousLaw, around, continuous_pi, prove_box, verdict
from lostmotion.certificates.box.cell import in_torque
from lostmotion.certificates.continuous.continuous_loop import continuous_loop
from lostmotion.certificates.equilibrium import Equilibrium, equilibrium
from lostmotion.certificates.lure import LureLoop, lure_loop
from lostmotion.certificates.rational import Matrix, is_positive_definite, rational
from lostmotion.certificates.sampled_proof import SampledProof, sampled_proof
from lostmotion.certificates.sectors import Sector, copies
from lostmotion.certificates.static_curves import StaticCurve

Shares = dict[str, Fraction]
Ends = dict[str, tuple[Fraction, Fraction]]

#: The row of the flow that a parameter multiplies, or divides.
ROWS = {"stiffness": 0, "inertia_motor": 1, "inertia_load": 2}
PARAMETERS = {*ROWS, "backlash", "coulomb"}


def independent(data: dict[str, Any]) -> bool:
    """Whether the certificate of a box without torque limit is proved."""
    claim = data["claim"]
    box = {name: (Fraction(low), Fraction(high)) for name, (low, high) in claim["box"].items()}
    nominal = nominal_loop(data)
    if not set(box) <= PARAMETERS or any(not 0 < low <= high for low, high in box.values()):
        return False
    if claim["both_directions"] and not nominal.is_odd:
        return False
    (slow, fast), (low, high) = (claim["speed_from"], claim["speed_to"]), claim["torque_load"]
    if not (0 < slow <= fast and low <= high) or claim["limit"] is not None:
        return False
    return all(proves(data, nominal, numbers, cell) for numbers, cell in cells(data["cells"], box))


def nominal_loop(data: dict[str, Any]) -> LureLoop:
    """The nominal loop in units of torque."""
    check_shapes(data["law"])
    plant = drivetrain_of(data)
    if data["law"]["dt"]:
        law = lm.DiscreteSystem.from_dict(data["law"])
        return in_torque(lure_loop(plant, law, delay=data["delay"]), plant)
    if data["delay"] or data["drivetrain"]["torque_limit"] is not None:
        raise ValueError("nothing is sampled")
    return in_torque(continuous_loop(plant, continuous_law(data["law"])), plant)


def check_shapes(law: dict[str, Any]) -> None:
    """Raise where a matrix of the law has another shape."""
    sizes = {
        "x": len(law["states"]),
        "u": len(law["inputs"]),
        "w": len(law["curves"]),
        "y": len(law["outputs"]),
    }
    shapes = {
        "A": "xx",
        "B": "xu",
        "E": "xw",
        "F": "wx",
        "G": "wu",
        "H": "ww",
        "C": "yx",
        "D": "yu",
        "J": "yw",
    }
    for key, (rows, columns) in shapes.items():
        if [len(row) for row in law[key]] != [sizes[columns]] * sizes[rows]:
            raise ValueError(f"{key} has another shape")


def continuous_law(data: dict[str, Any]) -> ContinuousLaw:
    if any(np.any(np.array(data[key], dtype=float)) for key in ("G", "H")):
        raise ValueError("a curve that reads an input, or another curve")
    n, u, w = len(data["states"]), len(data["inputs"]), len(data["curves"])
    shapes = {"A": (n, n), "B": (n, u), "E": (n, w), "F": (w, n), "C": (1, n), "D": (1, u), "J": (1, w)}
    matrices = {key: np.array(data[key], dtype=float).reshape(shape) for key, shape in shapes.items()}
    curves = tuple(
        StaticCurve(
            tuple((Fraction(z), Fraction(v)) for z, v in curve["points"]),
            Fraction(curve["slope_left"]), Fraction(curve["slope_right"]),
        )
        for curve in data["curves"]
    )  # fmt: skip
    return ContinuousLaw(
        inputs=tuple(data["inputs"]), states=tuple(data["states"]), curves=curves, **matrices
    )


def varied(loop: LureLoop, shares: Shares) -> LureLoop:
    """The loop with parameters multiplied (equation 24)."""
    made = {key: getattr(loop, key).copy() for key in ("A", "E", "L", "R")}
    for name, row in ROWS.items():
        share = shares.get(name, Fraction(1))
        for key, matrix in made.items():
            if key != "R" or loop.plant_size == len(loop.states):
                matrix[row] = matrix[row] * share if name == "stiffness" else matrix[row] / share
    wound = shares.get("stiffness", Fraction(1)) * shares.get("backlash", Fraction(1))
    friction = shares.get("coulomb", Fraction(1))
    curves = []
    for name, curve in zip(loop.names, loop.plant_curves, strict=False):
        wide, high = (wound, wound) if name == "gap" else (Fraction(1), friction if "friction" in name else 1)
        points = tuple((wide * z, high * w) for z, w in curve.points)
        curves.append(StaticCurve(points, curve.left, curve.right))
    return replace(loop, **made, plant_curves=tuple(curves))


def cells(node: dict[str, Any], cell: Ends) -> Iterator[tuple[Any, Ends]]:
    """The leaves with their cells; a cut outside of its cell leaves something open."""
    if "cut" not in node:
        yield node["proof"], cell
        return
    name, at = node["cut"], Fraction(node["at"])
    low, high = cell[name]
    if not low < at < high:
        raise ValueError("a cut outside of its cell")
    yield from cells(node["below"], {**cell, name: (low, at)})
    yield from cells(node["above"], {**cell, name: (at, high)})


def corners(cell: Ends, names: tuple[str, ...]) -> list[Shares]:
    """All combinations of ends, the first name slowest; a parameter that does not vary has one."""
    ends = [[(n, share) for share in sorted(set(cell[n]))] for n in names if n in cell]
    return [dict(each) for each in product(*ends)]


def proves(data: dict[str, Any], nominal: LureLoop, numbers: list[dict[str, Any]], cell: Ends) -> bool:
    """One cell: sectors of all of it, and each corner's numbers in its own flow; between corners, equation 25."""
    claim = data["claim"]
    largest = {name: cell[name][1] for name in ("stiffness", "backlash") if name in cell}
    rests: list[tuple[LureLoop, Equilibrium]] = []
    for corner in corners(cell, ("coulomb",)):
        loop = varied(nominal, {**largest, **corner})
        for speed, torque in product((claim["speed_from"], claim["speed_to"]), claim["torque_load"]):
            rest = equilibrium(loop, Fraction(speed), Fraction(torque))
            if rest is None or list(rest.segments) != data["segments"]:
                return False
            rests.append((loop, rest))
    loop = rests[0][0]
    pairs = tuple(c for c in copies(loop, [r for _, r in rests]) if loop.names[c.first].startswith("law: "))
    bounds = widest(rests)
    places = corners(cell, ("stiffness", "inertia_load", "inertia_motor"))
    if len(numbers) != len(places):
        return False
    found, sampled = [], bool(data["law"]["dt"])
    for place, own in zip(places, numbers, strict=True):
        problem = sampled_proof(varied(nominal, place), rests[0][1], bounds, pairs, own["substeps"])
        unknowns = unknowns_of(problem, own, sampled)
        if unknowns is None or not holds(problem, unknowns, sampled):
            return False
        found.append(unknowns)
    return all(between(*pair) for pair in combinations(zip(places, found, strict=True), 2))


def widest(rests: list[tuple[LureLoop, Equilibrium]]) -> list[Sector]:
    found = []
    for i, _ in enumerate(rests[0][1].arguments):
        each = [(*lp.plant_curves, *lp.law_curves)[i].sector(rest.arguments[i]) for lp, rest in rests]
        found.append(Sector(min(low for low, _ in each), max(high for _, high in each)))
    return found


def unknowns_of(problem: SampledProof, own: dict[str, Any], sampled: bool) -> dict[str, Matrix] | None:
    """The numbers of a corner as ``SampledProof`` has them; None where shape, sign or symmetry is wrong."""
    m, knots = own["multipliers"], problem.substeps + 1
    if any(v < 0 for values in m.values() for v in values):
        return None
    if not sampled:  # V is the same at both ends, and nothing reads the others
        none = [0.0] * sum(problem.layout().multipliers[f"jump_{what}"] for what in ("sectors", "copies"))
        m = {**m, "rest_1": m["rest_0"], "flow_0_1": m["flow_0_0"], "jump": none}
    found = {f"P{k}": rational(p) for k, p in enumerate(own["P"])}
    found |= {name: rational(m[name]) for name in ("eta_plus", "eta_minus", "theta_plus", "theta_minus")}
    ends = [f"flow_{k}_{end}" for k in range(problem.substeps) for end in (0, 1)]
    names = {"rest": [f"rest_{k}" for k in range(knots)], "flow": ends, "jump": ["jump"]}
    for where, each in names.items():
        count = problem.layout().multipliers[f"{where}_sectors"] // len(each)
        found[f"{where}_sectors"] = rational([v for name in each for v in m[name][:count]])
        found[f"{where}_copies"] = rational([v for name in each for v in m[name][count:]])
    wanted = {
        **dict.fromkeys([f"P{k}" for k in range(knots)], problem.size**2),
        **problem.layout().multipliers,
    }
    if {name: value.size for name, value in found.items()} != wanted:
        return None
    return found if all(np.array_equal(found[f"P{k}"], found[f"P{k}"].T) for k in range(knots)) else None


def holds(problem: SampledProof, unknowns: dict[str, Matrix], sampled: bool) -> bool:
    if sampled:
        return all(map(is_positive_definite, problem.conditions(unknowns)))
    if problem.substeps != 1 or not np.array_equal(unknowns["P0"], unknowns["P1"]):
        return False
    return all(map(is_positive_definite, (problem.positive(unknowns, 0), problem.falls(unknowns, 0, 0))))


def between(first: tuple[Shares, dict[str, Matrix]], second: tuple[Shares, dict[str, Matrix]]) -> bool:
    """Equation 25: integrals alike, and the row of P alike that belongs to the one parameter that differs."""
    (place, own), (other_place, other) = first, second
    if any(not np.array_equal(own[name], other[name]) for name in ("eta_plus", "eta_minus")):
        return False
    differ = [name for name in place if place[name] != other_place[name]]
    if len(differ) > 1:
        return True
    row = ROWS[differ[0]]
    return all(np.array_equal(own[n][row], other[n][row]) for n in own if n.startswith("P"))


#: Boxes whose certificates are damaged: with cuts, sampled, and with a load torque.
BOXES: dict[str, dict[str, Any]] = {
    "PI in continuous time, ±20 %": {
        "law": continuous_pi(), "box": around(0.2, ("stiffness", "coulomb", "inertia_load")), "speed": 0.2,
    },
    "PI, 0.1 ms, ±5 %": {"law": lm.controllers.pi(dt=1e-4), "box": around(0.05, ("inertia_load", "coulomb"))},
    "PI with load torque": {
        "law": continuous_pi(), "box": around(0.1, ("stiffness", "inertia_motor")), "torque_load": (-0.5, 0.5),
    },
}  # fmt: skip


def certificate(name: str) -> dict[str, Any]:
    """The certificate of one of the boxes."""
    proof = prove_box(PAPER, workers=1, **BOXES[name])
    assert proof.proved
    return json.loads(json.dumps(proof.certificate))


def verdicts(data: dict[str, Any], count: int, seed: int) -> tuple[int, int]:
    """Of so many damaged certificates: on how many verifier and check agree, and how many still prove their claim."""
    rng, paths = random.Random(seed), leaves(data)
    # Every second damage is outside of the many numbers of the cells.
    few = [path for path in paths if "proof" not in path]
    agreed = proved = 0
    for i in range(count):
        damaged = mutated(data, rng, few if i % 2 else paths)
        own = said(lambda d: verdict(d) is None, damaged)
        agreed += own == said(independent, damaged)
        proved += own
    return agreed, proved


#: Damaged certificates of each box (``benchmarks/certify.py --boxes --mutations 1000`` takes a thousand in all).
MUTATIONS = 20


@pytest.mark.parametrize("name", BOXES)
def test_its_verdict_on_a_box_is_that_of_an_independent_check(name: str) -> None:
    data = certificate(name)
    assert verdict(data) is None and independent(data)
    agreed, proved = verdicts(data, MUTATIONS, seed=3)
    assert agreed == MUTATIONS and proved < MUTATIONS
