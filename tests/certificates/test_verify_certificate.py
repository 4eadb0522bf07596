"""The verifier: alone, without packages; right about good certificates and about damaged ones."""

from __future__ import annotations

import copy
import json
import random
import shutil
import subprocess
import sys
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from damaged_certificates import drivetrain_of, leaves, mutated, said
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import prove_running, verdict, verify_certificate
from lostmotion.certificates.equilibrium import Equilibrium, equilibrium
from lostmotion.certificates.lure import LureLoop, lure_loop, with_memory
from lostmotion.certificates.rational import is_positive_definite, rational
from lostmotion.certificates.sampled_proof import sampled_proof
from lostmotion.certificates.sectors import Sector, copies, limit_region, sectors
from lostmotion.io import save_law


@pytest.fixture(scope="module")
def proved() -> tuple[lm.DiscreteSystem, dict[str, Any]]:
    """PI with torque limit and anti-windup, with a load torque: small, and every kind of condition is in it but
    copies."""
    plant = lm.Drivetrain.two_mass(**TABLE_I, torque_limit=73.5)
    law = lm.controllers.pi(dt=1e-4, torque_limit=73.5)
    proof = prove_running(plant, law, torque_load=(-1.0, 0.5), fastest=100.0)
    assert proof.certificate is not None
    return law, proof.certificate


def test_it_runs_without_any_package(
    tmp_path: Path, proved: tuple[lm.DiscreteSystem, dict[str, Any]]
) -> None:
    law, certificate = proved
    shutil.copy(verify_certificate.__file__, tmp_path / "verify_certificate.py")
    (tmp_path / "certificate.json").write_text(json.dumps(certificate))
    save_law(law, tmp_path / "law.json")
    save_law(lm.controllers.pi(dt=1e-4, kp=11.0, torque_limit=73.5), tmp_path / "other.json")

    def verified(*files: str) -> tuple[int, str]:
        # -I and -S: nothing but the standard library can be imported.
        command = [sys.executable, "-I", "-S", "verify_certificate.py", *files]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    assert verified("certificate.json")[0] == 0
    code, said = verified("certificate.json", "law.json")
    assert code == 0 and said.startswith("PROVED: asymptotically stable") and "from every state" in said
    code, said = verified("certificate.json", "other.json")
    assert code == 1 and "another law" in said


def independent(data: dict[str, Any]) -> bool:
    """The package's own conditions in fractions, from the certificate's drivetrain, law and numbers."""
    claim, own = data["claim"], data["proof"]
    plant = drivetrain_of(data)
    loop = lure_loop(plant, lm.DiscreteSystem.from_dict(data["law"]), delay=data["delay"])
    loop = with_memory(loop, own.get("memory", ()))
    corners = [
        equilibrium(loop, Fraction(r), Fraction(m))
        for m in claim["torque_load"]
        for r in (claim["speed_from"], claim["speed_to"])
    ]
    low, high = claim["torque_load"]
    if any(c is None or list(c.segments) != data["segments"] for c in corners) or low > high:
        return False
    if not 0 < claim["speed_from"] <= claim["speed_to"] or (claim["both_directions"] and not loop.is_odd):
        return False
    known = [c for c in corners if c is not None]
    bounds = sectors(loop, known)
    if bounds is None:
        return False
    pairs, region = copies(loop, known), None
    if claim["limit"] is not None:
        step, share = Fraction(claim["limit"]["step"]), Fraction(claim["limit"]["share"])
        if not (step > 0 and 0 < share <= 1) or not region_may_be(loop, known, bounds):
            return False
        region, bounds = limit_region(loop, known, bounds, step, share)
    problem = sampled_proof(loop, known[0], bounds, pairs, own["substeps"], region)
    m, knots = own["multipliers"], own["substeps"] + 1
    unknowns = {f"P{k}": rational(own["P"][k]) for k in range(knots)}
    unknowns |= {name: rational(m[name]) for name in ("eta_plus", "eta_minus", "theta_plus", "theta_minus")}
    ends = [(k, end) for k in range(own["substeps"]) for end in (0, 1)]
    for where, names in (
        ("rest", [f"rest_{k}" for k in range(knots)]),
        ("flow", [f"flow_{k}_{end}" for k, end in ends]),
        ("jump", ["jump"]),
        *([] if region is None else [("region", ["region"])]),
    ):
        count = problem.layout().multipliers[f"{where}_sectors"] // len(names)
        unknowns[f"{where}_sectors"] = rational([v for name in names for v in m[name][:count]])
        unknowns[f"{where}_copies"] = rational([v for name in names for v in m[name][count:]])
    if region is not None:
        unknowns["level"] = rational(m["level"])
    sizes = {**problem.layout().multipliers, **dict.fromkeys(problem.layout().symmetric)}
    if len(own["P"]) != knots or any(sizes[n] not in (None, v.size) for n, v in unknowns.items()):
        return False
    multipliers = [v for name, values in unknowns.items() if not name.startswith("P") for v in values.ravel()]
    symmetric = all(np.array_equal(unknowns[f"P{k}"], unknowns[f"P{k}"].T) for k in range(knots))
    if any(v < 0 for v in multipliers) or not symmetric:
        return False
    return all(is_positive_definite(matrix) for matrix in problem.conditions(unknowns))


def region_may_be(loop: LureLoop, corners: list[Equilibrium], bounds: tuple[Sector, ...]) -> bool:
    """Whether steps start where equation 18 says: every curve that the proof is about rests on a flat segment at all
    corners, but the limit, which does not act there; and there are two speeds."""
    if loop.limit is None or corners[0].speed == corners[1].speed:
        return False
    p = len(loop.plant_curves)
    moving: set[int] = set()
    for j in range(len(loop.law_curves)):
        inside = set(map(int, np.flatnonzero(loop.N_v[j])))
        if np.any(loop.N[j]) or np.any(loop.N_w[j]) or inside & moving:
            moving.add(j)
    for corner in corners:
        for i, curve in enumerate((*loop.plant_curves, *loop.law_curves)):
            slope = curve.slopes[corner.segments[i]]
            if i == p + loop.limit:
                if slope != bounds[i].high:
                    return False
            elif slope != 0 and (i < p or i - p in moving):
                return False
    return True


def test_its_verdict_is_that_of_an_independent_check(
    proved: tuple[lm.DiscreteSystem, dict[str, Any]],
) -> None:
    _, certificate = proved
    rng, paths = random.Random(1), leaves(certificate)
    assert verdict(certificate) is None and independent(certificate)
    verdicts = []
    for _ in range(150):
        data = mutated(certificate, rng, paths)
        own = said(lambda d: verdict(d) is None, data)
        assert own == said(independent, data), json.dumps(data)
        verdicts.append(own)
    assert 10 < sum(verdicts) < 140, "mutations of both kinds"


@pytest.fixture(scope="module")
def limited() -> dict[str, Any]:
    """Observer 1 with pole placement and a torque limit that acts: copies of the gap in the law, and a region."""
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    parts = [
        lm.observers.kalman(plant, dt=1e-4),
        lm.controllers.pole_placement(plant, dt=1e-4, torque_limit=73.5),
    ]
    law = lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))
    proof = prove_running(plant, law, speeds=(0.5,))
    assert proof.certificate is not None and proof.certificate["claim"]["limit"] is not None
    return proof.certificate


#: Damaged certificates of each kind (``benchmarks/certify.py --mutations`` takes a thousand).
MUTATIONS = 4

#: What the certificates of a law without copies and limit do not have, by the beginning of its path.
OF_A_LIMITED_LAW: dict[str, tuple[tuple[Any, ...], ...]] = {
    "the limit's region": (
        ("claim", "limit"),
        ("proof", "multipliers", "level"),
        ("proof", "multipliers", "region"),
    ),
    "copies of the gap": (("law", "curves"), ("drivetrain", "backlash")),
    "their multipliers": (("proof", "multipliers", "flow_0_1"), ("proof", "multipliers", "jump")),
}


@pytest.mark.parametrize("what", OF_A_LIMITED_LAW)
def test_its_verdict_on_copies_and_limit_is_that_of_an_independent_check(
    limited: dict[str, Any], what: str
) -> None:
    rng = random.Random(3)
    paths = [p for p in leaves(limited) if any(p[: len(b)] == b for b in OF_A_LIMITED_LAW[what])]
    for _ in range(MUTATIONS):
        data = mutated(limited, rng, paths)
        assert said(lambda d: verdict(d) is None, data) == said(independent, data), json.dumps(data)


def narrower_copy(data: dict[str, Any]) -> None:
    """One of the law's gaps is no copy of the plant's any more."""
    gap = next(c for c in data["law"]["curves"] if c["points"][-1][0] == 0.5 * TABLE_I["backlash"])
    gap["points"] = [[0.9 * z, w] for z, w in gap["points"]]


@pytest.mark.parametrize(
    "damage",
    [
        lambda data: data["claim"]["limit"].update(step=50.0 * data["claim"]["limit"]["step"]),
        lambda data: data["claim"]["limit"].update(share=0.01),
        lambda data: data["claim"]["limit"].update(share=2.0),
        lambda data: data["claim"].update(limit=None),
        lambda data: data["proof"]["multipliers"].update(level=[0.0]),
        lambda data: data["proof"]["multipliers"].update(
            level=[100.0 * data["proof"]["multipliers"]["level"][0]]
        ),
        lambda data: data["drivetrain"].update(torque_limit=20.0),
        narrower_copy,
    ],
    ids=[
        "larger step",
        "smaller share",
        "share above 1",
        "no region",
        "no level",
        "higher level",
        "lower limit",
        "copy",
    ],
)
def test_a_larger_claim_than_the_region_or_the_copies_prove_is_refused(
    limited: dict[str, Any], damage: Any
) -> None:
    data = copy.deepcopy(limited)
    damage(data)
    assert not said(lambda d: verdict(d) is None, data) and not said(independent, data)


def test_the_independent_check_takes_the_whole_certificate(limited: dict[str, Any]) -> None:
    assert verdict(limited) is None and independent(limited)
