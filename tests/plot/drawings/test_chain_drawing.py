"""Drawings of drivetrains and of their reduction: all values stand there once, nothing overlaps."""

from __future__ import annotations

from dataclasses import replace

import pytest
from drawn import crossed, cut_off, overlapping, texts
from matplotlib.figure import Figure
from table_i import LINEAR, PAPER

from lostmotion import plot
from lostmotion.drivetrain import Actuator, Drivetrain, Friction, Shaft
from lostmotion.structure import from_drivetrain, paper_powertrain

FIVE = Drivetrain(
    inertias=(0.0142, 0.0036, 0.0003, 0.0046, 0.1048),
    shafts=(Shaft(81400, 1.0), Shaft(6500, 0.4), Shaft(80000, 0.5, 0.012, "physical"), Shaft(2e6)),
    frictions=(
        Friction(0.3, 0.001),
        Friction(),
        Friction(),
        Friction((2.0, 1.8), 0.0175, 2.6, ((0.0, 0.5), (3.0, 0.0))),
        Friction(0.1),
    ),
    actuator=Actuator(3e-4, 73.5, 2e4),
)
DRIVES = {
    "Table I": PAPER,
    "linear": Drivetrain.two_mass(**LINEAR),
    "dead zone": PAPER.with_contact("dead_zone"),
    "five": FIVE,
    "load held": replace(FIVE, locked="load"),
    "motor held": replace(PAPER, locked="motor"),
    "rigid": Drivetrain((0.1,), frictions=(Friction(1.0),)),
    "friction everywhere": replace(FIVE, frictions=(FIVE.frictions[3],) * 5),
    "small and large": Drivetrain((1e-6, 1e3), (Shaft(1e7, 1e-5, 1e-6),)),
}
POWERTRAIN = paper_powertrain()


def assert_readable(figure: Figure) -> None:
    assert overlapping(figure) == []
    assert cut_off(figure) == []
    assert crossed(figure) == []


@pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES.keys())
def test_a_chain_is_readable(drive: Drivetrain) -> None:
    assert_readable(plot.chain(drive))


def test_a_chain_tells_every_value_with_its_unit_once() -> None:
    shown = texts(plot.chain(PAPER))
    for value in ("J₁ = 0.0182\u00a0kg m²", "J₂ = 0.111\u00a0kg m²", "k = 6286\u00a0Nm/rad", "d = 0.397\u00a0Nm·s/rad",
                  "gap 2h = 12\u00a0mrad", "Coulomb ±2\u00a0Nm", "viscous 0.0175\u00a0Nm·s/rad"):  # fmt: skip
        assert shown.count(value) == 1, value


def test_what_is_not_there_is_not_drawn() -> None:
    assert not any(
        word in text for text in texts(plot.chain(DRIVES["linear"])) for word in ("gap", "Coulomb", "lag")
    )
    five = texts(plot.chain(FIVE))
    assert sum(text.startswith("gap 2h₃") for text in five) == 1
    assert {"lag 300\u00a0µs", "limit ±73.5\u00a0Nm", "breakaway 2.6\u00a0Nm"} <= set(five)


def test_the_damper_is_drawn_across_the_gap_only_where_it_acts_there() -> None:
    """Beside the fork (accent) there is then no line of its own through the axis."""

    def fork_height(figure: Figure) -> float:
        forks = [line for line in figure.axes[0].lines if line.get_linewidth() == 1.6]
        (low, high) = sorted(forks[-1].get_ydata())[0], sorted(forks[-1].get_ydata())[-1]
        return float(0.5 * (low + high))

    assert fork_height(plot.chain(PAPER)) == 0.0
    assert fork_height(plot.chain(PAPER.with_contact("dead_zone"))) > 10.0


@pytest.mark.parametrize("gap", ["joint", None])
def test_a_reduction_names_the_discs_and_both_sides(gap: str | None) -> None:
    figure = plot.reduction(POWERTRAIN, PAPER, gap=gap)
    assert_readable(figure)
    shown = texts(figure)
    assert {"motor", "clutch output", "joint", "hub", "brake disc", "16 nodes"} <= set(shown)
    sides = [text for text in shown if "side 0." in text]
    assert sides == (["motor side 0.0198\u00a0kg m²", "load side 0.109\u00a0kg m²"] if gap else [])
    if gap is None:
        assert "0.1292\u00a0kg m² in all, first pole 100\u00a0Hz" in shown


def test_many_masses_are_reduced_to_three_with_the_gap_in_the_second_shaft() -> None:
    model = from_drivetrain(FIVE)
    three = Drivetrain((0.0142, 0.0036, 0.1097), (Shaft(6e4), Shaft(6e3, backlash=0.012)))
    figure = plot.reduction(model, three, gap=2, gap_shaft=1)
    assert_readable(figure)
    assert "5 nodes" in texts(figure)
