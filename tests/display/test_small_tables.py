"""Small tables: aligned as text, escaped as HTML; numbers without a unit and its prefix."""

from __future__ import annotations

import pytest

from lostmotion.display import parameters, tables
from lostmotion.display.numbers import rounded


def test_columns_are_aligned_and_lines_end_with_text() -> None:
    shown = tables.text([("a", "12", ""), ("long", "3", "x")])
    assert shown == "  a     12\n  long  3   x"


def test_a_listing_breaks_between_items_alone() -> None:
    items = [f"signal_{i} 1.5 Nm s/rad" for i in range(9)]
    lines = tables.listing(items, later="    ").splitlines()
    assert len(lines) == 3 and max(map(len, lines)) <= tables.WIDTH
    assert all(line.startswith("    signal") for line in lines[1:])
    assert ", ".join(line.strip().rstrip(",") for line in lines) == ", ".join(items)


def test_html_escapes_every_text() -> None:
    shown = tables.html("<t>", ("<h>",), [("<c>",)], ("<r>",))
    for letter in "thcr":
        assert f"&lt;{letter}&gt;" in shown
    assert "<t>" not in shown and "<c>" not in shown and "<r>" not in shown


@pytest.mark.parametrize(
    ("numbers", "shown"),
    [
        ((0.01213, 0.01205, 0.01221), ("0.01213", "0.01205", "0.01221")),
        ((6285.9, 6200.0, 6371.0), ("6286", "6200", "6371")),
        ((1.07e-10, 0.85e-10, 1.29e-10), ("1.07·10⁻¹⁰", "8.50·10⁻¹¹", "1.29·10⁻¹⁰")),
        ((None, 0.0, 1.2e-4), ("–", "0.00000", "0.00012")),
        ((2.0, None, None), ("2.000", "–", "–")),
        ((None, None, None), ("–", "–", "–")),
    ],
)
def test_value_and_interval_have_the_same_decimals(numbers, shown) -> None:
    assert rounded(*numbers) == shown


def test_an_empty_table_is_no_text() -> None:
    assert parameters.text({}) == ""


def test_markdown_is_aligned_for_a_terminal() -> None:
    markdown = (
        "Leaderboard:\n\n| observer | error |\n|---|---|\n| H∞ | 1.05 |\n| Observer 1 | – |\n\nTwo rigs."
    )
    assert tables.aligned(markdown).split("\n") == [
        "Leaderboard:", "", "  observer    error", "  H∞          1.05", "  Observer 1  –", "", "Two rigs.",
    ]  # fmt: skip
