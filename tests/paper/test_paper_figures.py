"""The paper's figures: all of them, with its axes and units, one column wide, the same files in every run."""

from __future__ import annotations

from pathlib import Path

import pytest

from lostmotion.paper.experiments import Experiments
from lostmotion.paper.figures import DRAWINGS, FIGURES, PaperFigure, styled
from lostmotion.paper.figures.style import COLUMN
from lostmotion.paper.files import save_figure

#: Those of the figures of a step.
STEP = [
    "$M_e$ (Nm)",
    r"$\varphi_e - \varphi_w$ (mrad)",
    r"$\dot\varphi_e$ (rad/s)",
    r"$\dot\varphi_w$ (rad/s)",
]
#: Labels of the axes from above, by the figure's number.
LABELS = {
    4: ["amplitude (dB)", "phase (degrees)"],
    5: ["$M_e$ (Nm)", r"$\dot\varphi_e$ (rad/s)"],
    7: [r"$\beta$ (mrad)", "$M_f$ (Nm)"],
    8: ["amplitude (dB)", "phase (degrees)"],
    9: ["coherence"],
    **{n: STEP for n in (12, 13, 15)},
}


@pytest.fixture(scope="module")
def figures(experiments: Experiments) -> dict[int, PaperFigure]:
    with styled():
        found = [draw(experiments) for draw in FIGURES]
    return {int(figure.number): figure for figure in found}


def test_every_figure_of_the_paper_is_drawn(
    experiments: Experiments, figures: dict[int, PaperFigure]
) -> None:
    drawings = {int(draw(experiments).number) for draw in DRAWINGS}
    assert drawings == {1, 3, 6, 10, 11, 14}
    assert drawings | set(figures) == set(range(1, 16))


@pytest.mark.parametrize("number", LABELS)
def test_axes_and_units_are_the_papers(number: int, figures: dict[int, PaperFigure]) -> None:
    assert [axis.get_ylabel() for axis in figures[number].image.axes] == LABELS[number]


@pytest.mark.parametrize("number", (12, 13))
def test_observer_figures_show_the_papers_span(number: int, figures: dict[int, PaperFigure]) -> None:
    torque, *_, load = figures[number].image.axes
    assert load.get_xlim() == (0.95, 1.1)
    assert min(torque.get_yticks()) == -40 and max(torque.get_yticks()) == 40
    labels = {text.get_text() for text in figures[number].image.legends[0].get_texts()}
    assert labels == {"measurement (virtual rig)", "observer", "set point"}


def test_results_fit_into_one_column_and_captions_are_sentences(figures: dict[int, PaperFigure]) -> None:
    for figure in figures.values():
        assert figure.image.get_size_inches()[0] == COLUMN and not figure.wide
        assert figure.caption.endswith(".")


def test_files_are_the_same_in_every_run(experiments: Experiments, tmp_path: Path) -> None:
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder in folders:
        folder.mkdir()
        with styled():
            figure = FIGURES[3](experiments)
        save_figure(figure, folder)
    names = sorted(path.name for path in folders[0].iterdir())
    assert names == ["figure-07.pdf", "figure-07.png", "figure-07.svg"]
    for name in names:
        assert (folders[0] / name).read_bytes() == (folders[1] / name).read_bytes(), name
