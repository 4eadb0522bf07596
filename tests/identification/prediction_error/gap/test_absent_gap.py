"""A drivetrain without a gap: exact values whatever the nameplate says, and a bound that holds."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.recording import Recording

DT = 5e-4
LINEAR = lm.Drivetrain.two_mass(
    inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, damping=0.397, coulomb=2.0, viscous=0.0175,
    lag=3e-4,
)  # fmt: skip
COUNT = 2.0 * np.pi / 2**20


def recorded(gap: float, seed: int = 4) -> Recording:
    """Four seconds of levels and noise, the speed from counts of 20 bit."""
    torque = lm.signals.excitation(4.0, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(LINEAR.with_parameters(backlash=gap), torque_motor=torque, dt=DT)
    counts = np.floor(run["angle_motor"] / COUNT)
    speed = np.diff(counts, prepend=counts[0]) * COUNT / DT
    return run.only("torque_motor").with_signals("measured", speed_motor=speed)


@pytest.mark.parametrize("nameplate", [0.0, 0.012])
def test_a_gap_on_the_nameplate_that_is_not_there_costs_nothing(nameplate: float):
    """It was put back: the stiffness was 31 % off with ±50 %."""
    found = lm.identify(recorded(0.0), start=LINEAR.with_parameters(backlash=nameplate))
    for name in ("inertia_motor", "inertia_load", "stiffness"):
        low, high = found.intervals[name]
        value = getattr(LINEAR, name)
        # With room for inertias that the model lacks: the recording says that there are none.
        assert low <= value <= high and high - low < 0.002 * value, name
    assert found.values["backlash"] is None and found.drivetrain.backlash == 0.0
    low, high = found.intervals["backlash"]
    assert low == 0.0 and 0.0 < high < COUNT
    assert [p.got for p in found.problems if p.where == "backlash"] == [
        f"no backlash above {high:.2g} rad (95 %)"
    ]
    assert found.structure.parts == ("two masses", "no gap", "friction at the load")
    assert "no gap" in found.summary()


def test_the_bound_is_not_below_a_small_gap():
    bound = lm.identify(recorded(0.0), start=LINEAR, second_estimator=False).intervals["backlash"][1]
    for part in (0.5, 2.0, 20.0):
        found = lm.identify(recorded(part * bound), start=LINEAR, second_estimator=False)
        low, high = found.intervals["backlash"]
        assert low <= part * bound <= high, part
