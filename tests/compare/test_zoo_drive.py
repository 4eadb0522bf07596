"""Which drives of the zoo a comparison meets."""

from __future__ import annotations

import functools

import pytest

from lostmotion import rig
from lostmotion.compare.compare_observers import FIRST_SEED, FULL
from lostmotion.compare.controllers.compare_controllers import FIRST_SEED as FIRST_OF_CONTROLLERS
from lostmotion.compare.controllers.experiment import APART as APART_OF_CONTROLLERS
from lostmotion.compare.experiment import APART
from lostmotion.compare.zoo_drive import KINDS, WIDE, zoo_drive
from lostmotion.errors import InvalidInput

TEST = rig.SETS["test"]


@pytest.fixture
def looked_at(monkeypatch):
    """Seeds of the drives that were asked for; none has a drive."""
    asked = []
    monkeypatch.setattr("lostmotion.rig.bench", asked.append)

    def drives(seed, apart):
        asked.clear()
        with pytest.raises(InvalidInput, match=f"none of whose {apart} drives"):
            zoo_drive.__wrapped__(seed, apart)
        return set(asked)

    return drives


@pytest.mark.parametrize("apart, over_the_end", [(APART, 83), (APART_OF_CONTROLLERS, 212)])
def test_a_seed_looks_at_its_own_drives_alone(looked_at, apart, over_the_end):
    first, second, last = (looked_at(seed, apart) for seed in (1, 2, over_the_end))
    assert all(len(drives) == apart and drives <= set(TEST) for drives in (first, second, last))
    assert TEST[0] in last and TEST[-1] in last and not first & second


def test_on_the_drives_of_the_table_nothing_was_tuned(looked_at):
    """Seeds of docs/benchmarks/zoo.md and fitted-laws.md, and those of the controllers' table."""
    own = set().union(*(looked_at(seed, APART) for seed in range(FIRST_SEED, FIRST_SEED + FULL[0])))
    used = {*range(20_000, 20_108), *range(25_000, 28_000)}
    for seed in range(FIRST_OF_CONTROLLERS, FIRST_OF_CONTROLLERS + 20):
        used |= looked_at(seed, APART_OF_CONTROLLERS)
    assert not own & used and len(own) == APART * FULL[0]


def test_every_drive_is_of_one_kind():
    benches = [bench for bench in map(rig.bench, range(131, 160)) if bench is not None]
    kinds = [[name for name, suits in KINDS.items() if suits(bench)] for bench in benches]
    assert all(len(names) == 1 for names in kinds) and {names[0] for names in kinds} == set(KINDS)
    for bench, (kind,) in zip(benches, kinds, strict=True):
        windup = rig.TORQUE_LIMIT / bench.model.stiffness
        assert (bench.model.backlash > WIDE * windup) == (kind == "wide gap")
        assert kind == "wide gap" or (len(bench.rig.drivetrain.inertias) == 2) == (kind == "two masses")


def test_the_first_drive_that_suits():
    bench = functools.cache(rig.bench)
    for suits in KINDS.values():
        found = zoo_drive(30, APART, suits)
        before = [bench(seed) for seed in range(TEST[APART * 30], found.seed)]
        assert suits(found) and len(before) < APART and not any(b and suits(b) for b in before)
