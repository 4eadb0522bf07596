"""One self-contained HTML page: headline, claims, figures, tables, outlook."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from ..display.numbers import digits
from ..report import ReportFigure
from ..version import VERSION
from .figures import PaperFigure
from .reproduction import Reproduction

if TYPE_CHECKING:
    import jinja2
    from markupsafe import Markup

#: A symbol with its index.
SYMBOL = re.compile(r"\b(\w)_(\w+)")
#: Class of the page's style for each verdict.
STATES = {"holds": "good", "partly": "warn", "does not hold": "bad"}


@dataclass(frozen=True, eq=False)
class Shown:
    """A figure and its SVG."""

    figure: PaperFigure
    svg: str

    @property
    def uri(self) -> str:
        """As a ``data:`` address: it cannot load or run anything."""
        return ReportFigure(self.figure.title, self.figure.caption, self.svg).uri


def render(found: Reproduction, shown: Mapping[str, Shown]) -> str:
    """The page as text; ``shown`` has every figure by its name."""
    return _template().render(
        found=found,
        shown=shown,
        paper_figures=[entry for entry in shown.values() if isinstance(entry.figure.number, int)],
        states=STATES,
        version=VERSION,
    )


@cache
def _template() -> jinja2.Template:
    """The compiled template, with the report's style; text is escaped, and a misspelt name is an error."""
    import jinja2

    places = [jinja2.PackageLoader("lostmotion.paper"), jinja2.PackageLoader("lostmotion.report")]
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(places),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"digits": digits, "symbols": _symbols}
    return environment.get_template("paper.html.j2")


def _symbols(text: str) -> Markup:
    """One letter with an underscore is a symbol with an index: φ_e, M_c, β_max."""
    from markupsafe import Markup, escape

    return Markup(SYMBOL.sub(r"\1<sub>\2</sub>", str(escape(text))))
