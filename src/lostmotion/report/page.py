"""One self-contained HTML page from the results of a run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..display import numbers
from . import summary, tables
from .headline import headline
from .images import SECTIONS, ReportFigure

if TYPE_CHECKING:
    import jinja2


def write_report(
    path: str | Path,
    results: Mapping[str, Any],
    figures: Iterable[ReportFigure | tuple[Any, ...]] = (),
    *,
    title: str = "Drivetrain report",
    command: str | None = None,
) -> Path:
    """Write the report: one HTML file that needs no network and no other file.

    Parameters
    ----------
    path : path of the HTML file
    results : mapping
        As in ``results.json``; SI. Any part may be missing or ``{"skipped": reason}``, any number None.
        Shown where present, beside the parts of ``results.json``:

        - ``recordings``: name → {"samples", "duration" (s), "sample_time" (s), "use", "origin",
          "signals", "file"};
        - ``fits``: name → {quantity: number, text, or {"value", "low", "high", "unit"}};
        - ``observers.baselines``: name → {signal: {...}}, as for an observer;
        - ``controllers.plant``: text, the plant of the simulated loops; otherwise it follows from ``truth``.

        A ``truth`` that is not skipped means that the virtual rig was used: everything is labelled as simulated.
    figures : iterable of ReportFigure, or tuples of its arguments
    title : str
    command : str, optional
        The command that repeats the run.

    Returns
    -------
    Path
        The file written.
    """
    target = Path(path)
    target.write_text(render(results, figures, title=title, command=command), encoding="utf-8")
    return target


def render(
    results: Mapping[str, Any],
    figures: Iterable[ReportFigure | tuple[Any, ...]] = (),
    *,
    title: str = "Drivetrain report",
    command: str | None = None,
) -> str:
    """The page as text; arguments as for `write_report`."""
    return _template().render(
        title=title,
        command=command,
        results=results,
        simulated=summary.is_simulated(results),
        lead=headline(results),
        remarks=summary.remarks(results),
        cards=summary.cards(results),
        skipped=tables.skipped(results),
        problems=list(results.get("problems") or ()),
        parts=tables.parts(results),
        figures=_by_section(figures),
    )


@cache
def _template() -> jinja2.Template:
    """The compiled template; user text is escaped, and a misspelt name is an error."""
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.PackageLoader("lostmotion.report"),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters.update(
        digits=numbers.digits, quantity=numbers.quantity, percent=numbers.percent, words=tables.words
    )
    return environment.get_template("report.html.j2")


def _by_section(figures: Iterable[ReportFigure | tuple[Any, ...]]) -> dict[str, list[dict[str, str]]]:
    grouped: dict[str, list[dict[str, str]]] = {section: [] for section in SECTIONS}
    for entry in figures:
        figure = entry if isinstance(entry, ReportFigure) else ReportFigure(*entry)
        section = figure.section if figure.section in grouped else "other"
        grouped[section].append({"title": figure.title, "caption": figure.caption, "uri": figure.uri})
    return grouped
