"""Certificates made to prove what is not so: names that collide, claims that are not checked, limits that fall."""

from __future__ import annotations

import copy
from fractions import Fraction
from typing import Any

import pytest
from table_i import PAPER, TABLE_I

import lostmotion as lm
from lostmotion.certificates import around, continuous_pi, prove_box, prove_running, verdict
from lostmotion.certificates.equilibrium import equilibrium
from lostmotion.certificates.lure import lure_loop, with_memory
from lostmotion.certificates.sampled_proof import sampled_proof
from lostmotion.certificates.sectors import copies, limit_region, sectors

PI = lm.controllers.pi(dt=1e-4)
LIMIT = 73.5


@pytest.fixture(scope="module")
def delayed() -> dict[str, Any]:
    proof = prove_running(PAPER, PI, delay=1, torque_load=(-1.0, 0.0), speeds=(0.5,))
    assert proof.certificate is not None
    return proof.certificate


def test_states_of_law_and_delay_may_have_one_name(delayed: dict[str, Any]) -> None:
    """A state of the delay that took the place of the law's would make the loop another one."""
    data = copy.deepcopy(delayed)
    data["law"]["states"] = ["torque_motor_1"]
    assert verdict(data) is None


@pytest.mark.parametrize(
    ("change", "reason"),
    [
        ({"box": {"stiffness": [0.5, 2.0]}}, "a claim of another kind"),
        ({"torque_load": [-1.0, 3.0]}, ""),
        ({"speed_from": 0.0}, "no ranges"),
        ({"speed_from": -1.0}, "no ranges"),
        ({"limit": {"step": 1.0, "share": 0.5}}, "no torque limit"),
    ],
    ids=["a box", "a torque that opens the gap", "standstill", "through standstill", "a limit"],
)
def test_a_claim_that_the_numbers_do_not_prove(
    delayed: dict[str, Any], change: dict[str, Any], reason: str
) -> None:
    assert verdict(delayed) is None
    found = verdict({**delayed, "claim": {**delayed["claim"], **change}})
    assert found is not None and reason in found


def test_a_certificate_of_an_older_version_says_so(delayed: dict[str, Any]) -> None:
    old = {**delayed, "proof": {**delayed["proof"], "gap_memory": True}}
    assert "another version" in (verdict(old) or "")


@pytest.fixture(scope="module")
def limited() -> dict[str, Any]:
    """A proof within the region of a torque limit that acts."""
    parts = [
        lm.observers.kalman(PAPER, dt=1e-4),
        lm.controllers.pole_placement(PAPER, dt=1e-4, torque_limit=LIMIT),
    ]
    law = lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))
    data = prove_running(PAPER, law, speeds=(0.5,)).certificate
    assert data is not None and data["claim"]["limit"] is not None and verdict(data) is None
    return data


def test_copies_of_the_limit_do_not_prove_the_bound_that_they_need(limited: dict[str, Any]) -> None:
    """The sector of the limit holds where its argument is bounded, and (17) proves the bound: a copy of the limit, its
    own value at the last sample, would bring the sector into that proof by a side door."""
    loop = lure_loop(PAPER, lm.DiscreteSystem.from_dict(limited["law"]))
    assert loop.limit is not None
    place = len(loop.plant_curves) + loop.limit
    remembering = with_memory(loop, (place,))
    rests = [equilibrium(remembering, Fraction(speed), Fraction(0)) for speed in (0.5, 1000.0)]
    corners = [rest for rest in rests if rest is not None]
    bounds, pairs = sectors(remembering, corners), copies(remembering, corners)
    assert bounds is not None and any(place in pair[:2] for pair in pairs), "the copy is known as one"
    region, bounds = limit_region(remembering, corners, bounds, Fraction(1, 2), Fraction(1, 2))
    kept = sampled_proof(remembering, corners[0], bounds, pairs, 1, region).copies
    assert kept and not any(place in pair[:2] for pair in kept)
    # The verifier takes no such loop at all: the copy rests on a slope, where (18) wants every integral to be zero.
    data = copy.deepcopy(limited)
    data["proof"]["memory"] = [place]
    data["segments"].append(data["segments"][place])
    assert f"curve_{loop.limit} at the last sample rests on a slope" in (verdict(data) or "")


@pytest.mark.parametrize(
    ("memory", "reason"),
    [([0, 0], "two states of one name"), ([0, 99], "IndexError"), ([-1], "a number of things")],
    ids=["twice", "of a memory", "from the end"],
)
def test_no_curve_is_a_copy_of_a_copy(limited: dict[str, Any], memory: list[int], reason: str) -> None:
    """The memory of a memory, or two of one curve: copies whose argument hangs on the copies themselves."""
    data = copy.deepcopy(limited)
    data["proof"]["memory"] = [len(data["segments"]) if place == 99 else place for place in memory]
    data["segments"] += [data["segments"][0]] * len(memory)
    assert reason in (verdict(data) or "")


def test_a_limit_that_falls_beyond_its_corner_is_no_limit(limited: dict[str, Any]) -> None:
    """Its chord slopes beyond the corner are below the share of the slope that the region counts on."""
    data = copy.deepcopy(limited)
    place = next(i for i, c in enumerate(data["law"]["curves"]) if c["points"][-1] == [LIMIT, LIMIT])
    falling = [[-3 * LIMIT, LIMIT], [-LIMIT, -LIMIT], [LIMIT, LIMIT], [3 * LIMIT, -LIMIT]]
    data["law"]["curves"][place]["points"] = falling
    plant_curves = len(data["segments"]) - len(data["law"]["curves"])
    data["segments"][plant_curves + place] += 1
    assert "no torque limit" in (verdict(data) or "")
    assert lure_loop(PAPER, lm.DiscreteSystem.from_dict(data["law"])).limit is None


def test_a_box_of_a_law_that_reads_the_twist() -> None:
    """Where such a law rests hangs on the backlash, which no corner of a cell varies."""
    box = prove_box(PAPER, continuous_pi(), around(0.05, ("backlash",)), workers=1)
    assert box.proved
    data = copy.deepcopy(box.certificate)
    data["law"]["inputs"].append("twist")
    for key in ("B", "D", "G"):
        data["law"][key] = [[*row, 0.0] for row in data["law"][key]]
    assert "twist" in (verdict(data) or "")


def test_a_longer_delay_than_modelled_gets_no_certificate_and_swings() -> None:
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    assert prove_running(plant, PI, delay=60, speeds=(1.0, 80.0)).certificate is None
    loop = lm.simulate(plant, law=PI, dt=1e-4, speed_reference=[2.0] * 10_000, delay=60)
    assert abs(loop["speed_motor"][-2000:] - 2.0).max() > 1.0
