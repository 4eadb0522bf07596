"""The paper's outlook, answered from the package: each answer has numbers, and says what they are."""

from __future__ import annotations

from pathlib import Path

import pytest

from lostmotion.paper import published
from lostmotion.paper.experiments import Experiments, Identified, identify_rig, reduce
from lostmotion.paper.figures import styled
from lostmotion.paper.outlook import Answer, answers
from lostmotion.paper.outlook.robustness import changed
from lostmotion.paper.tables import table_1, table_2

DOCS = Path(__file__).resolve().parents[2] / "docs"


@pytest.fixture(scope="module")
def identified(experiments: Experiments) -> Identified:
    return identify_rig(experiments.rig)


@pytest.fixture(scope="module")
def answered(experiments: Experiments, identified: Identified) -> list[Answer]:
    with styled():
        return list(answers(experiments, identified, quick=True))


def numbers(answered: list[Answer], page: str) -> dict[str, float | None]:
    return dict(next(answer for answer in answered if answer.page == page).numbers)


def test_every_question_of_the_outlook_has_an_answer_and_a_page(answered: list[Answer]) -> None:
    assert len(answered) == 6
    for answer in answered:
        assert (DOCS / answer.page).is_file()
        assert answer.text.endswith(".") and answer.numbers


def test_the_loop_is_proved_from_a_speed_on(answered: list[Answer]) -> None:
    speed = numbers(answered, "stability.md")["proved from load speed, rad/s"]
    assert speed is not None and 0.0 < speed < 1.0


def test_soft_landing_has_less_impact_than_pole_placement(answered: list[Answer]) -> None:
    found = numbers(answered, "choosing-a-controller.md")
    assert found["impact of soft landing, tolerant, rad/s"] < 0.25 * found["impact of pole placement, rad/s"]


def test_the_poles_require_the_swing(answered: list[Answer]) -> None:
    found = numbers(answered, "motor-oscillation.md")
    required, rig = found["swing required by the poles, rad/s"], found["swing on the rig, rad/s"]
    assert 0.5 * required < rig < required


def test_the_adaptive_filter_stands_a_wrong_inertia(answered: list[Answer]) -> None:
    found = numbers(answered, "leaderboard.md")
    wrong = " with a wrong load inertia, % of range"
    adaptive = found[f"error of extended Kalman, adaptive{wrong}"]
    assert adaptive < 0.1 * found[f"error of Kalman, Observer 1{wrong}"]


def test_what_is_changed_on_the_rig_is_that_alone(experiments: Experiments) -> None:
    before = experiments.rig.drivetrain
    after = changed(experiments.rig, "friction", 1.2).drivetrain
    assert after.frictions[-1].coulomb_plus == pytest.approx(1.2 * before.frictions[-1].coulomb_plus)
    assert (after.inertias, after.shafts) == (before.inertias, before.shafts)
    after = changed(experiments.rig, "load inertia", 0.8).drivetrain
    assert after.inertias == (*before.inertias[:-1], 0.8 * before.inertias[-1])


def test_table_1_has_the_papers_values_and_true_ones_within_the_intervals(
    experiments: Experiments, identified: Identified
) -> None:
    rows = {row["parameter"]: row for row in table_1(experiments, identified)}
    assert rows["stiffness"]["given"] == "6286\u00a0Nm/rad"
    assert rows["backlash"]["way"] == "locked wheel" and rows["damping"]["way"] == "reduced from FEM"
    for name, (low, high) in identified.found.intervals.items():
        true = identified.truth[name]
        assert true is not None and low <= true <= high, name


def test_the_four_equations_give_nearly_table_1(experiments: Experiments) -> None:
    found = reduce(experiments.structure).parameters()
    for name in ("inertia_motor", "inertia_load", "stiffness", "damping"):
        assert found[name] == pytest.approx(published.TABLE_I[name], rel=0.03), name


def test_table_2_is_read() -> None:
    assert [row["given"] for row in table_2()] == ["100", "20", "84.6", "50"]
