"""The job behind ``lostmotion paper``: everything of the paper again, in one folder, whole or not at all."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Protocol

from ..argument_checks import checks_arguments
from ..io import output_folder, save_json
from .claims import GROUPS
from .experiments import Experiments, identify_rig, perform
from .figures import DRAWINGS, FIGURES, styled
from .files import save_figure
from .outlook import Answer, answers
from .page import Shown, render
from .reproduction import Reproduction
from .tables import reading_of_table_2, table_1, table_2


class Progress(Protocol):
    """What shows the progress: a stage begins, gets on (0 … 1), ends."""

    def __call__(self, stage: str, fraction: float, text: str = "") -> None: ...


def silent(stage: str, fraction: float, text: str = "") -> None:
    """No progress shown."""


@checks_arguments
def reproduce(
    out: str | Path = "lostmotion-paper",
    *,
    quick: bool = False,
    force: bool = False,
    progress: Progress = silent,
) -> dict[str, Any]:
    """Do the paper's experiments on the virtual rig; write claims, figures, tables and one page, whole or not at all.

    The same files, byte for byte, in every run.

    Parameters
    ----------
    out : path
        Output folder; that of an earlier run is replaced.
    quick : bool
        A quarter of the random torque, so coherences are less certain, and no proof for a box of parameters.
    force : bool
        Write although foreign files, or changed ones, lie in the folder; they are kept.
    progress : callable
        As in ``run``.

    Returns
    -------
    dict
        What stands in ``claims.json``.

    Raises
    ------
    InvalidInput
        If the output folder cannot be used.
    """
    with output_folder(out, force=force) as folder:
        progress("record", 0.0)
        experiments = perform(quick, lambda share, text: progress("record", share, text))
        progress("record", 1.0)
        figures = folder / "figures"
        figures.mkdir()
        found = _found(experiments, quick, progress)
        shown = _draw(experiments, found, figures, progress)
        content = found.as_dict()
        (folder / "paper.html").write_text(render(found, shown), encoding="utf-8")
        save_json(folder / "claims.json", "claims", content)
    return content


def _found(e: Experiments, quick: bool, progress: Progress) -> Reproduction:
    progress("identify", 0.0)
    identified = identify_rig(e.rig, lambda share, text: progress("identify", share, text))
    progress("identify", 1.0)
    claims = {}
    for done, (name, group) in enumerate(GROUPS.items()):
        progress("claims", done / len(GROUPS), name)
        claims[name] = group(e)
    progress("claims", 1.0)
    answered: list[Answer] = []
    progress("outlook", 0.0)
    with styled():  # answers have figures
        for answer in answers(e, identified, quick):
            answered.append(answer)
            progress("outlook", min(len(answered) / 6.0, 0.99), answer.question)
    progress("outlook", 1.0)
    return Reproduction(claims, table_1(e, identified), table_2(), reading_of_table_2(e), answered, quick)


def _draw(e: Experiments, found: Reproduction, folder: Path, progress: Progress) -> dict[str, Shown]:
    """Every figure by its name, drawn and saved; those of the paper first, by number."""
    drawn = [draw(e) for draw in DRAWINGS]
    progress("draw", 0.0)
    with styled():
        drawn += [draw(e) for draw in FIGURES]
    drawn.sort(key=lambda figure: figure.name)
    drawn += [answer.figure for answer in found.answers if answer.figure is not None]
    shown: dict[str, Shown] = {}
    for done, figure in enumerate(drawn):
        progress("draw", done / len(drawn), figure.title)
        shown[figure.name] = Shown(figure, save_figure(figure, folder))
    progress("draw", 1.0)
    return shown
