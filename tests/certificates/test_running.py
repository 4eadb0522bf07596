"""From which load speed on the sampled loop is proved stable, and that nothing else is."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import prove_running, verdict
from lostmotion.certificates.equilibrium import equilibrium
from lostmotion.certificates.lure import lure_loop
from lostmotion.errors import InvalidInput


def drivetrain(**changes: Any) -> lm.Drivetrain:
    return lm.Drivetrain.two_mass(**{**TABLE_I, **changes})


def observer_1(
    plant: lm.Drivetrain, compensation: Any = "estimated", limit: float = math.inf
) -> lm.DiscreteSystem:
    parts = [
        lm.observers.kalman(plant, dt=1e-4),
        lm.controllers.pole_placement(plant, dt=1e-4, friction_compensation=compensation, torque_limit=limit),
    ]
    return lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))


def observer_2(plant: lm.Drivetrain, **options: Any) -> lm.DiscreteSystem:
    both = ("torque_shaft", "speed_motor")
    parts = [
        lm.observers.kalman(plant, measured=both, dt=1e-4, **options),
        lm.controllers.pole_placement(plant, dt=1e-4),
    ]
    return lm.connect(parts, ("speed_reference", *both), ("torque_motor",))


def test_pi_is_proved_almost_down_to_rest() -> None:
    proof = prove_running(drivetrain(), lm.controllers.pi(dt=1e-4))
    assert proof.speed is not None and proof.speed <= 0.02
    assert proof.both_directions and verdict(proof.certificate or {}) is None


def test_pi_with_the_torque_limit_is_proved_globally() -> None:
    proof = prove_running(drivetrain(torque_limit=73.5), lm.controllers.pi(dt=1e-4, torque_limit=73.5))
    assert proof.speed is not None and proof.speed <= 0.02


def test_observer_1_with_pole_placement_and_compensation() -> None:
    plant = drivetrain()
    proof = prove_running(plant, observer_1(plant))
    assert proof.speed is not None and proof.speed <= 0.2
    assert proof.reference == pytest.approx(proof.speed, rel=1e-9), "compensated: it rests at its set-point"


def test_a_limit_that_acts_leaves_a_proof_for_steps() -> None:
    plant = drivetrain()
    law = observer_1(plant, limit=73.5)
    nearest = prove_running(plant, law)
    assert nearest.speed == 0.2 and nearest.step == 0.5, "the smaller region reaches down further"
    proof = prove_running(plant, law, step=2.0)
    assert proof.speed is not None and proof.step is not None
    assert proof.speed <= 0.5 and proof.step >= 2.0
    assert verdict(proof.certificate or {}) is None
    # The simulated step settles, and a larger step or a smaller share is another claim, which the numbers do not prove.
    reference = np.where(np.arange(20_000) < 10_000, 2.0, 2.0 + proof.step)
    loop = lm.simulate(plant, law=law.without_checks(), dt=1e-4, speed_reference=reference)
    assert loop["speed_load"][-1] == pytest.approx(2.0 + proof.step, rel=1e-6)
    for change in ({"step": 1000.0}, {"share": 0.01}):
        claim = {**(proof.certificate or {})["claim"]}
        claim["limit"] = {**claim["limit"], **change}
        assert verdict({**(proof.certificate or {}), "claim": claim}) is not None


@pytest.mark.parametrize("limit", [math.inf, 73.5])
def test_with_torque_lag_and_a_sample_of_delay(limit: float) -> None:
    """With the limit the best margin of the unscaled inequalities is 1e-9: below the solver's tolerance."""
    plant = drivetrain(lag=3e-4)
    proof = prove_running(plant, observer_1(plant, limit=limit), delay=1, speeds=(0.4, 80.0), step=0.5)
    assert proof.speed == 0.4


def test_observer_2_needs_the_memory_of_the_gap() -> None:
    plant = drivetrain()
    law = observer_2(plant)
    proof = prove_running(plant, law, speeds=(3.15, 80.0))
    assert proof.speed == 3.15 and proof.certificate is not None
    numbers = proof.certificate["proof"]
    assert numbers["memory"] == [0] and verdict(proof.certificate) is None
    without = {key: value for key, value in numbers.items() if key != "memory"}
    assert verdict({**proof.certificate, "proof": without}) is not None


def test_an_injection_needs_the_memory_of_its_gap_and_of_friction() -> None:
    """The injected gap reads the motor speed, and friction reads that gap: without memory neither has an integral."""
    plant = drivetrain()
    law = observer_2(plant, measurement_covariance={"torque_shaft": 100.0}, injection={"speed_motor": 2e-4})
    proof = prove_running(plant, law, speeds=(0.1, 80.0))
    assert proof.speed == 0.1 and proof.certificate is not None
    assert proof.certificate["proof"]["memory"] == [0, 2, 4] and verdict(proof.certificate) is None


def test_an_unstable_loop_gets_no_certificate() -> None:
    plant, law = drivetrain(), lm.controllers.pi(dt=1e-4, kp=400.0, ki=200.0)
    proof = prove_running(plant, law)
    assert proof.speed is None and proof.certificate is None
    assert "not stable where it rests" in proof.reason
    loop = lm.simulate(plant, law=law, dt=1e-4, speed_reference=np.full(2_000, 2.0))
    assert np.max(np.abs(loop["speed_motor"][-500:] - 2.0)) > 0.5, "and the simulation shows it"


@pytest.mark.parametrize("compensation", ["estimated", "none", "reference"])
def test_the_equilibrium_is_where_the_simulation_settles(compensation: str) -> None:
    plant = drivetrain()
    law = observer_1(plant, compensation)
    rest = equilibrium(lure_loop(plant, law), Fraction(2))
    assert rest is not None
    loop = lm.simulate(
        plant, law=law.without_checks(), dt=1e-4, speed_reference=np.full(30_000, float(rest.reference))
    )
    assert loop["speed_load"][-1] == pytest.approx(2.0, rel=1e-6)
    assert loop["twist"][-1] == pytest.approx(float(rest.state[0]), rel=1e-6)


@pytest.mark.parametrize(
    "changes",
    [
        {"friction": lm.drivetrain.Friction(2.0, 0.0175, stribeck=((0.0, 1.0), (0.1, 0.0)))},
        {"friction": lm.drivetrain.Friction(2.0, 0.0175, breakaway=3.0)},
        {"contact": "limited"},
        {"actuator": lm.drivetrain.Actuator(rate_limit=1000.0)},
    ],
)
def test_a_drivetrain_without_a_proof_is_refused(changes: dict[str, Any]) -> None:
    plant = drivetrain(**{k: v for k, v in changes.items() if k == "contact"})
    if "friction" in changes:
        plant = replace(plant, frictions=(lm.drivetrain.Friction(), changes["friction"]))
    if "actuator" in changes:
        plant = replace(plant, actuator=changes["actuator"])
    with pytest.raises(InvalidInput, match="certify: drivetrain"):
        prove_running(plant, lm.controllers.pi(dt=1e-4))


def test_a_chain_and_a_held_end_are_refused() -> None:
    shaft = drivetrain().shaft
    chain = lm.Drivetrain(inertias=(0.02, 0.02, 0.1), shafts=(shaft, shaft))
    for plant in (chain, replace(drivetrain(), locked="load")):
        with pytest.raises(InvalidInput, match="certify: drivetrain"):
            prove_running(plant, lm.controllers.pi(dt=1e-4))


def test_load_torque_narrows_what_is_proved() -> None:
    plant, law = drivetrain(), lm.controllers.pi(dt=1e-4)
    # Against the motion the shaft is wound up more; with it, up to the friction, the gap may open.
    proof = prove_running(plant, law, torque_load=(-3.0, 1.0), fastest=100.0)
    assert proof.speed is not None and verdict(proof.certificate or {}) is None
    driven = prove_running(plant, law, torque_load=(0.0, 3.0), fastest=100.0)
    assert driven.speed is not None
    assert driven.speed > (3.0 - 2.0) / 0.0175, (
        "below, the shaft torque at rest passes zero and the gap opens"
    )


def test_a_delay_of_a_million_samples_is_refused_at_once():
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    with pytest.raises(InvalidInput, match="at most 100"):
        prove_running(plant, lm.controllers.pi(dt=1e-4), delay=10**6)
