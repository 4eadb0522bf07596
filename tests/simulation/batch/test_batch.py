"""Batches: summaries equal single runs, any number of threads gives the same, and an interrupted batch goes on."""

from __future__ import annotations

import errno
import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from table_i import TABLE_I

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Actuator, Drivetrain, Friction, Shaft
from lostmotion.simulation import read_trajectories, simulate_batch
from lostmotion.simulation.batch import store as batch_store

DT = 1e-4
#: Longer than a block of the compiled code.
TORQUE = 10.0 * np.random.default_rng(0).standard_normal(1300)
KINDS = ("impact", "separation", "stick", "slip")


def spread(drivetrain: Drivetrain, rng: np.random.Generator) -> Drivetrain:
    """All of its numbers up to 20 % off."""

    def off(values: tuple[float, ...]) -> tuple[float, ...]:
        return tuple(value * rng.uniform(0.8, 1.2) for value in values)

    shafts = [Shaft(*off((s.stiffness, s.damping, s.backlash)), s.contact) for s in drivetrain.shafts]
    frictions = [replace(f, viscous=f.viscous * rng.uniform(0.8, 1.2)) for f in drivetrain.frictions]
    return replace(
        drivetrain, inertias=off(drivetrain.inertias), shafts=tuple(shafts), frictions=tuple(frictions)
    )


def variants(count: int) -> list[Drivetrain]:
    rng = np.random.default_rng(1)
    return [spread(Drivetrain.two_mass(**TABLE_I), rng) for _ in range(count)]


def chains(contact: str, count: int) -> list[Drivetrain]:
    """Three inertias with two backlashes, a Stribeck curve, an actuator with lag and limits."""
    shafts = (Shaft(6e3, 0.4, 0.012, contact), Shaft(2e4, 0.2, 0.004, contact))
    frictions = (
        Friction(0.5),
        Friction(0.0, 0.01),
        Friction((1.0, 1.5), 0.02, 2.5, ((0.0, 0.5), (1.0, 0.0))),
    )
    plant = Drivetrain((0.02, 0.03, 0.1), shafts, frictions, Actuator(1e-3, 15.0, 1e5))
    rng = np.random.default_rng(2)
    return [spread(plant, rng) for _ in range(count)]


def broken() -> Drivetrain:
    """A drivetrain with too many combinations of contacts to be simulated."""
    return Drivetrain((0.1,) * 15, (Shaft(1e3, 0.1, 0.01),) * 14)


def same(one: lm.BatchResult, two: lm.BatchResult) -> None:
    """Bit for bit."""
    np.testing.assert_array_equal(one.final_state, two.final_state)
    for a, b in (
        (one.peak, two.peak),
        (one.rms, two.rms),
        (one.events, two.events),
        (one.samples, two.samples),
    ):
        assert list(a) == list(b)
        for name in a:
            np.testing.assert_array_equal(a[name], b[name])
    assert one.failures == two.failures


def check_against_single_runs(plants: list[Drivetrain], made: lm.BatchResult, **arguments) -> None:
    for i, plant in enumerate(plants):
        alone = lm.simulate(plant, dt=DT, **arguments)
        moved = [
            v
            for n, v in zip(alone.final_state["names"], alone.final_state["state"], strict=True)
            if n.startswith(("twist", "speed"))
        ]
        np.testing.assert_array_equal(made.final_state[i, : len(moved)], moved)
        for name in made.peak:
            # A sum of several numbers may be rounded in another order.
            assert made.peak[name][i] == pytest.approx(np.max(np.abs(alone[name])), rel=1e-14)
            assert made.rms[name][i] == pytest.approx(np.sqrt(np.mean(alone[name] ** 2)), rel=1e-14)
        for kind in KINDS:
            assert made.events[kind][i] == sum(e.kind == kind for e in alone.events)
        for name, samples in made.samples.items():
            kept = alone[name][:: -(-len(alone) // 200)]
            np.testing.assert_allclose(samples[i], kept, rtol=1e-14, atol=1e-14 * np.max(np.abs(kept)))


def test_summaries_equal_single_runs():
    plants = variants(5)
    made = simulate_batch(
        plants, dt=DT, torque_motor=TORQUE, quantiles=("speed_load", "torque_shaft"), workers=1
    )
    check_against_single_runs(plants, made, torque_motor=TORQUE)
    assert made.done.all() and sum(made.events["impact"]) > 5
    assert made.peak["twist"][0] == np.max(
        np.abs(lm.simulate(plants[0], dt=DT, torque_motor=TORQUE)["twist"])
    )
    median = made.quantiles("speed_load", (0.5,))[0]
    np.testing.assert_array_equal(median, np.median(made.samples["speed_load"], axis=0))
    assert made.quantile_time[1] == pytest.approx(7 * DT)
    with pytest.raises(lm.InvalidInput, match="quantiles"):
        made.quantiles("twist")


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_chains_equal_single_runs(contact):
    plants = chains(contact, 3)
    names = ("torque_motor", "angle_load", "torque_shaft", "torque_shaft_2", "twist_1", "speed_2")
    given = dict(torque_motor=TORQUE, torque_2=0.3 * TORQUE[::-1], state=(0.004, 0.0, 1.0, 0.0, -1.0))
    made = simulate_batch(plants, dt=DT, signals=names, quantiles=("twist", "torque_2"), workers=1, **given)
    check_against_single_runs(plants, made, **given)
    assert max(made.peak["torque_motor"]) == 15.0  # the actuator's limit
    assert sum(made.events["stick"]) > 0 and sum(made.events["impact"]) > 0


def test_a_held_end_is_at_rest_from_the_start():
    plants = [replace(plant, locked="load") for plant in variants(2)]
    given = dict(torque_motor=TORQUE, state=(0.0, 3.0, 5.0))
    made = simulate_batch(plants, dt=DT, signals=("speed_load",), workers=1, **given)
    check_against_single_runs(plants, made, **given)
    assert not made.peak["speed_load"].any()


def test_variants_of_different_structure_share_a_batch():
    plants = [*variants(2), *chains("clipped", 2), variants(3)[2], Drivetrain((0.1,), (), (Friction(1.0),))]
    plants[1] = Drivetrain.two_mass(**{**TABLE_I, "coulomb": 0.0, "backlash": 0.0})
    made = simulate_batch(plants, dt=DT, torque_motor=TORQUE, signals=("speed_motor",), workers=1)
    check_against_single_runs(plants, made, torque_motor=TORQUE)
    assert np.isnan(made.final_state[0, 3:]).all() and made.final_state.shape == (6, 5)
    absent = simulate_batch(plants, dt=DT, torque_motor=TORQUE, signals=("twist_2",), workers=1)
    np.testing.assert_array_equal(np.isnan(absent.peak["twist_2"]), [True, True, False, False, True, True])


def test_a_batch_goes_on_from_final_states():
    plant = variants(1)[0]
    before = lm.simulate(plant, dt=DT, torque_motor=TORQUE).final_state
    made = simulate_batch([plant], dt=DT, torque_motor=TORQUE, state=before)
    check_against_single_runs([plant], made, torque_motor=TORQUE, state=before)


@pytest.mark.parametrize("workers", [2, 3])
def test_any_number_of_threads_gives_the_same(workers):
    plants = [*variants(7), *chains("physical", 2)]
    arguments = dict(dt=DT, torque_motor=TORQUE, chunk=2, quantiles=("twist",))
    one, more = (simulate_batch(plants, **arguments, workers=n) for n in (1, workers))
    same(one, more)


def test_a_law_runs_on_threads_with_the_same_result():
    plants = variants(3)
    law = lm.controllers.pi(kp=1.0, ki=5.0, dt=DT, torque_limit=20.0)
    arguments = dict(dt=DT, law=law, speed_reference=np.full(200, 2.0), chunk=1)
    one, two = (simulate_batch(plants, **arguments, workers=n) for n in (1, 2))
    same(one, two)
    check_against_single_runs(plants, one, law=law, speed_reference=np.full(200, 2.0))


@pytest.mark.parametrize("plants", [variants(3), chains("physical", 3), chains("clipped", 2)], ids=len)
def test_laws_of_all_kinds_in_compiled_variants(plants):
    """An observer that is a stepper, a slow controller on its estimates, a coarse sensor with noise, a delay."""
    model = Drivetrain.two_mass(**TABLE_I)
    observer = lm.observers.super_twisting(model, dt=DT, speed_from_counts=True)
    control = lm.controllers.pole_placement(model, poles=(-150,) * 3, dt=2 * DT, torque_limit=12.0)
    step = 2.0 * np.pi / 2**14
    arguments = {
        "law": [observer, control],
        "speed_reference": np.where(np.arange(600) % 300 < 150, -2.0, 2.0),
        "sensors": {"speed_motor": lm.Sensor("angle_motor", resolution=step, difference=True, noise=0.01)},
        "seed": 3,
        "delay": (0, 2),
    }
    signals = ("speed_load", "torque_shaft", "torque_motor", "speed_load_estimated", "speed_motor_measured")
    quantiles = ("twist", "speed_load_estimated", "speed_reference")
    made = simulate_batch(
        plants, dt=DT, signals=signals, quantiles=quantiles, **arguments, chunk=2, workers=2
    )
    assert made.done.all() and sum(made.events["impact"]) > 0
    check_against_single_runs(plants, made, **arguments)


def test_a_variant_that_fails_under_a_law_ends_nothing():
    """One variant cannot be simulated at all; the others run."""
    law = lm.controllers.pi(kp=1.0, ki=5.0, dt=DT, torque_limit=20.0)
    plants = [*variants(2), broken()]
    made = simulate_batch(plants, dt=DT, law=law, speed_reference=np.full(200, 2.0))
    assert list(made.done) == [True, True, False] and "combinations" in made.failures[2]


def test_failing_variant_is_reported_and_ends_nothing():
    plants = variants(3)
    plants.insert(1, broken())
    made = simulate_batch(plants, dt=DT, torque_motor=TORQUE, workers=1, chunk=2)
    np.testing.assert_array_equal(made.done, [True, False, True, True])
    assert set(made.failures) == {1} and "combinations" in made.failures[1]
    assert np.isnan(made.final_state[1]).all() and np.isfinite(made.final_state[[0, 2, 3], :3]).all()


def test_a_chattering_variant_is_reported():
    """An undamped shaft that bounces fifteen thousand times in a sample is given up."""
    plants = variants(2)
    stiffness = 0.5 * (1.5e4 * np.pi / 1e-2) ** 2
    plants[0] = Drivetrain.two_mass(inertia_motor=1.0, inertia_load=1.0, stiffness=stiffness, backlash=1e-9)
    arguments = dict(torque_motor=np.zeros(3), dt=1e-2, state=(0.0, 10.0, 0.0))
    made = simulate_batch(plants, workers=1, **arguments)
    np.testing.assert_array_equal(made.done, [False, True])
    assert "endlessly many events" in made.failures[0] and np.isnan(made.peak["twist"][0])
    with pytest.raises(lm.InvalidInput, match="endlessly"):
        lm.simulate(plants[0], **arguments)


def test_impossible_torques_are_refused_at_once():
    for torque, message in ((np.array([0.0, np.nan]), "finite"), (np.zeros((2, 2)), "one-dimensional")):
        with pytest.raises(lm.InvalidInput, match=message):
            simulate_batch(variants(1), dt=DT, torque_motor=torque)
    with pytest.raises(lm.InvalidInput, match="lengths"):
        simulate_batch(variants(1), dt=DT, torque_motor=np.zeros(3), torque_load=np.zeros(4))
    with pytest.raises(lm.InvalidInput, match="dt"):
        simulate_batch(variants(1), dt=-1.0, torque_motor=TORQUE)
    assert "torque_7" in simulate_batch(variants(1), dt=DT, torque_7=TORQUE).failures[0]


@pytest.mark.parametrize("workers", [1, 2])
def test_interrupted_batch_goes_on(tmp_path, workers):
    plants = variants(6)
    plants[3] = broken()
    calls: list[int] = []

    def interrupt(done: int, total: int, remaining: float) -> None:
        assert total == 6 and remaining >= 0.0
        calls.append(done)
        if done == 4:
            raise KeyboardInterrupt

    arguments = dict(dt=DT, torque_motor=TORQUE, workers=workers, chunk=2, quantiles=("twist",))
    with pytest.raises(KeyboardInterrupt):
        simulate_batch(plants, **arguments, folder=tmp_path, progress=interrupt)
    calls.clear()
    made = simulate_batch(
        plants, **arguments, folder=tmp_path, progress=lambda done, total, left: calls.append(done)
    )
    assert calls == [6]  # two chunks stood, one was left
    same(made, simulate_batch(plants, **arguments))


def test_chunks_of_another_batch_are_refused_by_name_and_kept(tmp_path):
    plants = variants(4)
    arguments = dict(dt=DT, torque_motor=TORQUE, workers=1, chunk=2, folder=tmp_path)
    simulate_batch(plants, **arguments)
    before = {file.name: file.read_bytes() for file in tmp_path.iterdir()}
    for change, names in (
        ({"torque_motor": 2.0 * TORQUE}, "torque_motor"),
        ({"quantiles": ("twist",), "dt": 2.0 * DT}, "dt, quantiles"),
        ({"state": (0.0, 1.0, 0.0)}, "state"),
        ({"chunk": 3}, "chunk"),
    ):
        with pytest.raises(lm.InvalidInput, match=f"differs in {names}, expected"):
            simulate_batch(plants, **{**arguments, **change})
    with pytest.raises(lm.InvalidInput, match="differs in drivetrains, expected"):
        simulate_batch(plants[::-1], **arguments)
    assert before == {file.name: file.read_bytes() for file in tmp_path.iterdir()}


def test_more_variants_of_the_same_go_on(tmp_path):
    arguments = dict(dt=DT, torque_motor=TORQUE, workers=1, chunk=2)
    simulate_batch(variants(5), **arguments, folder=tmp_path)
    calls: list[int] = []
    made = simulate_batch(variants(8), **arguments, folder=tmp_path, progress=lambda d, t, r: calls.append(d))
    assert calls == [6, 8]  # the last chunk was of one variant, is of two
    same(made, simulate_batch(variants(8), **arguments))


def test_chunks_by_other_code_are_worked_out_again(tmp_path, monkeypatch):
    plants, calls = variants(4), []
    arguments = dict(dt=DT, torque_motor=TORQUE, workers=1, chunk=2, folder=tmp_path)
    monkeypatch.setattr(batch_store, "source_hash", lambda: "older")
    simulate_batch(plants, **arguments)
    monkeypatch.undo()
    simulate_batch(plants, **arguments, progress=lambda d, t, r: calls.append(d))
    assert calls == [2, 4]


def test_a_batch_depends_on_its_own_layer_and_all_below():
    package = Path(lm.__file__).parent
    file = package.parents[1] / "pyproject.toml"
    if not file.is_file():
        pytest.skip("not run from the sources")
    layers = tomllib.loads(file.read_text())["tool"]["importlinter"]["contracts"][0]["layers"]
    names = [name for layer in layers[layers.index("simulation") :] for name in layer.split(" | ")]
    assert set(batch_store.SOURCES) == set(names)


def test_sources_that_change_change_the_hash(tmp_path):
    for folder in ("kernels/plant", "plot/frequency"):
        (tmp_path / folder).mkdir(parents=True)
    hashes = []
    for name in ("curves.py", "kernels/plant/event_loop.py", "plot/frequency/bode.py"):
        (tmp_path / name).write_text("")
        batch_store.source_hash.cache_clear()
        hashes.append(batch_store.source_hash(tmp_path))
    batch_store.source_hash.cache_clear()
    assert hashes[0] != hashes[1] == hashes[2]


@pytest.mark.parametrize(
    "wrong", [{"chunk": 0}, {"chunk": 2.5}, {"workers": -1}, {"workers": 0}, {"workers": True}]
)
def test_counts_below_one_are_refused(wrong):
    with pytest.raises(lm.InvalidInput, match=f"simulate_batch.{next(iter(wrong))}.*whole number"):
        simulate_batch(variants(1), dt=DT, torque_motor=TORQUE, **wrong)


@pytest.mark.parametrize("trajectories", [False, True])
def test_a_full_disk_is_said_of_the_folder(tmp_path, monkeypatch, trajectories):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(np, "savez_compressed" if trajectories else "savez", full)
    with pytest.raises(lm.InvalidInput, match="No space left") as caught:
        simulate_batch(
            variants(2), dt=DT, torque_motor=TORQUE, workers=1, folder=tmp_path, trajectories=trajectories
        )
    assert caught.value.problem.where == str(tmp_path) and not list(tmp_path.iterdir())


@pytest.mark.parametrize("part", [0.0, 0.5, None])
def test_a_damaged_chunk_is_worked_out_again(tmp_path, part):
    plants = variants(4)
    arguments = dict(dt=DT, torque_motor=TORQUE, chunk=2, folder=tmp_path)
    first = simulate_batch(plants, **arguments)
    file = tmp_path / "variants-000002.summary.npz"
    whole = file.read_bytes()
    file.write_bytes(b"no such file" if part is None else whole[: int(part * len(whole))])
    calls: list[int] = []
    same(first, simulate_batch(plants, **arguments, progress=lambda d, t, r: calls.append(d)))
    assert calls == [4]


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
