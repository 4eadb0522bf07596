"""The momentum disturbance observer: exact where its model holds, blind where there is a gap."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.errors import InvalidInput
from lostmotion.observers import disturbance_observer
from lostmotion.simulation import simulate

RIGID = PAPER.with_parameters(backlash=0.0, viscous_motor=0.01)
DT = 1e-4


def rms(error):
    return float(np.sqrt(np.mean(np.square(error))))


@pytest.mark.parametrize("lag", [0.0, 5e-4])
@pytest.mark.parametrize("averaged", [False, True])
def test_slow_torque_and_load_speed(lag, averaged):
    plant = RIGID.with_parameters(lag=lag)
    time = DT * np.arange(20_000)
    recording = simulate(plant, dt=DT, torque_motor=20.0 + 10.0 * np.sin(2.0 * np.pi * 5.0 * time))
    speed = recording["speed_motor"]
    if averaged:
        speed = np.diff(recording["angle_motor"], prepend=0.0) / DT
    observer = disturbance_observer(plant, dt=DT, speed_from_counts=averaged)
    found = observer.run({"torque_motor": recording["torque_motor"], "speed_motor": speed})
    late = slice(10_000, None)
    for signal, limit in (("torque_shaft", 2e-3), ("speed_load", 2e-4)):
        error = rms(found[f"{signal}_estimated"][late] - recording[signal][late])
        assert error < limit * np.ptp(recording[signal][late])
    assert rms(found["twist_elastic_estimated"][late] - recording["twist"][late]) < 2e-3 * np.ptp(
        recording["twist"]
    )
    # Without the lag in the model the torque would be wrong.
    if lag:
        ignorant = disturbance_observer(RIGID, dt=DT, speed_from_counts=averaged)
        other = ignorant.run({"torque_motor": recording["torque_motor"], "speed_motor": speed})
        assert rms(other["torque_shaft_estimated"][late] - recording["torque_shaft"][late]) > 3.0 * rms(
            found["torque_shaft_estimated"][late] - recording["torque_shaft"][late]
        )


@pytest.mark.parametrize("averaged", [False, True])
def test_poles_are_where_they_were_asked_for(averaged):
    poles = disturbance_observer(RIGID, dt=DT, bandwidth=800.0, speed_from_counts=averaged).poles()
    # A pole of multiplicity n is known to the n-th root of rounding.
    np.testing.assert_allclose(poles, np.exp(-0.08), atol=2e-3)
    np.testing.assert_allclose(np.prod(poles).real, np.exp(-0.08 * poles.size), rtol=1e-6)


def test_in_the_gap_it_takes_the_motor_for_the_load():
    plant = RIGID.with_parameters(backlash=0.2)
    recording = simulate(plant, dt=DT, torque_motor=np.full(300, 1.0))
    assert not recording["torque_shaft"].any()
    found = disturbance_observer(plant, dt=DT).run(recording)
    assert found["speed_load_estimated"][-1] == pytest.approx(recording["speed_motor"][-1], rel=0.02)
    assert recording["speed_load"][-1] == 0.0


@pytest.mark.parametrize(
    "arguments", [{"bandwidth": 0.0}, {"bandwidth": float("inf")}, {"bandwidth": 1e9}, {"dt": -1.0}]
)
def test_misuse(arguments):
    with pytest.raises(InvalidInput):
        disturbance_observer(RIGID, **{"dt": DT, **arguments})
