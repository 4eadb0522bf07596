"""Scores, tables and picture of the zoo benchmark."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.stats import beta, binom
from zoo_gap_bound import gap_bound_numbers, gap_bound_table
from zoo_observer import observer_numbers, observer_table

#: Dimensions that are cut in quartiles, and those that are kinds.
NUMBERS = (
    "inertia", "ratio", "pole", "pole_dt", "second_mode", "damping_ratio", "gap", "friction", "asymmetry", "lag",
    "bits", "speed_noise", "duration", "rows", "nameplate_pole",
)  # fmt: skip
KINDS = ("masses", "gaps", "law", "friction_at", "excitation", "load_torque", "closed_loop", "torque")
#: Dimensions of the picture: what they mean with their unit, and whether the axis is logarithmic.
PICTURE = {
    "ratio": ("load inertia / motor inertia", True),
    "pole_dt": ("torsional pole · sample time", True),
    "gap": ("backlash / wind-up at rated torque", True),
    "friction": ("Coulomb friction / rated torque", True),
    "bits": ("resolution of the encoder, bit", False),
}
#: Groups of equal size of a dimension in the picture; errors outside these limits, in %, are drawn at them.
GROUPS, SMALLEST, LARGEST = 6, 1e-3, 1e3
#: A drive counts for rates and errors if its Cramér–Rao half width is no more than this.
COUNTS = 0.10
#: What a controller needs of the drive; the other parameters are identified beside them.
CORE = ("inertia_motor", "inertia_load", "stiffness", "backlash")
#: Judged for itself: what it adds to the pooled figures would say nothing about the two masses.
TOTAL = "inertia_total"
#: Grossly wrong: outside the interval, and off by more than this many half widths or this share.
GROSS_HALVES, GROSS_SHARE = 3.0, 0.3


@dataclass(frozen=True)
class Row:
    """One judged parameter of one drive. error and half are relative, NaN where nothing is identified."""

    drive: int
    name: str
    identified: bool
    holds: bool
    gross: bool
    error: float
    half: float
    bound: float

    @property
    def counts(self) -> bool:
        return self.bound <= COUNTS


class Scores:
    """All judged parameters of all drives; ``identified`` are the identified ones, ``totals`` the total inertias."""

    def __init__(self, entries: Sequence[dict[str, Any]]) -> None:
        self.entries = list(entries)
        judged = [row for i, entry in enumerate(self.entries) for row in _rows(i, entry)]
        self.rows = [row for row in judged if row.name != TOTAL]
        self.totals = [row for row in judged if row.name == TOTAL]
        self.identified = [row for row in self.rows if row.identified]

    def named(self, name: str) -> list[Row]:
        """Those of a parameter, or of the total inertia."""
        return [row for row in (self.totals if name == TOTAL else self.rows) if row.name == name]

    def of(self, keep: Callable[[dict[str, Any]], bool]) -> Scores:
        """The same of the drives that are kept."""
        return Scores([entry for entry in self.entries if keep(entry)])


def _rows(drive: int, entry: dict[str, Any]) -> list[Row]:
    rows = []
    for name, truth in entry["truth"].items():
        bound = entry["bound"].get(name, np.inf)
        if name == "backlash" and truth == 0.0:
            bound = np.inf  # in rad; see ``summary``
        found = entry["found"].get(name)
        if found is None:
            if not name.endswith("_motor") or name == "inertia_motor":
                rows.append(Row(drive, name, False, False, False, np.nan, np.nan, bound))
            continue
        low, high = found["interval"]
        holds = low <= truth <= high
        off, half = abs(found["value"] - truth), 0.5 * (high - low)
        gross = not holds and (off > GROSS_HALVES * half or off > GROSS_SHARE * truth)
        relative = (off / truth, half / truth) if truth > 0.0 else (np.nan, np.nan)
        rows.append(Row(drive, name, True, holds, gross, *relative, bound))
    return rows


def quantile(values: Sequence[float], level: float) -> float:
    """Of the finite values; NaN where there is none."""
    finite = [v for v in values if np.isfinite(v)]
    return float(np.quantile(finite, level)) if finite else np.nan


def numbers(rows: Sequence[Row]) -> dict[str, float]:
    """The figures of a group of parameters."""
    identified = [row for row in rows if row.identified]
    counting = [row for row in rows if row.counts]
    errors = [row.error for row in identified if row.counts]
    return {
        "values": len(identified),
        "coverage": float(np.mean([row.holds for row in identified])) if identified else np.nan,
        "gross": float(np.mean([row.gross for row in identified])) if identified else np.nan,
        "identified": float(np.mean([row.identified for row in counting])) if counting else np.nan,
        "error_median": quantile(errors, 0.5),
        "error_90": quantile(errors, 0.9),
        "half_over_error": quantile([row.half / max(row.error, 1e-12) for row in identified], 0.5),
    }


def summary(scores: Scores) -> dict[str, Any]:
    """Pooled figures, those of each parameter, what Observer 1 does with them, and the times."""
    names = list(dict.fromkeys(row.name for row in scores.rows))
    times = [entry["time"] for entry in scores.entries]
    designed = scores.of(lambda e: e["dimensions"]["excitation"] == "designed")
    return {
        "drives": len(scores.entries),
        "refused": sum("refusal" in entry for entry in scores.entries),
        "pooled": numbers(scores.rows),
        "parameters": {name: numbers(scores.named(name)) for name in names} | {TOTAL: numbers(scores.totals)},
        "designed": {name: numbers(designed.named(name)) for name in names}
        | {TOTAL: numbers(designed.totals)},
        "observer": observer_numbers(scores.entries),
        "gap_bound": gap_bound_numbers(scores.entries),
        "time_median": quantile(times, 0.5),
        "time_largest": quantile(times, 1.0),
    }


def tables(scores: Scores) -> str:
    """Markdown: one table of the parameters, one of the dimensions."""
    if not scores.entries:
        return "no drives"
    whole = summary(scores)
    cells = _cells(scores)
    lines = [
        f"{whole['drives']} drives, {whole['refused']} refused; {whole['time_median']:.2f} s median, "
        f"{whole['time_largest']:.1f} s at most. Marked: coverage below 95 % by more than a binomial test allows "
        f"at 5 % over {len(cells)} cells.",
        "",
        *parameter_table(scores),
        "",
        *_table("dimension", groups(scores), len(cells)),
        "",
        *observer_table(whole["observer"]),
        "",
        *gap_bound_table(whole["gap_bound"]),
    ]
    return "\n".join(lines)


def parameter_table(scores: Scores) -> list[str]:
    """Markdown: a row for all values, and one for each parameter."""
    return _table("parameter", {"all": scores.rows} | _by_parameter(scores), len(_cells(scores)))


def low_cells(scores: Scores) -> list[str]:
    """Parameters, quartiles and kinds whose coverage is too low, see ``_is_low``."""
    cells = _cells(scores)
    return [name for name, rows in cells.items() if _is_low(rows, len(cells))]


def _cells(scores: Scores) -> dict[str, list[Row]]:
    """All that is judged for itself: parameters, quartiles and kinds."""
    return _by_parameter(scores) | groups(scores)


def _is_low(rows: Sequence[Row], cells: int) -> bool:
    """Whether the coverage is below 95 % by more than a binomial test allows at 5 % over so many cells."""
    hold = [row.holds for row in rows if row.identified]
    return bool(hold) and bool(binom.cdf(sum(hold), len(hold), 0.95) < 0.05 / cells)


def _by_parameter(scores: Scores) -> dict[str, list[Row]]:
    names = dict.fromkeys(row.name for row in [*scores.rows, *scores.totals])
    return {name: scores.named(name) for name in names}


def groups(scores: Scores) -> dict[str, list[Row]]:
    """Rows by kind, and by quartile of each number."""
    found: dict[str, list[Row]] = {}
    for name in KINDS:
        values = [entry["dimensions"][name] for entry in scores.entries]
        for value in sorted(set(values), key=str):
            label = f"{value:g}" if isinstance(value, float) else value
            found[f"{name} {label}"] = [row for row in scores.rows if values[row.drive] == value]
    for name in NUMBERS:
        values = np.array([entry["dimensions"][name] for entry in scores.entries], dtype=float)
        usual = values[np.isfinite(values) & (values > 0.0)]
        edges = np.quantile(usual, [0.0, 0.25, 0.5, 0.75, 1.0]) if usual.size else np.zeros(5)
        edges[-1] *= 1.0 + 1e-9
        for low, high in zip(edges[:-1], edges[1:], strict=True):
            inside = (values >= low) & (values < high)
            found[f"{name} {low:.2g} … {high:.2g}"] = [row for row in scores.rows if inside[row.drive]]
    return {name: rows for name, rows in found.items() if rows}


def _table(title: str, groups: dict[str, list[Row]], cells: int) -> list[str]:
    lines = [
        f"| {title} | values | coverage, % | grossly wrong, % | identified, % | median error, % "
        "| 90 % of errors below, % | half width over error |",
        "|---" * 8 + "|",
    ]
    for name, rows in groups.items():
        n = numbers(rows)
        identified, coverage = int(n["values"]), n["coverage"]
        low = _is_low(rows, cells)
        lines.append(
            f"| {name} | {identified} | {100 * coverage:.1f}{' **low**' if low else ''} | {100 * n['gross']:.1f} "
            f"| {100 * n['identified']:.0f} | {100 * n['error_median']:.3g} | {100 * n['error_90']:.3g} "
            f"| {n['half_over_error']:.3g} |"
        )
    return lines


def picture(scores: Scores, path: Path) -> None:
    """Coverage (above) and errors (below) over the dimensions of ``PICTURE``, of all that is identified."""
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(2, len(PICTURE), figsize=(15, 6.4), sharey="row", sharex="col")
    holds = np.array([row.holds for row in scores.identified], dtype=bool)
    errors = 100.0 * np.array([row.error for row in scores.identified], dtype=float)
    for (name, (label, logarithmic)), (above, below) in zip(PICTURE.items(), axes.T, strict=True):
        values = np.array(
            [scores.entries[row.drive]["dimensions"][name] for row in scores.identified], dtype=float
        )
        # A drive without a gap, friction or an encoder has no place on these axes.
        usable = np.isfinite(values) & (values > 0.0)
        for axis in (above, below):
            axis.set_xscale("log" if logarithmic else "linear")
            axis.grid(True, which="major", color="#dddddd", linewidth=0.6)
            axis.set_axisbelow(True)
        _coverage(above, values[usable], holds[usable])
        for hold, colour, text in (
            (True, "tab:blue", "interval holds"),
            (False, "tab:red", "interval misses"),
        ):
            kept = usable & (holds == hold) & np.isfinite(errors)
            below.plot(
                values[kept], np.clip(errors[kept], SMALLEST, LARGEST), ".", color=colour, markersize=4,
                label=f"{text} ({np.sum(holds == hold)})",
            )  # fmt: skip
        below.set_yscale("log")
        below.set_ylim(0.7 * SMALLEST, 1.4 * LARGEST)
        below.set_xlabel(label)
    axes[0, 0].set_ylabel("coverage of the 95 % intervals, %")
    axes[1, 0].set_ylabel("error of what is identified, %")
    handles = [*axes[0, 0].get_legend_handles_labels()[0], *axes[1, 0].get_legend_handles_labels()[0]]
    labels = [*axes[0, 0].get_legend_handles_labels()[1], *axes[1, 0].get_legend_handles_labels()[1]]
    figure.legend(handles, labels, loc="upper center", ncols=len(handles), frameon=False)
    figure.tight_layout(rect=(0.0, 0.0, 1.0, 0.94))
    figure.savefig(path, dpi=110)


def _coverage(axis: Any, values: NDArray[np.float64], holds: NDArray[np.bool_]) -> None:
    """Share that holds in groups of equal size, each with its own 95 % interval (Clopper and Pearson)."""
    order = np.argsort(values, kind="stable")
    labels = {"label": "share in groups of equal size, with 95 % interval"}
    for part in np.array_split(order, min(GROUPS, max(values.size, 1))):
        if not part.size:
            continue
        count, kept = part.size, int(np.sum(holds[part]))
        low = beta.ppf(0.025, kept, count - kept + 1) if kept else 0.0
        high = beta.ppf(0.975, kept + 1, count - kept) if kept < count else 1.0
        span = [values[part[0]], values[part[-1]]]
        axis.fill_between(span, 100.0 * low, 100.0 * high, color="tab:blue", alpha=0.15, linewidth=0.0)
        axis.plot(span, [100.0 * kept / count] * 2, color="black", **labels)
        labels = {}
    axis.axhline(95.0, color="tab:green", linewidth=1.0, label="95 %")
    axis.set_ylim(0.0, 103.0)
