"""A loop that is not proved without load torque is tried with one; and what the statement says of it."""

from __future__ import annotations

import math

import lostmotion as lm
from lostmotion.certificates import facts, headline, prove_running, prove_with_load, stability, verdict
from lostmotion.stages.target_law import target_law

#: What a run chooses on the virtual rig, 1/s.
POLES = (-230.0 + 588.0j, -230.0 - 588.0j, -124.0)


def test_the_integral_action_of_a_run_is_proved_with_a_load_torque() -> None:
    plant = lm.Drivetrain.two_mass(
        inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, backlash=0.012, coulomb=2.0,
        viscous=0.0175,
    )  # fmt: skip
    law = target_law(plant, POLES, math.inf, 1e-4, False)
    none = prove_running(plant, law, speeds=(2.0, 80.0))
    assert none.speed is None and headline(none).startswith("Stability is not proved")
    assert stability(none)["proved"] is False and facts(none)[0] == ("Proved", "nothing")
    proof = prove_with_load(plant, law, speeds=(2.0, 80.0))
    low, high = proof.torque_load
    assert proof.speed is not None and low < high < 0.0
    assert verdict(proof.certificate or {}) is None
    assert "of load torque against the motion" in headline(proof)
    assert headline(proof).endswith("Not proved: the loop without load torque.")
    said = dict(facts(proof))
    assert said["Not proved"].startswith("without that load torque, below ")
    assert said["With a load torque of"].endswith("Nm against the motion, constant")
    assert said["After"] == "every state" and "± 0 %" in said["For a drivetrain within"]
