"""Symmetrical optimum: its phase margin, other sizes of drives, the step across the gap."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lostmotion.controllers import pi, symmetrical_optimum
from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.metrics import step_metrics
from lostmotion.simulation import simulate
from lostmotion.systems import DiscreteSystem, connect, design_model

DT = 1e-4
PLANT = Drivetrain.two_mass(
    inertia_motor=0.0195, inertia_load=0.111, stiffness=6500.0, damping=0.42, backlash=0.012, coulomb=2.0,
    viscous=0.0175, lag=3e-4,
)  # fmt: skip


@pytest.mark.parametrize("spread", [2.0, 3.0])
def test_the_phase_margin_is_kessler_s(spread):
    tuning = symmetrical_optimum(PLANT, dt=DT, delay=1, spread=spread)
    time = math.sqrt(0.111 / 6500.0) + 3e-4 + 1.5e-4
    assert tuning.time_constant == pytest.approx(time)
    s = 1j / (spread * time)
    loop = (tuning.kp + tuning.ki / s) / ((0.0195 + 0.111) * s * (1.0 + time * s))
    assert abs(loop) == pytest.approx(1.0, rel=1e-12)
    assert np.angle(-loop) == pytest.approx(math.asin((spread**2 - 1.0) / (spread**2 + 1.0)), rel=1e-12)
    assert tuning.filter_time == pytest.approx(tuning.kp / tuning.ki)


@pytest.mark.parametrize(
    "motor, load, stiffness, lag, dt, spread, stable",
    [
        (1e-4, 1e-4, 400.0, 1e-4, 1e-4, 2.0, True),
        (5.0, 50.0, 1e5, 1e-3, 1e-3, 2.0, True),
        (1e-4, 2e-3, 10.0, 5e-4, 5e-4, 2.0, True),
        (0.0195, 0.111, 6500.0, 3e-4, 1e-3, 2.0, False),
        (0.0195, 0.111, 6500.0, 3e-4, 1e-3, 4.0, True),
    ],
)
def test_it_says_whether_the_loop_with_the_torsional_mode_is_stable(
    motor, load, stiffness, lag, dt, spread, stable
):
    drive = Drivetrain.two_mass(
        inertia_motor=motor, inertia_load=load, stiffness=stiffness, lag=lag,
        damping=0.04 * math.sqrt(stiffness / (1.0 / motor + 1.0 / load)),
    )  # fmt: skip
    tuning = symmetrical_optimum(drive, dt=dt, spread=spread)
    model = design_model(drive, dt)
    plant = DiscreteSystem(
        inputs=("torque_motor",), outputs=("speed_motor",), states=model.states, dt=dt, A=model.A,
        B=model.B[:, None], C=model.row(speed_motor=1.0)[None],
    )  # fmt: skip
    loop = connect(
        [plant, pi(dt=dt, **tuning.gains())], inputs=("speed_reference",), outputs=("speed_motor",)
    )
    assert (np.max(np.abs(loop.poles())) < 1.0) == tuning.stable == stable


def test_the_step_across_the_gap_settles_sooner_than_with_table_2():
    reference = np.where(np.arange(8000) < 3000, -2.0, 2.0)
    found = {}
    for name, gains in (("tuned", symmetrical_optimum(PLANT, dt=DT).gains()), ("table 2", {})):
        run = simulate(
            PLANT, dt=DT, law=pi(dt=DT, torque_limit=73.5, **gains), delay=1, speed_reference=reference
        )
        found[name] = step_metrics(run.time, run["speed_load"], 0.3, -2.0, 2.0, torque=run["torque_motor"])
    assert found["tuned"].settling_time < 0.8 * found["table 2"].settling_time
    assert found["tuned"].overshoot < min(found["table 2"].overshoot, 8.5)
    assert found["tuned"].peak_torque < found["table 2"].peak_torque


@pytest.mark.parametrize("share", [0.3, 0.03])
def test_noise_is_filtered_where_a_larger_spread_would_take_the_loop_s_speed(share):
    """The torque's noise is within the limit, and the loop far faster than the share² of a larger spread alone."""
    free = symmetrical_optimum(PLANT, dt=DT, spread=None)
    assert free.speed_filter_time == 0.0 and "speed_filter_time" not in free.gains()
    tuning = symmetrical_optimum(PLANT, dt=DT, spread=None, largest_noise_gain=share * free.kp)
    assert tuning.speed_filter_time > 0.0 and tuning.sensitivity < 2.0
    assert tuning.filter_time < free.filter_time / (3.0 * share**2)
    noise = np.random.default_rng(1).normal(size=20_000)
    # The motor hardly moves for it: the law's answer to the noise alone.
    torque = pi(dt=DT, **tuning.gains()).run({"speed_reference": 0.0 * noise, "speed_motor": noise})
    assert np.std(torque["torque_motor"][2000:]) < 1.2 * share * free.kp


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        ({"dt": 0.0}, "dt"),
        ({"delay": -1}, "delay"),
        ({"spread": 1.0}, "spread"),
        ({"spread": np.nan}, "spread"),
    ],
)
def test_misuse(arguments, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        symmetrical_optimum(PLANT, **{"dt": DT, **arguments})
