"""At which load speeds a loop is proved stable, and at which it is not."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from ..argument_checks import checks_arguments
from ..display.numbers import digits
from ..errors import InvalidInput
from .style import ESTIMATED, panels

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: Load speed where the axis begins, rad/s, and where it ends if nothing is proved (option).
SLOWEST, FASTEST = 1e-3, 1e3

#: Height of a bar over the distance of two (option).
HEIGHT = 0.55


@checks_arguments
def stability_range(
    proofs: Mapping[str, Mapping[str, Any]],
    *,
    title: str = "Load speeds at which the loop is proved stable",
    axes: Axes | None = None,
) -> Figure:
    """One bar for each proof over the load speed: hatched where nothing is proved, full where the loop is stable.

    Parameters
    ----------
    proofs : mapping of label → section
        Sections as ``certificates.stability`` and ``certificates.box_stability`` make them.
    title : str
    axes : Axes, optional

    Returns
    -------
    Figure

    Raises
    ------
    InvalidInput
        Without a proof, and for what is no such section.
    """
    if not proofs or any("proved" not in section for section in proofs.values()):
        raise InvalidInput(
            "proofs", repr(list(proofs)), "label → section Stability", "Take certificates.stability."
        )
    figure, (axis,) = panels(axes, 1, size=(7.0, 1.1 + 0.75 * len(proofs)))
    ends = [float(section.get("speed_to") or FASTEST) for section in proofs.values()]
    for row, section in enumerate(proofs.values()):
        proved = bool(section["proved"])
        start = float(section["speed_from"]) if proved else max(ends)
        axis.barh(
            row,
            start - SLOWEST,
            HEIGHT,
            SLOWEST,
            color="white",
            edgecolor="#999999",
            hatch="////",
            linewidth=0,
        )
        if proved:
            axis.barh(row, float(section["speed_to"]) - start, HEIGHT, start, color=ESTIMATED["color"])
            axis.text(
                1.15 * start, row, "\n".join([f"from {start:g} rad/s", *_after(section)]), va="center", color="white",
                fontsize=8,
            )  # fmt: skip
        else:
            box = {"facecolor": "white", "edgecolor": "none", "pad": 2.0}
            axis.text(1.0, row, "not proved", ha="center", va="center", bbox=box, fontsize=9)
    axis.set_xscale("log")
    axis.set_xlim(SLOWEST, max(ends))
    axis.set_ylim(len(proofs) - 0.5, -0.5)
    axis.set_yticks(range(len(proofs)), list(proofs))
    axis.grid(False, axis="y")
    axis.set_xlabel("load speed (rad/s), standstill to the left; hatched: not proved")
    axis.set_title(title, fontweight="bold")
    return figure


def _after(section: Mapping[str, Any]) -> list[str]:
    """What the proof needs beside the speed."""
    step, (high, low) = section.get("step"), (-float(m) for m in section.get("torque_load", (0.0, 0.0)))
    parts = [] if step is None else [f"after steps to {step:g} rad/s"]
    return parts + ([f"against {digits(low, 3)} to {digits(high, 3)} Nm"] if low > 0.0 else [])
