"""What is written is read back equal: random content of every kind of file that the package both writes and reads."""

from __future__ import annotations

import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lostmotion as lm
from lostmotion import io as files
from lostmotion.curves import PiecewiseLinear
from lostmotion.io.tables.matrices import read_torsional_model, save_torsional_model
from lostmotion.recording import SIGNAL_UNITS
from lostmotion.systems import DiscreteSystem, InputCheck

SEEDS = range(100)


def numbers(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Of all sizes and both signs, zeros of both signs among them."""
    values = rng.normal(size=shape) * 10.0 ** rng.integers(-30, 30, shape)
    return np.where(rng.random(shape) < 0.1, rng.choice([0.0, -0.0, 5e-324, 1 / 3], shape), values)


def same(one: Any, two: Any) -> bool:
    """Equal to the last bit, in values and structure; tuples are lists."""
    if isinstance(one, np.ndarray | np.floating | float):
        return (
            isinstance(two, np.ndarray | float)
            and np.asarray(one, float).tobytes() == np.asarray(two).tobytes()
        )
    if isinstance(one, dict):
        return one.keys() == two.keys() and all(same(value, two[key]) for key, value in one.items())
    if isinstance(one, list | tuple):
        return len(one) == len(two) and all(map(same, one, two))
    return bool(one == two)


def anything(rng: np.random.Generator, depth: int = 0) -> Any:
    """What meta may hold."""
    which = rng.integers(0, 10 if depth < 3 else 6)
    if which < 6:
        return (
            None,
            True,
            int(rng.integers(-(2**60), 2**60)),
            float(rng.normal()),
            "ä\u2028\0",
            float("inf"),
        )[which]
    if which == 6:
        return numbers(rng, *rng.integers(0, 4, rng.integers(0, 3)))
    if which == 7:
        return lm.Problem("warning", "where", "got", "expected", "remedy")
    if which == 8:
        return [anything(rng, depth + 1) for _ in range(rng.integers(0, 3))]
    return {f"key {i}": anything(rng, depth + 1) for i in range(rng.integers(0, 3))}


@pytest.mark.parametrize("seed", SEEDS)
def test_recordings(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    rows = int(rng.integers(2, 50))
    names = [*rng.choice(list(SIGNAL_UNITS), 3, replace=False), "own name/ä"]
    original = lm.Recording(
        np.cumsum(rng.uniform(0.5, 1.5, rows)) * 10.0 ** rng.integers(-6, 3),
        {name: numbers(rng, rows) for name in names},
        {names[0]: "simulated"},
        tuple(
            lm.Event(*numbers(rng, 1), "impact", "shaft 1", *numbers(rng, 2))
            for _ in range(rng.integers(0, 3))
        ),
        {"state": numbers(rng, 3), "digits": anything(rng)},
        {f"meta {i}": anything(rng) for i in range(4)},
    )
    lm.save_recording(original, tmp_path / "a.npz")
    back = lm.load_recording(tmp_path / "a.npz")
    assert same(original.time, back.time) and same(dict(original.signals), dict(back.signals))
    assert (dict(original.origin), original.events) == (dict(back.origin), back.events)
    assert same(dict(original.final_state), dict(back.final_state)) and same(
        dict(original.meta), dict(back.meta)
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_csv(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    known = [name for name in SIGNAL_UNITS if not name.startswith(("energy", "angle"))]
    names = [*rng.choice(known, 3, replace=False), "speed_2", "twist_1_estimated"]
    step = 10.0 ** rng.integers(-6, -1)
    original = lm.Recording(
        step * (np.arange(150) + rng.integers(0, 10**6) + rng.uniform(-0.02, 0.02, 150)),
        {name: rng.normal(size=150) * 10.0 ** rng.integers(-11, 11) for name in names},
    )
    files.write_csv(tmp_path / "a.csv", original)
    back = files.read_recording(tmp_path / "a.csv")
    given = {name: back[name] for name in names}
    assert same(original.time, back.time) and same(dict(original.signals), given)


def curve(rng: np.random.Generator) -> PiecewiseLinear:
    z = np.sort(rng.normal(size=rng.integers(1, 5)))
    return PiecewiseLinear(tuple(zip(z, rng.normal(size=z.size), strict=True)), *rng.normal(size=2))


@pytest.mark.parametrize("seed", SEEDS)
def test_laws(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    x, u, y, w, c = (int(n) for n in (*rng.integers(0, 4, 2), rng.integers(1, 4), *rng.integers(0, 3, 2)))
    c = min(c, u)
    shapes = {
        "A": (x, x),
        "B": (x, u),
        "E": (x, w),
        "F": (w, x),
        "C": (y, x),
        "D": (y, u),
        "J": (y, w),
        "P": (c, x),
    }
    law = DiscreteSystem(
        **{name: numbers(rng, *shape) for name, shape in shapes.items()},
        H=np.tril(numbers(rng, w, w), -1),
        inputs=tuple(f"u{i}" for i in range(u)),
        outputs=tuple(f"y{i}" for i in range(y)),
        states=tuple(f"x{i}" for i in range(x)),
        dt=float(10.0 ** rng.integers(-6, 1)) / 3.0,
        curves=tuple(curve(rng) for _ in range(w)),
        checks=tuple(InputCheck(f"u{i}", *rng.uniform(0.1, 3.0, 1), 5, *rng.random(1)) for i in range(c)),
        initial_state=numbers(rng, x),
        name=f"law {seed} ä",
    )
    lm.save_law(law, tmp_path / "law.json")
    back = lm.load_law(tmp_path / "law.json")
    assert isinstance(back, DiscreteSystem) and same(law.to_dict(), back.to_dict())
    assert all(
        same(getattr(law, name), getattr(back, name))
        for name in (*shapes, "G", "H", "Q", "R", "initial_state")
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_drivetrains(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))

    def size() -> float:
        return float(10.0 ** rng.uniform(-12, 12))

    frictions = []
    for _ in range(n):
        stribeck = ((0.0, size()), (0.1, size()), (1 / 3, 0.0)) if rng.random() < 0.5 else ()
        coulomb = (size(), size()) if rng.random() < 0.5 else size()
        breakaway = 1e14 if rng.random() < 0.5 else None
        frictions.append(lm.Friction(coulomb, size(), breakaway, stribeck))
    laws = ["viscoelastic", "dead_zone", "limited", "clipped", "physical"]
    original = lm.Drivetrain(
        tuple(size() for _ in range(n)),
        tuple(lm.Shaft(size(), size(), size(), str(rng.choice(laws))) for _ in range(n - 1)),
        tuple(frictions),
        lm.Actuator(size(), *(float("inf") if rng.random() < 0.5 else size() for _ in range(2))),
        locked=rng.choice([None, "motor", "load"]),
    )
    lm.save_drivetrain(original, tmp_path / "drivetrain.toml")
    assert lm.load_drivetrain(tmp_path / "drivetrain.toml") == original


@pytest.mark.parametrize("seed", SEEDS)
def test_torsional_models(tmp_path: Path, seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = int(rng.integers(1, 6))
    half = rng.normal(size=(n, n))
    original = lm.structure.TorsionalModel(
        np.diag(10.0 ** rng.uniform(-9, 3, n)), half @ half.T, tuple(f"node {i} ä" for i in range(n)),
        rng.uniform(0.1, 9.0, n), float(rng.uniform(0.001, 0.2)),
    )  # fmt: skip
    save_torsional_model(original, tmp_path / "model.npz")
    back = read_torsional_model(tmp_path / "model.npz")
    for name in ("mass", "stiffness", "ratios", "damping_ratio", "names"):
        assert same(getattr(original, name), getattr(back, name)), name


def test_the_last_bit_of_a_number_is_seen() -> None:
    """The comparison above would notice."""
    rng = random.Random(1)
    for _ in range(100):
        value = rng.uniform(-1.0, 1.0)
        assert same([value], [value]) and not same([value], [np.nextafter(value, 2.0)])
    assert not same(0.0, -0.0) and not same({"a": 1}, {"a": 1, "b": 2}) and not same((1,), (1, 2))
