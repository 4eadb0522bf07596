"""Batches: summaries equal single runs, any number of processes gives the same, and an interrupted batch goes on."""

from __future__ import annotations

import numpy as np
import pytest
from plants import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import Drivetrain, Shaft
from lostmotion.simulation import read_trajectories, simulate_batch

DT = 1e-4
TORQUE = 10.0 * np.random.default_rng(0).standard_normal(400)


def variants(count: int) -> list[Drivetrain]:
    rng = np.random.default_rng(1)
    return [
        Drivetrain.two_mass(**{name: value * rng.uniform(0.8, 1.2) for name, value in TABLE_I.items()})
        for _ in range(count)
    ]


def broken() -> Drivetrain:
    """A drivetrain with too many combinations of contacts to be simulated."""
    return Drivetrain((0.1,) * 15, (Shaft(1e3, 0.1, 0.01),) * 14)


def test_summaries_equal_single_runs():
    made = simulate_batch(variants(5), dt=DT, torque_motor=TORQUE, quantiles=("speed_load",), workers=1)
    for i, variant in enumerate(variants(5)):
        alone = lm.simulate(variant, dt=DT, torque_motor=TORQUE)
        np.testing.assert_array_equal(made.final_state[i], alone.final_state["state"][:3])
        assert made.peak["twist"][i] == np.max(np.abs(alone["twist"]))
        assert made.rms["speed_motor"][i] == pytest.approx(
            np.sqrt(np.mean(alone["speed_motor"] ** 2)), rel=1e-15
        )
        assert made.events["impact"][i] == sum(e.kind == "impact" for e in alone.events)
        np.testing.assert_array_equal(made.samples["speed_load"][i], alone["speed_load"][::2])
    assert made.done.all()
    median = made.quantiles("speed_load", (0.5,))[0]
    np.testing.assert_array_equal(median, np.median(made.samples["speed_load"], axis=0))
    with pytest.raises(lm.InvalidInput, match="quantiles"):
        made.quantiles("twist")


def test_any_number_of_processes_gives_the_same():
    one, two = (simulate_batch(variants(7), dt=DT, torque_motor=TORQUE, workers=n, chunk=2) for n in (1, 2))
    np.testing.assert_array_equal(one.final_state, two.final_state)
    for name in one.peak:
        np.testing.assert_array_equal(one.peak[name], two.peak[name])


def test_failing_variant_is_reported_and_ends_nothing():
    plants = variants(3)
    plants.insert(1, broken())
    made = simulate_batch(plants, dt=DT, torque_motor=TORQUE, workers=1, chunk=2)
    np.testing.assert_array_equal(made.done, [True, False, True, True])
    assert set(made.failures) == {1} and "combinations" in made.failures[1]
    assert np.isnan(made.final_state[1]).all() and np.isfinite(made.final_state[[0, 2, 3]]).all()


def test_interrupted_batch_goes_on(tmp_path):
    plants = variants(6)
    plants[3] = broken()
    calls: list[int] = []

    def interrupt(done: int, total: int, remaining: float) -> None:
        assert total == 6 and remaining >= 0.0
        calls.append(done)
        if done == 4:
            raise KeyboardInterrupt

    arguments = dict(dt=DT, torque_motor=TORQUE, workers=1, chunk=2, folder=tmp_path, quantiles=("twist",))
    with pytest.raises(KeyboardInterrupt):
        simulate_batch(plants, **arguments, progress=interrupt)
    calls.clear()
    made = simulate_batch(plants, **arguments, progress=lambda done, total, left: calls.append(done))
    assert calls == [6]  # two chunks stood, one was left
    whole = simulate_batch(plants, **{**arguments, "folder": None})
    np.testing.assert_array_equal(made.final_state, whole.final_state)
    np.testing.assert_array_equal(made.samples["twist"], whole.samples["twist"])
    assert made.failures == whole.failures
    calls.clear()
    simulate_batch(
        plants, **{**arguments, "torque_motor": 2.0 * TORQUE}, progress=lambda d, t, r: calls.append(d)
    )
    assert calls == [2, 4, 6]  # other arguments: nothing that stands fits


def test_trajectories_in_chunks_on_disk(tmp_path):
    plants = variants(3)
    simulate_batch(plants, dt=DT, torque_motor=TORQUE, workers=1, chunk=2, folder=tmp_path, trajectories=True)
    kept = read_trajectories(tmp_path, 2)
    np.testing.assert_array_equal(
        kept["speed_load"], lm.simulate(plants[2], dt=DT, torque_motor=TORQUE)["speed_load"]
    )
    with pytest.raises(lm.InvalidInput, match="variant 9"):
        read_trajectories(tmp_path, 9)
    with pytest.raises(lm.InvalidInput, match="folder"):
        simulate_batch(plants, dt=DT, torque_motor=TORQUE, trajectories=True)
    with pytest.raises(lm.InvalidInput, match="drivetrains"):
        simulate_batch([], dt=DT, torque_motor=TORQUE)
