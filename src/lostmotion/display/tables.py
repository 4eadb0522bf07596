"""Small tables and lists of text: aligned for a terminal, or as HTML for a notebook."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from html import escape

#: Columns of a representation (chosen: as wide as most terminals at least).
WIDTH = 100
#: A blank at which no line ends.
FIXED_BLANK = "\u00a0"


def text(rows: Iterable[Sequence[str]], indent: str = "  ") -> str:
    """Cells in left-aligned columns, two blanks apart, one line for each row."""
    cells = [list(row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ("  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in cells)
    return "\n".join(f"{indent}{line}".rstrip() for line in lines)


def listing(items: Iterable[str], indent: str = "  ") -> str:
    """Items with commas between them, in lines of at most ``WIDTH`` that end after an item."""
    whole = ", ".join(item.replace(" ", FIXED_BLANK) for item in items)
    lines = textwrap.wrap(whole, WIDTH - len(indent), break_long_words=False, break_on_hyphens=False)
    return "\n".join(f"{indent}{line}" for line in lines).replace(FIXED_BLANK, " ")


def html(
    title: str, header: Sequence[str], rows: Iterable[Sequence[str]], remarks: Iterable[str] = ()
) -> str:
    """A title, a table and remarks below it; every text is escaped."""
    head = "".join(_cell("th", cell) for cell in header)
    body = "".join(f"<tr>{''.join(_cell('td', cell) for cell in row)}</tr>" for row in rows)
    below = "".join(f"<div>{escape(remark)}</div>" for remark in remarks)
    return f"<div><b>{escape(title)}</b><table><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>{below}</div>"


def _cell(kind: str, content: str) -> str:
    return f'<{kind} style="text-align: left">{escape(content)}</{kind}>'
