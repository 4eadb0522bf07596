"""Margins of a loop in every contact state, and their table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import asdict
from typing import Any

from ...argument_checks import checks_arguments
from ...display.numbers import NONE, digits, quantity
from ...drivetrain import Drivetrain
from ...systems import DiscreteSystem
from .contact_loops import contact_loops
from .loop_margins import Margins, loop_margins

#: Load speed at which margins are taken, rad/s (option: where the paper's step begins, and any law runs rather than
#: stands).
SPEED = 1.0

#: Head of ``margin_table``.
MARGIN_COLUMNS = ("contact state", "disk margin", "gain may change by", "phase", "delay")


@checks_arguments
def margins(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    *,
    delay: int = 0,
    speed: float = SPEED,
    torque_load: float = 0.0,
) -> dict[str, Margins]:
    """Disk, gain, phase and delay margin of the sampled loop with the exported law, for each contact state.

    The loop is opened at the motor torque and linear in each state: "running, gap closed", "running, gap open", "load
    held, gap closed", "load held, gap open", as far as the drivetrain has them. Margins of single states do not prove
    the loop that switches between them: ``prove_running`` does. What the torque cannot move or does not see, as the
    twist in the open gap, is no part of a margin.

    Parameters
    ----------
    drivetrain, law
        As for ``prove_running``.
    delay : int
        Computing delay in samples that the loop has already.
    speed : float, rad/s
        Load speed of the rest around which the law's curves are straight.
    torque_load : float, Nm
        Constant load torque there, positive in the direction of positive speed.

    Raises
    ------
    InvalidInput
        For a drivetrain or a law that has no Lur'e form, and where the loop does not rest at that speed.
    """
    loops = contact_loops(drivetrain, law, delay=delay, speed=speed, torque_load=torque_load)
    return {state: loop_margins(loop) for state, loop in loops.items()}


def margin_data(found: Mapping[str, Margins]) -> dict[str, dict[str, Any]]:
    """Margins as JSON can hold them: no limit is None."""

    def plain(value: Any) -> Any:
        return value if isinstance(value, bool) or math.isfinite(value) else None

    return {
        state: {name: plain(value) for name, value in asdict(each).items()} for state, each in found.items()
    }


def margin_table(data: Mapping[str, Mapping[str, Any]]) -> Iterable[tuple[str, ...]]:
    """A row of text for each contact state, out of ``margin_data``; columns as ``MARGIN_COLUMNS``."""
    for state, each in data.items():
        if not each["stable"]:
            yield (state, "unstable", NONE, NONE, NONE)
            continue
        high = "any" if each["gain_high"] is None else digits(each["gain_high"])
        phase = NONE if each["phase"] is None else f"{digits(math.degrees(each['phase']))}°"
        yield (
            state, digits(each["disk"]), f"{digits(each['gain_low'])} … {high}", phase, quantity(each["delay"], "s")
        )  # fmt: skip


def margin_remark(data: Mapping[str, Mapping[str, Any]]) -> str:
    """What an unstable state with a held load means; empty without one."""
    if all(each["stable"] for state, each in data.items() if state.startswith("load held")):
        return ""
    return "unstable with the load held: while friction holds the load, the motor torque swings instead of resting"
