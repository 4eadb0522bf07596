"""A contact that is only predicted: Kalman filters that track parameters cancel it once the speed contradicts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from table_i import TABLE_I

from lostmotion.drivetrain import Drivetrain
from lostmotion.kernels.estimators.contact import cancel_contact
from lostmotion.kernels.estimators.layout import PARAMETERS, SPEED_LOAD, TRACKING, TWIST
from lostmotion.observers import extended_kalman, unscented_kalman
from lostmotion.signals import excitation
from lostmotion.simulation import Sensor, measure, simulate

DT = 1e-4
LEVELS = (4.0, 10.0, -4.0, -10.0, 6.0, -6.0)


def stiff(stiffness, **contact):
    """The paper's rig with a stiffer shaft."""
    damping = TABLE_I["damping"] * math.sqrt(stiffness / TABLE_I["stiffness"])
    return Drivetrain.two_mass(**{**TABLE_I, "stiffness": stiffness, "damping": damping}, **contact)


@pytest.mark.parametrize(("make", "largest"), [(extended_kalman, 0.015), (unscented_kalman, 0.02)])
@pytest.mark.parametrize("stiffness", [5e4, 1e5])
@pytest.mark.parametrize("seed", [2, 3])
def test_a_gap_that_is_wide_against_the_winding_is_not_lost(make, largest, stiffness, seed):
    """9.7 Nm wind the shaft by 1/62 and 1/124 of its gap: the error was 4 to 19 % of the range."""
    torque = excitation(
        1.5, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175, levels=LEVELS, ramp=0.1, noise_rms=7.0,
        limit=1e9,
    )  # fmt: skip
    exact = simulate(stiff(stiffness, contact="dead_zone"), dt=DT, torque_motor=torque)
    sensors = {"speed_motor": Sensor("angle_motor", 2.0 * math.pi / 2**20, difference=True)}
    shown = {"torque_motor": torque, **measure(sensors, exact.signals, DT, seed)}
    found = make(stiff(stiffness), dt=DT, speed_from_counts=True).run(shown)
    load = exact["speed_load"][3000:]
    wrong = found["speed_load_estimated"][3000:] - load
    assert np.sqrt(np.mean(wrong**2)) < largest * np.ptp(load)
    assert found["backlash_estimated"][-1] == pytest.approx(0.012, rel=0.1)


def predicted(torque, deviation):
    """Parameters and memory of a filter that predicts a contact; its ``deviation`` before that, rad."""
    observer = extended_kalman(stiff(5e4), dt=DT)
    p = observer.parameters.view(PARAMETERS)[0]
    s = observer.functions.init(np.array(observer.parameters)).view(TRACKING)[0]
    x, contact = s["estimate"]["x"], s["contact"]
    x[TWIST], x[SPEED_LOAD], contact["torque"] = 6.4e-3, 3.0, torque
    contact["variance"], contact["speed_variance"] = deviation**2, 0.1**2
    return p, s


def judged(p, s, innovation, samples=6, deviation=0.05):
    estimate = s["estimate"]
    for _ in range(samples):
        cancel_contact(p, estimate["x"], estimate["P"], s["contact"], innovation, deviation**2)


def test_a_predicted_contact_is_cancelled_once_the_log_odds_exceed_2():
    p, s = predicted(20.0, 1e-3)
    x, P = s["estimate"]["x"], s["estimate"]["P"]
    variances = P[TWIST, TWIST], P[SPEED_LOAD, SPEED_LOAD]
    effect = (
        20.0 * p["dt"] / p["inertia_motor"]
    )  # rad/s in a sample, 2.2 deviations: as if there were no torque
    judged(p, s, effect, 1)
    assert x[TWIST] == 6.4e-3  # not after one sample
    judged(p, s, effect, 1)
    assert x[TWIST] == pytest.approx(5e-3)
    assert x[SPEED_LOAD] == pytest.approx(3.0 - 2.0 * 20.0 * p["dt"] / p["inertia_load"])
    assert P[TWIST, TWIST] == pytest.approx(variances[0] + 1e-6)
    assert P[SPEED_LOAD, SPEED_LOAD] == pytest.approx(variances[1] + 0.01)
    assert s["contact"]["log_odds"] == s["contact"]["impulse"] == 0.0


def test_on_the_other_side_it_is_cancelled_to_there():
    p, s = predicted(-20.0, 1e-3)
    judged(p, s, -20.0 * p["dt"] / p["inertia_motor"], 2)
    assert s["estimate"]["x"][TWIST] == pytest.approx(-5e-3)
    assert s["estimate"]["x"][SPEED_LOAD] == pytest.approx(3.0 + 2.0 * 20.0 * p["dt"] / p["inertia_load"])


@pytest.mark.parametrize(
    ("torque", "deviation", "innovation"),
    [(20.0, 1e-3, 0.0), (20.0, 1e-3, -0.1), (20.0, 8e-5, 0.11), (0.0, 1e-3, 0.11)],
    ids=["as predicted", "more torque still", "no room for a doubt", "in the gap"],
)
def test_otherwise_a_predicted_contact_stays(torque, deviation, innovation):
    p, s = predicted(torque, deviation)
    before = s.tobytes()
    judged(p, s, innovation)
    assert s.tobytes() == before
