"""Simulations beside a proof: shares with a bound, the worst start, and what no proof covers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import RunningProof, count_variants, prove_running, worst_case
from lostmotion.certificates.robustness.simulated_variants import settling_time, upper_bound
from lostmotion.errors import InvalidInput
from lostmotion.systems import InputCheck

PLANT = lm.Drivetrain.two_mass(**TABLE_I)
#: A claim that nobody has proved.
CLAIM = RunningProof(0.5, 10.0, 0.5, (0.0, 0.0), None, 0, True, None, "")


def observer_1(limit: float = math.inf, plant: lm.Drivetrain = PLANT) -> lm.DiscreteSystem:
    parts = [
        lm.observers.kalman(plant, dt=1e-4),
        lm.controllers.pole_placement(plant, dt=1e-4, torque_limit=limit),
    ]
    return lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))


def test_the_bound_of_a_share_is_that_of_clopper_and_pearson() -> None:
    assert upper_bound(0, 59) == pytest.approx(1.0 - 0.05 ** (1.0 / 59.0))  # the rule of three
    # One of 20: the share with which at most one is seen in 5 % of the cases.
    p = upper_bound(1, 20)
    assert (1.0 - p) ** 20 + 20.0 * p * (1.0 - p) ** 19 == pytest.approx(0.05)
    assert upper_bound(20, 20) == 1.0


def test_settling_time() -> None:
    time = np.arange(1000) * 1e-3
    assert settling_time(time, 2.0 * (1.0 - np.exp(-time / 0.05)), 2.0) == pytest.approx(
        0.05 * math.log(50.0), abs=2e-3
    )
    assert math.isinf(settling_time(time, 2.0 + 0.1 * np.sin(200.0 * time), 2.0))
    assert math.isinf(settling_time(time, np.full(1000, np.nan), 2.0))


def test_variants_of_a_good_loop_settle_and_those_of_an_unstable_one_do_not() -> None:
    good = count_variants(PLANT, lm.controllers.pi(dt=1e-4), reference=2.0, count=60, duration=1.0)
    assert (good.unsettled, good.slow) == (0, 0) and good.own_settling < 0.2
    assert 0.02 < good.most_unsettled < 0.05
    bad = count_variants(PLANT, lm.controllers.pi(dt=1e-4, kp=400.0), reference=2.0, count=10, duration=1.0)
    assert bad.unsettled == 10 and bad.most_unsettled == 1.0 and math.isinf(bad.own_settling)
    with pytest.raises(InvalidInput, match="count_variants"):
        count_variants(PLANT, lm.controllers.pi(dt=1e-4), reference=0.0)


def test_the_worst_start_of_a_proved_loop_settles_and_the_proof_is_careful() -> None:
    law = observer_1()
    found = worst_case(PLANT, law, prove_running(PLANT, law, speeds=(0.2,)), rounds=2)
    assert found is not None and 0.05 < found.settling < 1.0 and found.check_fired == 0
    assert found.proved == 0.2 and found.still_settles < 0.1 and found.careful > 2.0


def test_steps_beyond_the_certified_set_are_tried() -> None:
    law = observer_1(limit=73.5)
    found = worst_case(PLANT, law, prove_running(PLANT, law, speeds=(0.5,)), rounds=1)
    assert found is not None and found.of_steps and found.still_settles > found.proved and found.fails is None


def test_a_claim_that_is_wrong_is_found_out() -> None:
    """Nothing of it is proved: the loop swings."""
    found = worst_case(PLANT, lm.controllers.pi(dt=1e-4, kp=400.0), CLAIM)
    assert found is not None and math.isinf(found.settling) and "does not settle" in str(found)
    assert worst_case(PLANT, observer_1(), replace(CLAIM, speed=None)) is None


def test_an_input_check_that_fires_is_told() -> None:
    """No proof covers a law while it rejects a sample: the search runs it with its checks, and says so."""
    law = lm.controllers.pi(dt=1e-4)
    proof = prove_running(PLANT, law, speeds=(0.5,))
    checked = replace(
        law, checks=(InputCheck("speed_motor", limit=1e-3, hold=3, forget=0.0),), P=np.zeros((1, len(law.states))),
        Q=np.zeros((1, len(law.inputs))), R=np.zeros((1, len(law.curves))),
    )  # fmt: skip
    quiet, fired = (worst_case(PLANT, each, proof, rounds=1) for each in (law, checked))
    assert quiet is not None and quiet.check_fired == 0 and "input check" not in str(quiet)
    assert fired is not None and fired.check_fired > 0 and "An input check fired in" in str(fired)
