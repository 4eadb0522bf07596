"""Exact limit cycles: a known one, its period and multipliers against free simulation, and loops without any."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import limit_cycle
from lostmotion.certificates.limit_cycles.sampled_loop import SampledLoop
from lostmotion.certificates.limit_cycles.shooting import LimitCycle

DT, REFERENCE = 1e-4, 0.02
STRIBECK = lm.Friction(2.0, 0.0175, stribeck=((0.0, 1.0), (0.1, 0.0)))
PLANT = replace(lm.Drivetrain.two_mass(**TABLE_I), frictions=(lm.Friction(), STRIBECK))


@pytest.fixture(scope="module")
def orbit() -> LimitCycle:
    found = limit_cycle(PLANT, lm.controllers.pi(dt=DT), reference=REFERENCE)
    assert found is not None
    return found


def test_a_known_orbit_of_stick_and_slip(orbit: LimitCycle) -> None:
    # Period and multipliers of a prototype of another author: 156.69887 ms; 1, 1.4e-4, 0, 0. The orbit's is 6 ppm less.
    assert orbit.period == pytest.approx(156.697916e-3, rel=1e-8)
    assert (orbit.samples, orbit.periods) == (1567, 1) and orbit.residual < 1e-8
    assert np.abs(orbit.multipliers) == pytest.approx([1.0, 1.4e-4, 0.0, 0.0], abs=5e-6)
    assert orbit.is_stable
    assert [event.kind for event in orbit.recording.events] == ["stick", "slip"]


def test_its_period_differs_by_what_the_freed_sample_time_makes_of_the_gain() -> None:
    """Of 1567 samples in the prototype's period each is 7 ppm short of 0.1 ms; the law adds ki·0.1 ms in it. With a ki
    less by as much the integral gain per second is the loop's, and the period that of the prototype."""
    period = 156.698873e-3
    law = lm.controllers.pi(dt=DT, ki=200.0 * (period / 1567) / DT)
    found = limit_cycle(PLANT, law, reference=REFERENCE)
    assert found is not None and found.samples == 1567
    assert found.period == pytest.approx(period, rel=2e-8)


def test_its_period_is_that_of_a_free_simulation(orbit: LimitCycle) -> None:
    loop = lm.simulate(
        PLANT, law=lm.controllers.pi(dt=DT), dt=DT, speed_reference=np.full(200_000, REFERENCE)
    )
    slips = np.array([event.time for event in loop.events if event.kind == "slip"])[20:]
    free = (slips[-1] - slips[0]) / (slips.size - 1)
    assert free == pytest.approx(orbit.period, rel=1e-5) and free == pytest.approx(156.698873e-3, rel=1e-8)
    assert orbit.swing("speed_load") == pytest.approx(np.ptp(loop["speed_load"][100_000:]), rel=1e-3)


def test_a_deviation_dies_out_as_its_multiplier_says(orbit: LimitCycle) -> None:
    law = lm.controllers.pi(dt=DT)
    loop = SampledLoop(PLANT, law, REFERENCE, 0.0)
    start = loop.point(loop.run(20_000))
    first = loop.point(loop.run(orbit.samples, start, orbit.sample_time)).values
    change = 1e-3 * np.array([1.0, -1.0, 1.0, 0.0]) * (0.0, 0.04, 0.04, 0.0)
    other = loop.point(
        loop.run(orbit.samples, replace(start, values=start.values + change), orbit.sample_time)
    )
    later = loop.point(loop.run(orbit.samples, other, orbit.sample_time)).values
    second = loop.point(loop.run(2 * orbit.samples, start, orbit.sample_time)).values
    # What is left is along the orbit: it neither grows nor shrinks.
    np.testing.assert_allclose(later - second, other.values - first, rtol=0.05, atol=1e-9)


def test_the_papers_loops_have_none() -> None:
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    parts = [lm.observers.kalman(plant, dt=DT), lm.controllers.pole_placement(plant, dt=DT)]
    law = lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))
    for each in (law, lm.controllers.pi(dt=DT)):
        assert limit_cycle(plant, each, reference=REFERENCE, settle=3.0, state=(0.01, 3.0, -1.0)) is None


def test_an_orbit_with_few_samples_in_a_period() -> None:
    """Too long a delay, and a torque limit: a period of 96 samples and a part, closed after several of them."""
    plant = lm.Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.0, "coulomb": 0.0})
    law = lm.controllers.pi(dt=DT, torque_limit=20.0)
    found = limit_cycle(plant, law, reference=2.0, delay=30, settle=3.0)
    assert found is not None and found.periods > 1
    loop = lm.simulate(plant, law=law, dt=DT, delay=30, speed_reference=np.full(60_000, 2.0))
    speed = loop["speed_load"][30_000:] - 2.0
    ups = np.flatnonzero((speed[1:] > 0.0) & (speed[:-1] <= 0.0))
    # The simulation's own period is known to a sample in 300 periods.
    assert found.period == pytest.approx(DT * (ups[-1] - ups[0]) / (ups.size - 1), rel=1e-3)
    assert found.swing("speed_load") == pytest.approx(np.ptp(speed), rel=0.02)
