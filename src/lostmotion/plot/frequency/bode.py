"""Magnitude and phase of frequency responses over each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...plain_data import shown
from ..style import SERIES, panels, title_and_legend

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


#: Upper ends of the phase axis to choose from, in order of preference: that of an angle over torque first (option).
_TOPS = (0.0, 180.0, 90.0, 270.0)
#: Why a phase has gaps.
BROKEN = "Phase: not drawn where the 95 % interval of the response contains zero."
#: Margin of the phase axis beyond 360°, in degrees (option).
EDGE = 10.0

#: Frequency (Hz), response, and perhaps its margin.
Curve = tuple[ArrayLike, ArrayLike] | tuple[ArrayLike, ArrayLike, ArrayLike]


@checks_arguments
def bode(
    responses: Mapping[str, Curve],
    *,
    unit: str = "rad/(Nm)",
    title: str = "Frequency response",
    marks: Mapping[str, float] | None = None,
    coherences: Mapping[str, tuple[ArrayLike, ArrayLike]] | None = None,
    note: str = "",
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Bode diagram, at most four responses; a shaded 95 % band where a margin is given.

    The phase is drawn in the turn of 360° in which the responses jump least from one edge to the other, and broken
    where they do, or where the margin leaves every phase open.

    Parameters
    ----------
    responses : mapping of label → (frequency, response) or (frequency, response, margin)
        (m,) arrays: Hz, complex, and the half width of the 95 % interval in the response's unit.
    unit : str
        Of the response; the magnitude is shown in dB of it.
    title : str
    marks : mapping of label → frequency (Hz), optional
        Vertical lines, as for zero and pole.
    coherences : mapping of label → (frequency, coherence), optional
        A third panel; the same labels have the same line.
    note : str
        Stands below the panels, after what explains band and phase.
    axes : sequence of two or, with coherences, three Axes, optional

    Returns
    -------
    Figure
    """
    from matplotlib.font_manager import FontProperties

    count = 3 if coherences else 2
    _check_curves(responses)
    figure, grid = panels(axes, count, size=(8.0, 1.0 + 2.7 * count), sharex=True)
    upper, lower = grid[:2]
    phases = [_known_phase(*values) for values in responses.values()]
    top = min(_TOPS, key=lambda edge: sum(_jumps(_within(phase, edge)) for phase in phases))
    for (label, values), style in zip(responses.items(), SERIES, strict=False):
        frequency, response = np.asarray(values[0], dtype=float), np.asarray(values[1])
        upper.plot(frequency, _db(np.abs(response)), label=label, **style)
        lower.plot(frequency, _broken(_within(_known_phase(*values), top)), **style)
        if len(values) == 3:
            _bands(upper, lower, frequency, response, np.asarray(values[2], dtype=float), top, style)
    for name, place in (marks or {}).items():
        for axis in grid:
            axis.axvline(place, color="#777777", linewidth=0.9, linestyle=(0, (1, 2)), zorder=0.5)
        upper.annotate(name, (place, 1.0), (2, -2), xycoords=("data", "axes fraction"), textcoords="offset points",
                       va="top", fontsize=8, color="#444444")  # fmt: skip
    upper.set(xscale="log", ylabel=f"magnitude (dB of 1 {unit})")
    lower.set(xscale="log", ylabel="phase (°)", ylim=(top - 360.0 - EDGE, top + EDGE))
    lower.set_yticks(np.arange(top - 360.0, top + 1.0, 90.0))
    for label, (places, coherence) in (coherences or {}).items():
        style = dict(zip(responses, SERIES, strict=False)).get(label, SERIES[0])
        grid[2].plot(np.asarray(places), np.asarray(coherence), **style)
    if coherences:
        grid[2].set(xscale="log", ylabel="coherence (1)", ylim=(0.0, 1.03))
    lines = [BROKEN] if any(len(values) == 3 for values in responses.values()) else []
    grid[-1].set_xlabel("frequency (Hz)")
    plain_ticks(grid[-1])
    title_and_legend(figure, [upper], title)
    if below := "\n".join(line for line in (*lines, note) if line):
        figure.legends[0].set_title(below, FontProperties(size=9))
    return figure


def _db(magnitude: Any) -> Any:
    return 20.0 * np.log10(np.maximum(magnitude, 1e-300))


def _check_curves(responses: Mapping[str, Curve]) -> None:
    """Raises ``InvalidInput`` where there is none, or one has not two or three rows of one length."""
    if not responses:
        raise InvalidInput(
            "bode.responses", "none", "one response or more", "Give label: (frequency, response)."
        )
    for label, values in responses.items():
        rows = values if isinstance(values, tuple | list) else ()
        if len(rows) not in (2, 3) or len({np.shape(row) for row in rows}) > 1:
            raise InvalidInput(
                f"bode.responses[{label!r}]",
                shown(values),
                "(frequency, response) or (frequency, response, margin) of one length",
                "Give two or three rows.",
            )


def _known_phase(_: Any, response: Any, margin: Any = None) -> Any:
    """Degrees in any turn; NaN where zero lies within the margin, so that every phase is possible."""
    degrees = np.rad2deg(np.angle(np.asarray(response)))
    return degrees if margin is None else np.where(np.asarray(margin) < np.abs(response), degrees, np.nan)


def _within(degrees: Any, top: float) -> Any:
    """In the turn up to `top` and a little beyond, for what scatters about it."""
    return top + 0.5 * EDGE - np.mod(top + 0.5 * EDGE - degrees, 360.0)


def _wraps(degrees: Any) -> Any:
    """Where a phase goes on at the panel's other edge; every value is compared with the last known one before it."""
    known = np.flatnonzero(~np.isnan(degrees))
    found = np.zeros(degrees.shape, dtype=bool)
    found[known[1:]] = np.abs(np.diff(degrees[known])) > 180.0
    return found


def _jumps(degrees: Any) -> int:
    return int(np.count_nonzero(_wraps(degrees)))


def _broken(degrees: Any) -> Any:
    """Without the values at which the line would cross the panel."""
    return np.where(_wraps(degrees), np.nan, degrees)


def _bands(
    upper: Axes, lower: Axes, frequency: Any, response: Any, margin: Any, top: float, style: Mapping[str, Any]
) -> None:
    size = np.abs(response)
    shade = {"color": style["color"], "alpha": 0.25, "linewidth": 0.0}
    low = _db(np.maximum(size - margin, 1e-2 * size))
    upper.fill_between(frequency, low, _db(size + margin), label="95 % interval", **shade)
    half = np.rad2deg(np.arcsin(np.minimum(margin / np.maximum(size, 1e-300), 1.0)))
    phase = _broken(_within(_known_phase(frequency, response, margin), top))
    lower.fill_between(frequency, phase - half, phase + half, **shade)


def plain_ticks(axis: Axes) -> None:
    """Frequencies as 10, 20, 50 instead of powers of ten."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axis.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axis.xaxis.set_minor_formatter(NullFormatter())
