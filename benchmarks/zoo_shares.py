"""How many inertias, stiffnesses and backlashes are identified, of those that the recordings show, by kind of drive."""

from __future__ import annotations

from zoo_tables import CORE, Scores, groups, numbers

#: Dimensions of the table.
DIMENSIONS = ("excitation", "torque", "load_torque", "masses", "gap", "pole_dt", "rows")


def share_table(scores: Scores) -> list[str]:
    """Markdown: a row for all, one for drives without a gap, and one for each kind and quartile."""
    none = scores.of(lambda entry: entry["dimensions"]["gap"] == 0.0)
    chosen = {"all": scores.rows, "without a gap": none.rows}
    chosen |= {name: rows for name, rows in groups(scores).items() if name.split()[0] in DIMENSIONS}
    lines = ["| drives | values shown | identified, % |", "|---" * 3 + "|"]
    for name, rows in chosen.items():
        shown = [row for row in rows if row.name in CORE and row.counts]
        if shown:
            lines.append(f"| {name} | {len(shown)} | {100 * numbers(shown)['identified']:.0f} |")
    return lines
