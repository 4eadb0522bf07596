"""The paper's powertrain, the four equations, and chains of few inertias in place of many."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import LINEAR

from lostmotion.drivetrain import Drivetrain
from lostmotion.errors import InvalidInput
from lostmotion.structure import (
    Coupling,
    Disc,
    ShaftSegment,
    assemble,
    chain_from_frequencies,
    from_drivetrain,
    modes,
    paper_powertrain,
    reduce_to_chain,
    two_mass_from_frequencies,
    zeros,
)
from lostmotion.structure.powertrain import GAP


def twenty_elements(stiff=1.0):
    """Twenty masses, the soft shaft with the gap in the middle; 1: the motor side's own first mode is at 630 Hz."""
    parts = []
    for i in range(20):
        side = 0.02 if i < 10 else 0.11
        parts.append(Disc(f"d{i}", side / 10 * (1.0 + 0.3 * np.sin(i))))
        if i < 19:
            inner = stiff * (1.2e6 if i < 9 else 8e6) * (1.0 + 0.2 * np.cos(3 * i))
            parts.append(Coupling(f"k{i}", 6500.0 if i == 9 else inner))
    return assemble(parts)


def test_paper_powertrain():
    model = paper_powertrain()
    found = modes(model)
    assert found.frequency[0] == 0.0
    assert found.frequency[1] == pytest.approx(100.0, abs=1.5)
    assert found.frequency[2] == pytest.approx(750.0, abs=20.0)
    assert found.frequency[3] > 2000.0
    assert zeros(model)[0] == pytest.approx(38.0, abs=0.5)
    assert model.inertia_total == pytest.approx(0.1292, abs=5e-5)
    swing = {name: shape for name, shape in zip(model.names, found.shapes[:, 1], strict=True)}
    assert all(swing[name] < 0.0 for name in ("joint", "hub", "brake disc"))
    assert all(swing[name] > 0.0 for name in ("motor", "clutch output", "intermediate shaft.4"))


def test_four_equations_give_table_1():
    """From the frequencies that Table I has, to its digits; from their values rounded to 0.01 Hz, within rounding."""
    table = Drivetrain.two_mass(**LINEAR)
    exact = two_mass_from_frequencies(
        zero=table.zero_frequency,
        pole=table.pole_frequency,
        damping_ratio=table.damping_ratio,
        inertia_total=0.1292,
    )
    rounded = two_mass_from_frequencies(zero=37.87, pole=100.91, damping_ratio=0.02002, inertia_total=0.1292)
    assert (round(table.zero_frequency, 2), round(table.pole_frequency, 2)) == (37.87, 100.91)
    assert round(table.damping_ratio, 5) == 0.02002
    for found, stiffness_digits in ((exact, 0.0005), (rounded, 2.0)):
        assert round(found.inertia_motor, 4) == 0.0182
        assert round(found.inertia_load, 3) == 0.111
        assert round(found.damping, 3) == 0.397
        assert found.stiffness == pytest.approx(6285.896, abs=stiffness_digits)


@pytest.mark.parametrize("n", [2, 3, 5])
def test_chain_from_its_own_frequencies(n):
    rng = np.random.default_rng(n)
    inertias, stiffnesses = rng.uniform(0.01, 0.1, n), rng.uniform(1e3, 1e5, n - 1)
    parts = [Disc("0", inertias[0])]
    for i in range(1, n):
        parts += [Coupling(f"k{i}", stiffnesses[i - 1]), Disc(str(i), inertias[i])]
    model = assemble(parts)
    found = chain_from_frequencies(
        zeros(model), modes(model).frequency[1:], inertia_total=model.inertia_total
    )
    np.testing.assert_allclose(found.inertias, inertias, rtol=1e-7)
    np.testing.assert_allclose([shaft.stiffness for shaft in found.shafts], stiffnesses, rtol=1e-7)


def test_general_form_equals_four_equations():
    four = two_mass_from_frequencies(zero=38.0, pole=100.0, damping_ratio=0.02, inertia_total=0.13)
    chain = chain_from_frequencies([38.0], [100.0], damping_ratio=0.02, inertia_total=0.13)
    for name, value in four.parameters().items():
        assert chain.parameters()[name] == pytest.approx(value, rel=1e-9)


@pytest.mark.parametrize(("n", "band", "stiff"), [(2, (5.0, 150.0), 6.0), (4, (5.0, 900.0), 1.0)])
def test_twenty_elements_reduced(n, band, stiff):
    model = twenty_elements(stiff)
    found = reduce_to_chain(model, n, gap="d9", band=band)
    assert found.worst_db <= 0.5
    i = found.gap_shaft + 1
    sides = sum(found.drivetrain.inertias[:i]), sum(found.drivetrain.inertias[i:])
    assert sides == pytest.approx(model.inertia_sides("d9"), rel=1e-12)
    assert found.scored.mean() > 0.7


def test_soft_sides_cost_two_masses_the_response_or_the_inertias():
    model = twenty_elements()
    split, free = reduce_to_chain(model, 2, gap="d9"), reduce_to_chain(model, 2, gap=None)
    assert free.worst_db <= 0.5 < split.worst_db < 2.5
    assert free.drivetrain.inertia_total == pytest.approx(model.inertia_total, rel=1e-12)


def test_powertrain_to_four():
    found = reduce_to_chain(paper_powertrain(), 4, gap=GAP, band=(5.0, 900.0), gap_shaft=2)
    linear = from_drivetrain(found.drivetrain)
    assert found.worst_db <= 0.5
    assert modes(linear).frequency[1:3] == pytest.approx([100.0, 750.0], rel=1e-3)
    assert zeros(linear)[0] == pytest.approx(38.0, rel=1e-3)
    assert found.drivetrain.inertia_total == pytest.approx(0.1292, abs=5e-5)


def test_powertrain_to_two_says_what_it_costs():
    """Two masses cannot have both: zero and pole of the powertrain, and the inertia on each side of its gap."""
    model = paper_powertrain()
    split, free = reduce_to_chain(model, 2, gap=GAP), reduce_to_chain(model, 2, gap=None)
    assert free.worst_db < 0.5 < split.worst_db < 5.0
    assert split.drivetrain.inertias == pytest.approx(model.inertia_sides(GAP), rel=1e-12)
    assert 0.93 < free.drivetrain.inertia_motor / split.drivetrain.inertia_motor < 0.96


def test_dampers_give_the_damping_ratio():
    chain = chain_from_frequencies([38.0, 650.0], [100.0, 750.0], inertia_total=0.13, damping_ratio=0.02)
    shape = modes(from_drivetrain(chain))
    twists = np.diff(shape.shapes, axis=0)
    d = np.array([shaft.damping for shaft in chain.shafts])
    ratio = (d[:, None] * twists**2).sum(axis=0)[1:] / (2.0 * 2.0 * np.pi * shape.frequency[1:])
    np.testing.assert_allclose(ratio, 0.02, rtol=0.3)


@pytest.mark.parametrize(
    "make",
    [
        lambda: two_mass_from_frequencies(zero=100.0, pole=38.0, inertia_total=0.1),
        lambda: chain_from_frequencies([38.0], [100.0, 750.0], inertia_total=0.1),
        lambda: reduce_to_chain(paper_powertrain(), 1, gap=GAP),
        lambda: reduce_to_chain(assemble([ShaftSegment("s", 1.0, 0.1, elements=2)]), 2, gap=-1),
    ],
)
def test_misuse_is_refused(make):
    with pytest.raises(InvalidInput):
        make()
