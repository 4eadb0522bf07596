"""Margins of sampled loops against known values, formulas, eigenvalues and simulated loops."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import expm
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.certificates import margins
from lostmotion.certificates.robustness.contact_loops import contact_loops
from lostmotion.certificates.robustness.contact_margins import margin_data, margin_remark, margin_table
from lostmotion.certificates.robustness.loop_margins import loop_margins
from lostmotion.certificates.robustness.open_loop import OpenLoop
from lostmotion.errors import InvalidInput
from lostmotion.systems import design_model, linearised, loop_margin

NOTHING = np.zeros((0, 0))


def direct(a: np.ndarray, b: np.ndarray, c: np.ndarray, dt: float) -> OpenLoop:
    """u = −c x: the loop transfer function is that of the plant behind a hold."""
    n = len(a)
    return OpenLoop(A=a, B=b, reading=np.zeros((0, n)), law=NOTHING, of_plant=-c, of_law=np.zeros(0), dt=dt)


def test_of_an_integrator_they_are_those_of_the_formulas() -> None:
    # L = K T/(z − 1). With the torque late by the share ε of a sample: z² − z + K T ((1 − ε) z + ε), stable up to
    # ε K T = 1.
    gain, dt = 1.25, 1.0
    found = loop_margins(direct(np.zeros((1, 1)), np.ones((1, 1)), np.array([gain]), dt))
    assert found.gain_high == pytest.approx(2.0 / (gain * dt), rel=1e-9) and found.gain_low == 0.0
    assert found.delay == pytest.approx(1.0 / gain, rel=1e-5)
    # abs(L) = 1: 2 sin(θ/2) = K T; the phase of K T/(e^{jθ} − 1) is −π/2 − θ/2.
    turn = 2.0 * math.asin(0.5 * gain * dt)
    assert found.phase == pytest.approx(math.pi / 2.0 - turn / 2.0, rel=1e-9)
    # (1 − L)/(1 + L) = (z − 1 − K T)/(z − 1 + K T): largest at z = −1.
    assert found.disk == pytest.approx(2.0 * (2.0 - gain) / (2.0 + gain), rel=1e-9)


def test_of_a_published_loop() -> None:
    # 25/(s³ + 10 s² + 10 s + 10): the example of python-control's disk_margins, and of MATLAB's diskmargin.
    a = np.array([[-10.0, -10.0, -10.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    found = loop_margins(direct(a, np.eye(3)[:, :1], np.array([0.0, 0.0, 25.0]), 1e-4))
    assert found.disk == pytest.approx(0.46, abs=0.005)
    assert found.disk_frequency == pytest.approx(1.94, abs=0.02)
    assert found.gain_high == pytest.approx(3.6, rel=1e-3)
    assert math.degrees(found.phase) == pytest.approx(29.1, abs=0.1)
    crossover = 1.7844
    assert found.delay == pytest.approx(found.phase / crossover, rel=1e-3)


def test_an_unstable_loop_has_none() -> None:
    found = loop_margins(direct(np.zeros((1, 1)), np.ones((1, 1)), np.array([2.1]), 1.0))
    assert not found.stable and found.disk == found.delay == found.phase == 0.0
    assert [row[1] for row in margin_table(margin_data({"any": found}))] == ["unstable"]


def observer_1(plant: lm.Drivetrain, dt: float = 1e-4) -> lm.DiscreteSystem:
    parts = [lm.observers.kalman(plant, dt=dt), lm.controllers.pole_placement(plant, dt=dt)]
    return lm.connect(parts, ("speed_reference", "speed_motor"), ("torque_motor",))


@pytest.mark.parametrize("lag", [0.0, 3e-4])
def test_every_margin_is_where_the_eigenvalues_leave_the_unit_circle(lag: float) -> None:
    plant = lm.Drivetrain.two_mass(**TABLE_I, lag=lag)
    loops = contact_loops(plant, observer_1(plant), delay=1, speed=1.0, torque_load=0.0)
    assert list(loops) == [
        "running, gap closed", "running, gap open", "load held, gap closed", "load held, gap open",
    ]  # fmt: skip
    for loop in loops.values():
        found = loop_margins(loop)

        def radius(factor: complex, loop: OpenLoop = loop) -> float:
            phi, now, _ = loop.step()
            closed = np.block([
                [phi + factor * np.outer(now, loop.of_plant), factor * np.outer(now, loop.of_law)],
                [loop.reading.astype(complex), loop.law],
            ])  # fmt: skip
            poles = np.linalg.eigvals(closed)
            return float(np.max(np.abs(poles[np.abs(poles - 1.0) > 1e-9])))

        assert radius(0.999 * found.gain_high) < 1.0 < radius(1.001 * found.gain_high)
        # A factor e^{−jφ} at all frequencies: no real loop, but its eigenvalues are.
        assert max(radius(np.exp(1j * s * 0.999 * found.phase)) for s in (-1.0, 1.0)) < 1.0
        assert max(radius(np.exp(1j * s * 1.001 * found.phase)) for s in (-1.0, 1.0)) > 1.0
        disk = np.array(
            [(1 + z / 2) / (1 - z / 2) for z in found.disk * np.exp(1j * np.linspace(0, 6.283, 40))]
        )
        assert max(radius(complex(f)) for f in 1 + 0.99 * (disk - 1)) < 1.0


def test_the_delay_margin_is_that_of_the_simulated_loop() -> None:
    """A plant that is sampled ten times as fast as the law: delays in tenths of the law's sample."""
    plant = lm.Drivetrain.two_mass(**{**TABLE_I, "backlash": 0.0, "coulomb": 0.0})
    law = lm.controllers.pi(dt=1e-3)
    tenths = margins(plant, law)["running, gap closed"].delay / 1e-4
    assert tenths % 10.0 > 0.5, "a part of a sample"

    def grows(delay: int) -> bool:
        speed = lm.simulate(plant, law=law, dt=1e-4, delay=delay, speed_reference=np.ones(40_000))[
            "speed_motor"
        ]
        early, late = (np.ptp(part) for part in (speed[10_000:20_000], speed[30_000:]))
        return bool(late > early)

    assert not grows(math.floor(tenths)) and grows(math.ceil(tenths))


def test_the_closed_gap_has_the_sensitivity_of_the_design() -> None:
    plant, law = lm.Drivetrain.two_mass(**TABLE_I), lm.controllers.pi(dt=1e-4)
    loop = contact_loops(plant, law, delay=2, speed=1.0, torque_load=0.0)["running, gap closed"]
    designed = loop_margin(linearised(law, [1.0] * len(law.curves)), design_model(plant, 1e-4, 2))
    values = loop.response(np.geomspace(1e-4 * math.pi, math.pi, 300))
    assert np.max(1.0 / np.abs(1.0 + values)) == pytest.approx(designed.sensitivity, rel=1e-9)


def test_what_is_unstable_with_a_held_load_is_explained() -> None:
    stable, unstable = {"stable": True}, {"stable": False}
    assert margin_remark({"running, gap closed": unstable, "load held, gap open": stable}) == ""
    assert "motor torque swings" in margin_remark(
        {"load held, gap closed": unstable, "load held, gap open": stable}
    )


def test_with_the_load_held_the_motor_hangs_on_the_spring_or_on_nothing() -> None:
    plant, law = lm.Drivetrain.two_mass(**TABLE_I), lm.controllers.pi(dt=1e-4)
    loops = contact_loops(plant, law, delay=0, speed=1.0, torque_load=0.0)
    j, k, d = TABLE_I["inertia_motor"], TABLE_I["stiffness"], TABLE_I["damping"]
    closed, free = loops["load held, gap closed"], loops["load held, gap open"]
    np.testing.assert_allclose(closed.A, [[0.0, 1.0], [-k / j, -d / j]], rtol=1e-12)
    np.testing.assert_allclose(closed.step()[0], expm(1e-4 * closed.A), rtol=1e-12)
    assert free.A.shape == (1, 1) and free.A[0, 0] == 0.0 and free.B[0, 0] == pytest.approx(1.0 / j)


def test_without_a_rest_at_that_speed_it_says_so() -> None:
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    with pytest.raises(InvalidInput, match=r"margins\.speed"):
        margins(plant, lm.controllers.pi(dt=1e-4), speed=0.0)


def test_the_table_has_a_row_for_each_contact_state() -> None:
    plant = lm.Drivetrain.two_mass(**TABLE_I)
    rows = list(margin_table(margin_data(margins(plant, observer_1(plant)))))
    assert rows[0] == ("running, gap closed", "1.22", "0 … 24.7", "66.6°", "1.41\u00a0ms")
    assert len(rows) == 4
