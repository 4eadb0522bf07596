"""The leaderboard of the controllers: arrival, overshoot and impact of every law in every group of cases."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import InvalidInput
from ..score_map import score_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Number of a score: heading, factor, blue and red end of its colours (option: from the bound by linear programming,
#: or what is not seen any more, to several times what pole placement has).
PANELS = {
    "arrival_time": ("t90, ms", 1e3, (10.0, 100.0)),
    "overshoot": ("overshoot, % of the step", 1.0, (0.3, 50.0)),
    "impact_speed": ("impact speed, rad/s", 1.0, (0.3, 9.0)),
}


def controller_leaderboard(table: Mapping[str, Any]) -> Figure:
    """A panel each for time to 90 %, overshoot and impact speed, of the speed laws over the groups of cases.

    Parameters
    ----------
    table : mapping
        As ``ControlTable.to_dict`` gives it, or read from leaderboard.json.

    Raises
    ------
    InvalidInput
        If no case has a step of the speed.
    """
    from matplotlib.figure import Figure

    cases = [case for case in table["cases"] if case["work"] in ("step", "pulse", "rest")]
    names = [row["name"] for row in table["controllers"] if row["kind"] == "speed"]
    groups = list(dict.fromkeys(case["group"] for case in cases))
    if not groups:
        raise InvalidInput(
            "plot.controller_leaderboard", "no step of the speed", "such a case", "Add 'step'."
        )
    figure = Figure(figsize=(3.4 + 1.0 * len(groups), 1.0 + len(PANELS) * (1.1 + 0.33 * len(names))))
    figure.set_layout_engine("constrained")
    for axis, (metric, (heading, factor, scale)) in zip(
        figure.subplots(len(PANELS)), PANELS.items(), strict=True
    ):
        values = np.full((len(names), len(groups)), np.nan)
        for case in cases:
            column = groups.index(case["group"])
            for row, name in enumerate(names):
                found = case["controllers"].get(name, {}).get(metric)
                if found is not None:
                    values[row, column] = np.nanmax([values[row, column], factor * found[0]])
        score_map(axis, values, names, groups, scale)
        axis.set_title(heading, fontsize=11, fontweight="bold", loc="left", pad=14)
    figure.suptitle(
        f"Worst case of each column, median of {len(table['seeds'])} virtual rigs; blue is good, red is bad",
        fontsize=11,
    )
    return figure
