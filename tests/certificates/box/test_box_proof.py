"""Proofs for a box of drivetrains: found, checked, cut, interrupted and taken up again; damaged ones are refused."""

from __future__ import annotations

import copy
import json
from typing import Any

import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import (
    BoxProof,
    around,
    continuous_observer_feedback,
    continuous_pi,
    prove_box,
    verdict,
)
from lostmotion.certificates.box.cell_tree import open_cells
from lostmotion.errors import InvalidInput


@pytest.fixture(scope="module")
def twenty() -> BoxProof:
    """PI in continuous time with ±20 %: some cells, some cuts."""
    return prove_box(PAPER, continuous_pi(), around(0.2), workers=2)


def test_a_box_is_proved_cell_by_cell(twenty: BoxProof) -> None:
    assert twenty.proved and twenty.cells > 1 and twenty.share == 1.0
    assert verdict(json.loads(json.dumps(twenty.certificate))) is None


def test_the_exported_law_is_proved_for_ten_percent_of_both_inertias_and_friction() -> None:
    names = ("inertia_load", "coulomb", "inertia_motor")
    proof = prove_box(PAPER, lm.controllers.pi(dt=1e-4), around(0.1, names), workers=1)
    assert proof.proved and verdict(proof.certificate) is None


def leaf(tree: dict[str, Any]) -> dict[str, Any]:
    while "cut" in tree:
        tree = tree["below"]
    return tree


def damaged(name: str, data: dict[str, Any]) -> None:
    """What a certificate must not get away with."""
    tree, proofs = data["cells"], leaf(data["cells"])["proof"]
    match name:
        case "a wider box":
            data["claim"]["box"]["stiffness"] = [0.7, 1.3]
        case "more friction than claimed":
            data["claim"]["box"]["coulomb"] = [0.1, 1.2]
        case "a cut outside of its cell":
            tree["at"] = 1.5
        case "a cell without a proof":
            del leaf(tree)["proof"]
        case "a corner less":
            proofs.pop()
        case "a row of P that changes with its parameter":
            proofs[0]["P"] = [[[1.000001 * v for v in row] for row in p] for p in proofs[0]["P"]]
        case "another integral at one corner":
            proofs[0]["multipliers"]["eta_plus"][0] *= 1.000001
        case "P that moves although nothing is sampled":
            proofs[0]["P"][0][0][0] *= 1.0000001
        case "a slower load":
            data["claim"]["speed_from"] = 0.01


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("a wider box", "V"),
        ("more friction than claimed", "V"),
        ("a cut outside of its cell", "cut"),
        ("a corner less", "corners"),
        ("a row of P that changes with its parameter", "multi-affine"),
        ("another integral at one corner", "integrals"),
        ("P that moves although nothing is sampled", "P changes"),
        ("a slower load", "V"),
    ],
)
def test_a_damaged_certificate_is_refused(twenty: BoxProof, name: str, reason: str) -> None:
    data = copy.deepcopy(twenty.certificate)
    damaged(name, data)
    assert reason in (verdict(data) or "")


def test_a_cell_without_a_proof_is_no_certificate(twenty: BoxProof) -> None:
    data = copy.deepcopy(twenty.certificate)
    damaged("a cell without a proof", data)
    assert "no certificate" in (verdict(data) or "")


def test_an_interrupted_search_keeps_its_cells_and_goes_on() -> None:
    calls = []

    def stop(share: float, text: str) -> None:
        calls.append(share)
        if 0.0 < share < 1.0:
            raise KeyboardInterrupt

    first = prove_box(PAPER, continuous_pi(), around(0.2), workers=1, progress=stop)
    assert not first.proved and first.reason == "interrupted" and 0.0 < first.share < 1.0
    assert first.certificate["claim"] is None
    kept = json.loads(json.dumps(first.certificate))
    before = copy.deepcopy(kept["cells"])
    second = prove_box(PAPER, continuous_pi(), around(0.2), workers=1, earlier=kept)
    assert second.proved and verdict(second.certificate) is None
    assert leaves(before) <= leaves(second.certificate["cells"])
    # Of another box nothing is taken.
    third = prove_box(PAPER, continuous_pi(), around(0.05), workers=1, earlier=kept)
    assert third.proved and third.cells == 1


def leaves(tree: dict[str, Any]) -> set[str]:
    if "cut" in tree:
        return leaves(tree["below"]) | leaves(tree["above"])
    return {json.dumps(tree["proof"])} if "proof" in tree else set()


def test_where_no_proof_is_found_the_drivetrain_is_named() -> None:
    law = continuous_observer_feedback(PAPER)
    proof = prove_box(PAPER, law, around(0.3), speed=0.16, workers=1)
    assert not proof.proved and proof.certificate["claim"] is None and proof.cells == 0
    assert proof.stops_at is not None and set(proof.stops_at) == set(around(0.3))
    assert next(open_cells(proof.certificate["cells"], proof.box))[1] == proof.box


def test_what_a_box_cannot_be_is_refused() -> None:
    with pytest.raises(InvalidInput, match="half_width"):
        around(1.0)
    with pytest.raises(InvalidInput, match="damping"):
        around(0.1, ("damping",))
    parts = [
        lm.observers.kalman(PAPER, measured=("speed_motor", "twist"), dt=1e-4),
        lm.controllers.pole_placement(PAPER, dt=1e-4),
    ]
    law = lm.connect(parts, ("speed_reference", "speed_motor", "twist"), ("torque_motor",))
    with pytest.raises(InvalidInput, match="twist"):
        prove_box(PAPER, law, around(0.1))
