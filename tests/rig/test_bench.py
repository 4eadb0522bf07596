"""rig.bench: the same drive in other units, the sizes of the virtual rig, what is left out."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion import rig
from lostmotion.rig.zoo.bench import LONGEST_DELAY
from lostmotion.rig.zoo.draws import Draw
from lostmotion.rig.zoo.plants import plant
from lostmotion.simulation import simulate

FOUND = {seed: found for seed in range(60) if (found := rig.bench(seed)) is not None}


def test_total_inertia_first_mode_and_torque_limit_are_the_rigs():
    own = rig.nominal_rig().drivetrain
    assert len(FOUND) > 5
    for found in FOUND.values():
        chain = found.rig.drivetrain
        assert chain.inertia_total == pytest.approx(own.inertia_total)
        assert rig.eigenfrequencies(chain)[1] == pytest.approx(rig.eigenfrequencies(own)[1])
        assert chain.actuator.torque_limit == pytest.approx(rig.TORQUE_LIMIT)
        assert found.model.pole_frequency == pytest.approx(rig.eigenfrequencies(own)[1])
        assert found.model.backlash == max(shaft.backlash for shaft in chain.shafts)


@pytest.mark.parametrize("seed", list(FOUND)[:4])
def test_it_is_the_same_drive_in_other_units(seed):
    made, found = plant(Draw(seed)), FOUND[seed]
    # As many samples of its own, for the drive and for its image: the speeds differ by one factor.
    dt = 1.0 / (made.pole * 200.0)
    image_dt = dt * made.pole / rig.eigenfrequencies(rig.nominal_rig().drivetrain)[1]
    shape = np.sin(2.0 * np.pi * np.arange(1500) / 150.0)
    own = simulate(made.drivetrain, dt=dt, torque_motor=0.8 * made.rating.torque * shape)
    image = simulate(found.rig.drivetrain, dt=image_dt, torque_motor=0.8 * rig.TORQUE_LIMIT * shape)
    for name in ("speed_motor", "speed_load"):
        largest = np.max(np.abs(own[name]))
        factor = np.max(np.abs(image[name])) / largest
        np.testing.assert_allclose(image[name] / factor, own[name], atol=1e-6 * largest)
    assert [e.kind for e in own.events] == [e.kind for e in image.events]


def test_left_out_are_drives_without_one_gap_and_with_long_delays():
    for seed in range(60):
        gaps = sum(shaft.has_backlash for shaft in plant(Draw(seed)).drivetrain.shafts)
        assert seed not in FOUND or gaps == 1
    for found in FOUND.values():
        late = found.rig.drivetrain.lag + (found.delay + 0.5) * found.dt
        assert late * found.model.pole_frequency <= LONGEST_DELAY
        assert found.rig.sensors["speed_motor"].difference
