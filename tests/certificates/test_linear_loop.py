"""The linear loop tells beforehand where the sectors allow what cannot be proved."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion.certificates import prove_running
from lostmotion.certificates.equilibrium import equilibrium
from lostmotion.certificates.linear_loop import flow_and_step, is_stable, is_stable_in_sectors
from lostmotion.certificates.lure import lure_loop
from lostmotion.certificates.sampled_proof import SampledProof, sampled_proof
from lostmotion.certificates.sectors import copies, sectors


def proof_of(kp: float, ki: float) -> SampledProof:
    loop = lure_loop(PAPER, lm.controllers.pi(kp=kp, ki=ki, dt=1e-4))
    rests = [
        rest for speed in (1, 80) if (rest := equilibrium(loop, Fraction(speed), Fraction(0))) is not None
    ]
    bounds = sectors(loop, rests)
    assert bounds is not None
    return sampled_proof(loop, rests[0], bounds, copies(loop, rests), 1, None).floats()


def test_in_contact_it_is_the_linear_drivetrain() -> None:
    proof = proof_of(1e-9, 1e-9)
    over_a_sample, _ = flow_and_step(proof, np.asarray(proof.slopes))
    frequency = np.abs(np.linalg.eigvals(over_a_sample[:3, :3] / 1e-4).imag).max()
    inertia = 1.0 / (1.0 / PAPER.inertia_motor + 1.0 / PAPER.inertia_load)
    assert frequency == pytest.approx(np.sqrt(PAPER.stiffness / inertia), rel=0.01)


@pytest.mark.parametrize(("kp", "stable"), [(2.0, True), (500.0, False)])
def test_too_large_a_gain_is_seen_without_the_solver(kp: float, stable: bool) -> None:
    proof = proof_of(kp, 10.0)
    assert is_stable(flow_and_step(proof, np.asarray(proof.slopes))[1]) == stable
    assert is_stable_in_sectors(proof) == stable
    found = prove_running(PAPER, lm.controllers.pi(kp=kp, ki=10.0, dt=1e-4))
    assert (found.speed is not None) == stable
