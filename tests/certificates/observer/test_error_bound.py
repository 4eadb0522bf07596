"""The bound of an observer's error: small, true along adversarial motions, and checked by a verifier that is right."""

from __future__ import annotations

import json
import random
import subprocess
import sys
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from damaged_certificates import leaves, mutated, said
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import ObserverError, observer_error, observer_headline, observer_verdict
from lostmotion.certificates.observer.error_bound import STATES, error_model
from lostmotion.certificates.plant import Plant, plant_of
from lostmotion.certificates.rational import Matrix, rational
from lostmotion.errors import InvalidInput
from lostmotion.io.storage.certificate_files import save_observer_certificate

BOTH = ("torque_shaft", "speed_motor")


@pytest.fixture(scope="module")
def proved() -> ObserverError:
    return observer_error(PAPER, faces=100)


def test_motor_speed_alone_is_good_for_20_mrad(proved: ObserverError) -> None:
    assert proved.bounds is not None and proved.certificate is not None
    assert proved.bounds["twist"] <= 0.020
    assert observer_verdict(proved.certificate) is None


def test_a_smaller_bound_or_a_faster_decay_is_another_claim(proved: ObserverError) -> None:
    data = proved.certificate or {}
    for name in STATES:
        bounds = {**data["claim"]["bounds"], name: 0.999 * data["claim"]["bounds"][name]}
        said = observer_verdict({**data, "claim": {**data["claim"], "bounds": bounds}})
        assert said == f"{name} is not within its bound"
    claim = {**data["claim"], "decay": 2.0 * data["claim"]["decay"]}
    assert "leaves through face" in (observer_verdict({**data, "claim": claim}) or "")


def test_no_motion_leaves_it(proved: ObserverError) -> None:
    """The differences are switched at random and against the error, within what gap and friction allow."""
    assert proved.certificate is not None and proved.decay is not None
    faces, model = np.array(proved.certificate["proof"]["faces"]), error_model(PAPER)
    rng, dt = np.random.default_rng(1), 2e-6
    errors = rng.normal(size=(40, 3)) * (0.02, 7.0, 2.0)
    adverse = faces[rng.integers(len(faces), size=20)]  # the direction in which half of the motions push
    measure = np.abs(errors @ faces.T).max(axis=1)
    largest = 0.0
    for k in range(20_000):
        if k % 25 == 0:
            share = rng.uniform(size=(2, 40)).round()
        rates = errors @ model.A.T
        for place, difference in enumerate(model.differences):
            low, high = difference.bounds(errors)
            push = np.append(adverse @ difference.effect > 0.0, share[place, 20:])
            rates += np.outer(np.where(push, high, low), difference.effect)
        errors = errors + dt * rates
        later = np.abs(errors @ faces.T).max(axis=1)
        # Euler's step of the simulation overshoots by some 1e-4.
        allowed = np.maximum(1.0, measure * np.exp(-proved.decay * dt)) + 1e-4
        assert np.all(later <= allowed)
        measure, largest = later, max(largest, float(np.max(np.abs(errors[:, 0]))) if k > 10_000 else 0.0)
    assert largest > 0.3 * (proved.bounds or {})["twist"], "the motions were adverse"


def test_the_exported_observer_stays_within_it(proved: ObserverError) -> None:
    n = 10_000
    torque = 8.0 * np.sign(np.sin(2.0 * np.pi * 4.0 * 1e-4 * np.arange(n)))
    run = lm.simulate(PAPER, dt=1e-4, torque_motor=torque, state=(0.015, -3.0, 1.0))
    estimated = lm.observers.kalman(PAPER, dt=1e-4).run(run)
    for name, bound in (proved.bounds or {}).items():
        assert np.max(np.abs(estimated[f"{name}_estimated"] - run[name])) < bound


def test_at_every_contact_the_exported_observer_is_within_it(proved: ObserverError) -> None:
    """The bound at re-contact: at the first sample of each contact after the gap was crossed, and it is said so."""
    n, dt = 20_000, 1e-4
    torque = 6.0 * np.sign(np.sin(2.0 * np.pi * 5.0 * dt * np.arange(n)))
    run = lm.simulate(PAPER, dt=dt, torque_motor=torque, state=(0.015, -3.0, 1.0))
    estimated = lm.observers.kalman(PAPER, dt=dt).run(run)
    touched = np.abs(run["twist"]) > 0.5 * PAPER.backlash
    contacts = 1 + np.flatnonzero(touched[1:] & ~touched[:-1])
    assert contacts.size > 10
    for name, bound in (proved.bounds or {}).items():
        error = np.abs(estimated[f"{name}_estimated"] - run[name])[contacts]
        assert 0.0 < np.max(error) < bound
    assert "at the moment of contact too" in observer_headline(proved)


def test_injection_and_a_torque_sensor_prove_more(proved: ObserverError) -> None:
    injected = observer_error(PAPER, injection={"speed_motor": 1.43e-3}, faces=70)
    both = observer_error(PAPER.with_contact("dead_zone"), BOTH, injection={"torque_shaft": 1e-4}, faces=50)
    twist = [(found.bounds or {})["twist"] for found in (proved, injected, both)]
    assert twist[1] < twist[0] and twist[2] < 0.9 * twist[0]


def test_an_unstable_observer_gets_no_certificate() -> None:
    found = observer_error(PAPER, gain=[[0.0], [-50.0], [0.0]], faces=20)
    assert found.certificate is None and "no invariant polytope" in found.reason


def test_it_runs_without_any_package(tmp_path: Path, proved: ObserverError) -> None:
    save_observer_certificate(proved, tmp_path / "c.json", tmp_path / "c_verify.py")
    empty = ObserverError(None, None, None)
    save_observer_certificate(empty, tmp_path / "empty.json", tmp_path / "empty_verify.py")

    def verified(*files: str) -> tuple[int, str]:
        # -I and -S: nothing but the standard library can be imported.
        command = [sys.executable, "-I", "-S", "c_verify.py", *files]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        return done.returncode, done.stdout

    code, said = verified("c.json")
    assert code == 0 and said.startswith("PROVED: during every motion")
    assert verified("empty.json")[0] == 1 and verified()[0] == 2


def independent(data: dict[str, Any]) -> bool:
    """Equations 20 to 22 in fractions by matrices, from the package's own form of the drivetrain."""
    claim, own, d = data["claim"], data["proof"], data["drivetrain"]
    plant = plant_of(
        lm.Drivetrain(
            inertias=(d["inertia_motor"], d["inertia_load"]),
            shafts=(lm.Shaft(d["stiffness"], d["damping"], d["backlash"], d["contact"]),),
            frictions=(
                lm.Friction((d["coulomb_motor_plus"], d["coulomb_motor_minus"]), d["viscous_motor"]),
                lm.Friction((d["coulomb_plus"], d["coulomb_minus"]), d["viscous"]),
            ),
        )
    )
    if d["lag"] or not claim["decay"] > 0.0 or data["injection"] or len(data["gain"]) != 3:
        return False
    # Heights of the curves are 1 there: their differences in units of the limit.
    seen = np.array([plant.measured[name] for name in data["measured"]])
    rates = np.hstack([plant.A, plant.E]) - rational(data["gain"]) @ seen
    rows, curves = rational(own["faces"]), len(plant.curves)
    bounds = rational([claim["bounds"][name] for name in STATES])
    axes = [np.flatnonzero(row) for row in rows[:3]]
    if any(list(found) != [i] or rows[i, i] * bounds[i] < 1 for i, found in enumerate(axes)):
        return False
    faces = np.hstack([rows, rational(np.zeros((len(rows), curves)))])
    sizes = np.append(bounds, rational([1] * curves))
    limits = {
        "gap": Fraction(d["backlash"]),
        "friction of the motor": Fraction(d["coulomb_motor_plus"]) + Fraction(d["coulomb_motor_minus"]),
        "friction of the load": Fraction(d["coulomb_plus"]) + Fraction(d["coulomb_minus"]),
    }
    choices = [known(plant, limits, signs, faces) for signs in product((1, -1), repeat=curves)]
    if len(own["multipliers"]) != len(rows):
        return False
    for face, of_face in zip(faces, own["multipliers"], strict=True):
        for conditions, given in zip(choices, of_face, strict=True):
            on_face = Fraction(given["face"])
            form, constant = on_face * face - face[:3] @ rates, -Fraction(claim["decay"]) - on_face
            for place, value in given["known"]:
                if not 0 <= place < len(conditions) or value < 0 or place != int(place):
                    return False
                form = form - Fraction(value) * conditions[int(place)][1:]
                constant -= Fraction(value) * conditions[int(place)][0]
            if constant < sum(abs(form) * sizes):
                return False
    return True


def known(plant: Plant, limits: dict[str, Fraction], signs: tuple[int, ...], faces: Matrix) -> Matrix:
    """Rows (b, a) of all b + a·(e, w) ≥ 0; each w in units of its limit."""
    n, one, found = 3 + len(signs), rational(np.eye(4 + len(signs))), []
    for i, sign in enumerate(signs):
        limit = limits[plant.names[i]]
        w, z = sign * limit * one[4 + i], np.append(rational([0]), sign * plant.Z[i])
        z = np.append(z, rational([0] * (n - 3)))
        found += [w, limit * one[0] - w, z]
        if plant.names[i] == "gap":
            found.append(z - w)
    ones = rational(np.ones((len(faces), 1)))
    return np.vstack([*found, np.hstack([ones, -faces]), np.hstack([ones, faces])])


def test_its_verdict_is_that_of_an_independent_check() -> None:
    # Few faces: a large bound, and a short check.
    certificate = observer_error(PAPER, BOTH, faces=25).certificate
    assert certificate is not None and independent(certificate)
    rng, paths = random.Random(2), leaves(certificate)
    # Half of the damage is done outside of the many multipliers.
    few = [path for path in paths if "multipliers" not in path]
    verdicts = []
    for i in range(40):
        data = mutated(certificate, rng, few if i % 2 else paths)
        own = said(lambda d: observer_verdict(d) is None, data)
        assert own == said(independent, data), json.dumps(data)
        verdicts.append(own)
    assert 3 < sum(verdicts) < 37, "damage of both kinds"


@pytest.mark.parametrize(
    "plant, options, wrong",
    [
        (PAPER.with_parameters(lag=1e-3), {}, "no torque lag"),
        (PAPER.with_contact("limited"), {}, "certify: drivetrain"),
        (PAPER, {"measured": ("angle_motor",)}, "Leave it out"),
        (PAPER, {"gain": [[1.0], [2.0]]}, "numbers"),
        (PAPER, {"injection": {"twist": 1.0}}, "Check the names"),
    ],
)
def test_misuse(plant: lm.Drivetrain, options: dict[str, Any], wrong: str) -> None:
    with pytest.raises(InvalidInput, match=wrong):
        observer_error(plant, **options)
