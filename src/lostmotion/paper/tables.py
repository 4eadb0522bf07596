"""Tables I and II: what the paper gives, and what the virtual rig gives."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from ..display.numbers import given, with_interval
from ..drivetrain import PARAMETER_UNITS
from . import published
from .claims.control import response
from .experiments import Experiments, Identified, pi_law, speed_step
from .published import SYMBOLS, TABLE_I, WORDS, paper_drivetrain

Row = dict[str, Any]
Ends = tuple[float | None, float | None]
#: No interval.
NONE: Ends = (None, None)
#: Which parameters come from which test.
TESTED = {"torque step": ("coulomb", "viscous"), "locked wheel": ("backlash",)}


def table_1(e: Experiments, identified: Identified) -> list[Row]:
    """A row for each parameter: given, by the paper's way on the rig, identified from one recording, true."""
    return [_parameter(name, e, identified) for name in TABLE_I]


def _parameter(name: str, e: Experiments, identified: Identified) -> Row:
    unit = PARAMETER_UNITS[name]
    way = "reduced from FEM"
    interval: Ends = NONE
    for test, found in (("torque step", e.friction), ("locked wheel", e.locked)):
        if name in TESTED[test]:
            way, interval = test, found.intervals.get(name, interval)
    told = identified.found
    return {
        "symbol": SYMBOLS[name],
        "parameter": WORDS[name],
        "given": given(TABLE_I[name], unit),
        "way": way,
        "own": with_interval(getattr(e.model, name), *interval, unit),
        "identified": with_interval(told.values[name], *told.intervals.get(name, NONE), unit),
        "truth": given(identified.truth[name], unit),
    }


def table_2() -> list[Row]:
    """The converter's gains, and how they are read here."""
    ours = {
        "speed kp": f"{published.PI_KP:g} Nm s/rad",
        "speed ki": f"20 1/s relative to kp: {published.PI_KI:g} Nm/rad",
        "current kp": "not needed: the current loop is a lag of 0.3 ms",
        "current ki": "not needed",
    }
    return [
        {"parameter": name, "given": f"{value:g}", "reading": ours[name]}
        for name, value in published.TABLE_II.items()
    ]


def reading_of_table_2(e: Experiments) -> str:
    """What the reading gives on Table I itself and on the rig."""
    plain = replace(e.rig, drivetrain=paper_drivetrain())
    table, rig = response(speed_step(plain, pi_law())), response(e.pi_step)
    return (
        f"With this reading the step of Fig. 12 takes {table.peak_torque:.0f} Nm and overshoots by "
        f"{table.step.overshoot:.1f} % "
        f"on Table I, {rig.peak_torque:.0f} Nm and {rig.step.overshoot:.1f} % on the virtual rig; the figure's axis "
        "ends at 40 Nm."
    )
