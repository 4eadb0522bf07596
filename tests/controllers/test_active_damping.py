"""Active damping: the damping ratio that was asked for, steady torques go through, a tip-in behind it lands softly."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.controllers import active_damping
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.simulation import Sensor, simulate

PLANT = Drivetrain.two_mass(inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42)
SEEN = {f"{name}_estimated": Sensor(name) for name in ("speed_motor", "speed_load")}


@pytest.mark.parametrize("ratio", [0.1, 0.5, 0.9])
def test_the_eigenmode_has_the_damping_that_was_asked_for(ratio):
    law = active_damping(PLANT, dt=1e-5, damping_ratio=ratio)
    a, b = PLANT.linear()
    poles = np.linalg.eigvals(a + b @ np.hstack([np.zeros((1, 1)), law.D[:, 1:]]))
    mode = poles[np.argmax(np.abs(poles.imag))]
    # A damper at the motor alone moves the frequency too, the less the smaller it is.
    assert -mode.real / abs(mode) == pytest.approx(ratio, rel=0.12)


def test_an_accelerating_drive_gives_the_torque_that_it_is_asked_for():
    law = active_damping(PLANT, dt=1e-4)
    run = simulate(PLANT, dt=1e-4, law=law, delay=1, sensors=SEEN, torque_reference=np.full(3000, 20.0))
    assert run["torque_motor"][-1] == pytest.approx(20.0, rel=1e-6)
    assert run["torque_motor"][:200].min() < 15.0


def test_it_damps_and_keeps_the_limit():
    def swing(**options):
        law = active_damping(PLANT, dt=1e-4, **options)
        run = simulate(PLANT, dt=1e-4, law=law, delay=1, sensors=SEEN, torque_reference=np.full(3000, 20.0))
        assert np.max(np.abs(run["torque_motor"])) <= options.get("torque_limit", np.inf)
        return np.ptp((run["speed_motor"] - run["speed_load"])[1000:])

    assert swing() < 1e-3 * swing(damping_ratio=0.021)
    swing(torque_limit=12.0)


@pytest.mark.parametrize(
    "changes", [{"damping_ratio": 0.01}, {"damping_ratio": np.nan}, {"torque_limit": 0.0}, {"dt": -1.0}]
)
def test_misuse(changes):
    with pytest.raises(InvalidInput, match=f"active_damping.{next(iter(changes))}"):
        active_damping(PLANT, **{"dt": 1e-4, **changes})
