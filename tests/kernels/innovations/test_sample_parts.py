"""Parts of a sample: each transition is that of a sample as short, and what the torque does in them."""

from __future__ import annotations

import numpy as np
import pytest

from lostmotion.kernels.innovations.columns import WIDE
from lostmotion.kernels.innovations.sample_parts import (
    part_number,
    part_within,
    parts,
    shape_mean,
    until_change,
)
from lostmotion.kernels.innovations.transitions import (
    BACKLASH,
    BLOCK,
    DAMPING,
    INERTIA_LOAD,
    INERTIA_MOTOR,
    LAG,
    STIFFNESS,
    VISCOUS,
    fill_transitions,
)

DT, KIND = 1e-3, (False, 0, False, False, False)


def transitions(dt: float, finest: int) -> np.ndarray:
    q = np.zeros(26)
    q[[INERTIA_MOTOR, INERTIA_LOAD, STIFFNESS, DAMPING]] = 0.0182, 0.111, 6285.896, 0.397
    q[[BACKLASH, VISCOUS, LAG]] = 0.012, 0.0175, 8e-4
    table = np.zeros(2 * parts(finest) * BLOCK)
    fill_transitions(q, dt, 0, finest, KIND, 1.0, 0, table, np.zeros(0))
    return table.reshape(2, parts(finest), BLOCK)


def sizes(finest: int) -> list[int]:
    """All lengths with a transition, in finest parts."""
    return sorted({part_within(size, finest) for size in range(1, (1 << finest) + 1)})


@pytest.mark.parametrize("finest", [0, 1, 4, 7, 9])
def test_each_is_the_transition_of_a_sample_as_short(finest: int):
    table, states = transitions(DT, finest), slice(0, (WIDE + 4) * WIDE)
    assert {part_number(size, finest) for size in sizes(finest)} <= set(range(parts(finest)))
    for size in sizes(finest):
        alone = transitions(DT * size / (1 << finest), 0)
        found = table[:, part_number(size, finest), states]
        assert found == pytest.approx(alone[:, 0, states], rel=1e-9, abs=1e-12)


def test_any_part_is_at_most_three_of_them_long():
    for size in range(1, 513):
        left, pieces = size, 0
        while left > 0:
            left -= part_within(left, 9)
            pieces += 1
        assert pieces <= 3


def test_a_part_ends_where_a_held_torque_changes():
    assert [until_change(0.3, 9, done) for done in (0, 100, 153, 154, 511)] == [153, 53, 1, 358, 1]
    assert until_change(0.0, 9, 0) == until_change(-1.0, 9, 0) == 512
    assert until_change(0.25, 2, 0) == 1


@pytest.mark.parametrize("part", [0.0, 0.3, -1.0], ids=["no change", "held torque", "ramp"])
def test_the_means_of_a_torque_over_its_parts_add_up_to_none(part: float):
    finest, done, total = 9, 0, 0.0
    while done < 1 << finest:
        size = part_within(until_change(part, finest, done), finest)
        total += size * shape_mean(part, finest, done, size)
        done += size
    assert total == pytest.approx(0.0, abs=1e-9)
