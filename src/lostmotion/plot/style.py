"""Shared look of the figures: names, units and scales of signals, colours that also work in grey print."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import InvalidInput
from ..recording import Recording, unit_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Floats = NDArray[np.float64]

# Okabe & Ito's palette: distinguishable with every common colour blindness. The measurement is wide and
# light, the estimate thin and dark, so that both are seen where they coincide, in grey print too.
MEASURED: dict[str, Any] = {"color": "#E69F00", "linewidth": 3.0, "linestyle": "-"}
ESTIMATED: dict[str, Any] = {"color": "#0B4F8A", "linewidth": 1.3, "linestyle": "-"}
SET_POINT: dict[str, Any] = {"color": "#222222", "linewidth": 1.0, "linestyle": (0, (2, 2))}
TRUTH: dict[str, Any] = {"markerfacecolor": "none", "markeredgecolor": "#B0400A", "markeredgewidth": 1.6}
#: One after the other for several controllers or observers in one panel.
SERIES: tuple[dict[str, Any], ...] = (
    {"color": "#E69F00", "linewidth": 2.2, "linestyle": "-"},
    {"color": "#0B4F8A", "linewidth": 1.4, "linestyle": "-"},
    {"color": "#009E73", "linewidth": 1.6, "linestyle": (0, (5, 1.5))},
    {"color": "#CC79A7", "linewidth": 1.6, "linestyle": (0, (1, 1))},
)

_WORDS = {
    "torque_motor": "motor torque",
    "torque_load": "load torque",
    "torque_shaft": "shaft torque",
    "angle_motor": "motor angle",
    "angle_load": "load angle",
    "speed_motor": "motor speed",
    "speed_load": "load speed",
    "speed_reference": "speed set-point",
    "twist": "twist",
    "twist_elastic": "elastic twist",
    "friction_load": "load friction",
}


def words(signal: str) -> str:
    """A signal's name in words: ``speed_load_estimated`` → "load speed, estimated"."""
    base = signal.removesuffix("_estimated")
    name = _WORDS.get(base, base.replace("_", " "))
    return name if base == signal else f"{name}, estimated"


def display_unit(signal: str) -> tuple[float, str]:
    """Factor from SI and unit in which a signal is drawn: twists in mrad, all others in SI; "–" if unknown."""
    if signal.startswith("twist"):
        return 1e3, "mrad"
    return 1.0, unit_of(signal) or "–"


def axis_label(signal: str) -> str:
    """Axis label with unit, such as "load speed (rad/s)"."""
    return f"{words(signal)} ({display_unit(signal)[1]})"


def source_of(recording: Recording) -> str:
    """What the signals of a recording are called in a legend: "simulated" if any of them is, else "measured"."""
    return "simulated" if "simulated" in recording.origin.values() else "measured"


def is_held(signal: str) -> bool:
    """Whether a signal is held over a sample and thus drawn in steps: motor torque and set-points."""
    return signal.startswith("torque_motor") or signal.endswith("_reference")


def panels(
    axes: Sequence[Axes] | Axes | None,
    count: int,
    *,
    columns: int = 1,
    size: tuple[float, float],
    **grid: Any,
) -> tuple[Figure, list[Axes]]:
    """The given axes, checked, or those of a new figure that belongs to no window and no global state."""
    if count < 1:
        raise InvalidInput("plot signals", "none", "at least one to draw", "Name one that is recorded.")
    if axes is None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=size, layout="constrained")
        rows = -(-count // columns)
        grown = figure.subplots(rows, columns, squeeze=False, **grid).ravel()
        for extra in grown[count:]:
            extra.remove()
        axes = list(grown[:count])
    given = list(axes) if isinstance(axes, Sequence) else [axes]
    if len(given) != count:
        raise InvalidInput("plot axes", f"{len(given)} axes", f"{count} axes", "Give one for each panel.")
    for axis in given:
        axis.grid(True, color="#d9d9d9", linewidth=0.6)
        axis.set_axisbelow(True)
        axis.spines[["top", "right"]].set_visible(False)
    return given[0].get_figure(root=True), given  # type: ignore[return-value]


def title_and_legend(figure: Figure, axes: Sequence[Axes], title: str) -> None:
    """A title above and one legend for all panels below them, where it hides no line."""
    entries: dict[str, Any] = {}
    for axis in axes:
        for handle, label in zip(*axis.get_legend_handles_labels(), strict=True):
            entries.setdefault(label, handle)
    figure.suptitle(title, fontsize=12, fontweight="bold")
    figure.legend(entries.values(), entries.keys(), loc="outside lower center", ncols=4, frameon=False)


def symlog(axis: Axes, linear: float, label: str, unit: str) -> None:
    """An x axis that is linear within ±`linear` and logarithmic beyond: its label says so, and the middle is shaded."""
    from matplotlib.ticker import FuncFormatter

    axis.set_xscale("symlog", linthresh=linear)
    axis.axvspan(-linear, linear, color="#f3f3f3", zorder=0)
    axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:+g}".replace("-", "−") if x else "0"))
    axis.set_xlabel(f"{label} ({unit}; linear within ±{linear:.2g}, shaded, and logarithmic beyond)")


def thin_min_max(time: ArrayLike, values: ArrayLike, bins: int) -> tuple[Floats, Floats]:
    """At most two points for each of the bins, its smallest and largest value in their order of time.

    Peaks stay where they are, so that a drawing of 100 000 samples looks the same and stays light.
    """
    t, v = np.asarray(time, dtype=float), np.asarray(values, dtype=float)
    bins = max(bins, 1)
    if t.size <= 2 * bins:
        return t, v
    width = -(-t.size // bins)
    starts = np.arange(0, t.size, width)
    # The last bin is filled up with the last value, which is in it anyway.
    parts = np.append(v, np.full(starts.size * width - t.size, v[-1])).reshape(-1, width)
    lowest, highest = starts + parts.argmin(axis=1), starts + parts.argmax(axis=1)
    rows = np.unique(np.concatenate([[0], lowest, highest, [t.size - 1]]))
    return t[rows], v[rows]
