"""Small tables and lists of text: aligned for a terminal, or as HTML for a notebook."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from html import escape
from itertools import groupby

#: Columns of a representation (option: as wide as most terminals at least).
WIDTH = 100
#: A blank at which no line ends.
FIXED_BLANK = "\u00a0"


def text(rows: Iterable[Sequence[str]], indent: str = "  ") -> str:
    """Cells in left-aligned columns, two blanks apart, one line for each row."""
    cells = [list(row) for row in rows]
    widths = [max(map(len, column)) for column in zip(*cells, strict=True)]
    lines = ("  ".join(c.ljust(w) for c, w in zip(row, widths, strict=True)) for row in cells)
    return plain("\n".join(f"{indent}{line}".rstrip() for line in lines))


def aligned(markdown: str) -> str:
    """The same text with its tables in aligned columns, for a terminal."""
    parts = []
    for of_table, lines in groupby(markdown.split("\n"), key=lambda line: line.startswith("|")):
        if of_table:
            rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]
            parts.append(text([row for row in rows if not all(set(cell) <= set("-:") for cell in row)]))
        else:
            parts += lines
    return "\n".join(parts)


def listing(items: Iterable[str], indent: str = "  ", later: str = "  ") -> str:
    """Items with commas between them, in lines of at most ``WIDTH`` that end after an item.

    ``indent`` and ``later``: what the first line and the others begin with.
    """
    whole = ", ".join(item.replace(" ", FIXED_BLANK) for item in items)
    text = textwrap.fill(
        whole,
        WIDTH,
        initial_indent=indent,
        subsequent_indent=later,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return plain(text)


def plain(text: str) -> str:
    """Ordinary blanks, as a terminal and whoever copies from it expects."""
    return text.replace(FIXED_BLANK, " ")


def html(
    title: str, header: Sequence[str], rows: Iterable[Sequence[str]], remarks: Iterable[str] = ()
) -> str:
    """A title, a table (without a head if there is no header) and remarks below it; every text is escaped."""
    head = f"<thead>{_row('th', header)}</thead>" if header else ""
    body = "".join(_row("td", row) for row in rows)
    below = "".join(f"<div>{escape(remark)}</div>" for remark in remarks)
    return f"<div><b>{escape(title)}</b><table>{head}<tbody>{body}</tbody></table>{below}</div>"


def _row(kind: str, cells: Iterable[str]) -> str:
    # Notebooks align to the right, and a bare page leaves no space between columns.
    style = 'style="text-align: left; padding: 0.15em 0.8em 0.15em 0.4em"'
    return f"<tr>{''.join(f'<{kind} {style}>{escape(cell)}</{kind}>' for cell in cells)}</tr>"
