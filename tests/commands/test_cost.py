"""What a command will cost is said before it begins; the absurd is refused before any memory is taken."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import pytest

import lostmotion as lm
from lostmotion.commands.cost import Cost
from lostmotion.commands.excite import excitation_file
from lostmotion.commands.simulate import simulate_file
from lostmotion.commands.simulate_variants import simulate_variants
from lostmotion.memory import VARIABLE

LIMITS: dict[str, Any] = {"kind": "noise", "torque_limit": 5.0, "speed_limit": 5.0}


@pytest.fixture
def plant(tmp_path: Path) -> Path:
    drivetrain = lm.Drivetrain.two_mass(inertia_motor=0.02, inertia_load=0.1, stiffness=6000.0, damping=0.3)
    lm.save_drivetrain(drivetrain, tmp_path / "plant.toml")
    return tmp_path / "plant.toml"


@pytest.mark.parametrize(
    ("duration", "dt", "words"),
    [
        (1e9, 1e-4, "1e+13 samples, for which 3e+06 GB of memory"),
        (10.0, 1e-12, "1e+13 samples"),
        (1e300, 1e-300, "samples"),
        (1e3, 1e-4, "1e+07 samples, for which 3 GB of memory"),
    ],
)
def test_an_absurd_simulation_is_refused_at_once(plant: Path, duration: float, dt: float, words: str) -> None:
    before = time.perf_counter()
    for call in (
        lambda: simulate_file(plant, plant.with_name("a.csv"), duration=duration, dt=dt),
        lambda: simulate_variants(plant, plant.with_name("a.csv"), 10, duration=duration, dt=dt),
    ):
        with pytest.raises(lm.InvalidInput) as caught:
            call()
        assert words in caught.value.problem.got and "a longer dt" in caught.value.problem.remedy
        assert ("--memory-limit 3GB" in caught.value.problem.remedy) == (duration == 1e3)
    assert time.perf_counter() - before < 5.0
    assert {path.name for path in plant.parent.iterdir()} == {"plant.toml"}


def test_an_absurd_test_signal_is_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises(lm.InvalidInput, match=r"10 s at 1e-09 s: got 1e\+10 samples"):
        excitation_file(None, tmp_path / "a", duration=10.0, dt=1e-9, **LIMITS)


def test_absurdly_many_variants_are_refused_at_once(plant: Path) -> None:
    with pytest.raises(lm.InvalidInput, match=r"1000000000 variants.*GB of memory"):
        simulate_variants(plant, plant.with_name("a.csv"), 10**9)


def test_the_limit_can_be_raised(plant: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def call() -> None:
        simulate_file(plant, plant.with_name("a.csv"), duration=0.1)

    monkeypatch.setenv(VARIABLE, "0.1 MB")
    with pytest.raises(lm.InvalidInput, match=r"for which 0\.3 MB of memory.*at most 0\.1 MB"):
        call()
    monkeypatch.setenv(VARIABLE, "1MB")
    call()
    monkeypatch.setenv(VARIABLE, "much")
    with pytest.raises(lm.InvalidInput, match="LOSTMOTION_MEMORY_LIMIT: got 'much'"):
        call()


def test_a_long_command_says_so_and_a_short_one_does_not() -> None:
    said: list[str] = []
    Cost(1e6, 300.0, 1e-4).check("here", said.append)
    assert said == ["1e+06 samples: about 100 s and 300 MB of memory"]
    Cost(1e4, 300.0, 1e-4).check("here", said.append)
    with pytest.raises(lm.InvalidInput, match=r"which take about 11\.6 days, expected at most 24 hours"):
        Cost(1e6, 300.0, 1.0).check("here", said.append)
    assert len(said) == 1


@pytest.mark.parametrize("value", [float("nan"), -1.0, 0.0, float("inf")])
def test_times_that_are_no_positive_numbers_are_refused(plant: Path, value: float) -> None:
    for changed in ({"duration": value}, {"dt": value}):
        with pytest.raises(lm.InvalidInput, match="expected a positive number"):
            simulate_file(plant, plant.with_name("a.csv"), **changed)
        with pytest.raises(lm.InvalidInput, match="expected a positive number"):
            excitation_file(None, plant.with_name("a"), **{"duration": 1.0, "dt": 1e-4, **LIMITS, **changed})
