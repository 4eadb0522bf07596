"""A running proof for every drivetrain of a box: what is claimed, what came of it."""

from __future__ import annotations

import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem, pruned
from ..certificate import drivetrain_data
from ..continuous.continuous_law import ContinuousLaw
from ..continuous.continuous_loop import continuous_loop
from ..lure import lure_loop
from ..running import FASTEST, Progress
from .box_search import BoxSearch, CellUnproved
from .cell import PARAMETERS, Cell, LoopOf
from .cell_solver import CellClaim
from .cell_tree import proved, share_proved

#: Load speed from which a box is proved by default, rad/s (option).
SPEED = 1.0


@dataclass(frozen=True, eq=False)
class BoxProof:
    """What is proved of every drivetrain in a box.

    Parameters
    ----------
    proved : bool
    box : mapping of parameter → (smallest, largest) share of the nominal value
    speed, fastest : float, rad/s
        Range of load speeds at rest.
    torque_load : (float, float), Nm
    step : float or None
        As in ``RunningProof``.
    delay : int
    both_directions : bool
    cells : int
        How many cells are proved.
    share : float
        Share of the box's volume that they fill.
    certificate : dict
        Its claim is None while a cell is open; ``prove_box`` goes on from it.
    reason : str
        Why the box is not proved.
    stops_at : mapping of parameter → share, or None
        A drivetrain for which no proof was found.
    """

    proved: bool
    box: Cell
    speed: float
    fastest: float
    torque_load: tuple[float, float]
    step: float | None
    delay: int
    both_directions: bool
    cells: int
    share: float
    certificate: dict[str, Any]
    reason: str = ""
    stops_at: Mapping[str, float] | None = None


@checks_arguments
def around(half_width: float, parameters: Sequence[str] = PARAMETERS[:4]) -> Cell:
    """The box of ±half_width around the nominal value of each parameter.

    Raises ``InvalidInput`` for a half-width that is no share between 0 and 1, and for parameters beyond ``PARAMETERS``.
    """
    if not 0.0 < half_width < 1.0:
        raise InvalidInput("half_width", repr(half_width), "a share between 0 and 1", "0.1 is ±10 %.")
    unknown = sorted(set(parameters) - set(PARAMETERS))
    if unknown:
        raise InvalidInput("parameters", f"{unknown}", f"names out of {PARAMETERS}", "Check the names.")
    return dict.fromkeys(parameters, (1.0 - half_width, 1.0 + half_width))


@checks_arguments
def prove_box(
    drivetrain: Drivetrain,
    law: DiscreteSystem | ContinuousLaw,
    box: Mapping[str, Sequence[float]],
    *,
    speed: float = SPEED,
    fastest: float = FASTEST,
    delay: int = 0,
    torque_load: tuple[float, float] = (0.0, 0.0),
    substeps: int = 1,
    workers: int | None = None,
    earlier: Mapping[str, Any] | None = None,
    progress: Progress | None = None,
) -> BoxProof:
    """Stability from ``speed`` on with the same law and every drivetrain of the box.

    Parameters
    ----------
    drivetrain : Drivetrain
        The nominal one.
    law : DiscreteSystem or ContinuousLaw
        Reads of the shaft at most its torque: a twist is not what the cells' unit is.
    box : mapping of parameter → (smallest, largest) share of the nominal value
        See ``around``; ``{}``: the nominal drivetrain alone.
    speed, fastest, delay, torque_load, substeps
        See ``prove_running``.
    workers : int, optional
        Processes; default: one for each core.
    earlier : dict, optional
        ``certificate`` of an earlier call that was interrupted: its cells are taken if all arguments are the same.
    progress : callable, optional
        Called with the share of the box done and the number of cells. Ctrl-C ends the search, and keeps the cells.

    Raises
    ------
    InvalidInput
        For a drivetrain or law without a Lur'e form, and for a law that reads the twist.
    """
    _check(box, speed, fastest, torque_load, substeps, workers)
    if "twist" in law.inputs and box:
        raise InvalidInput(
            "certify: box", "a law that reads the twist", "speeds or the shaft torque", "Leave the box out."
        )
    if isinstance(law, ContinuousLaw):
        loop_of: LoopOf = partial(continuous_loop, law=law)
    else:
        loop_of = partial(lure_loop, law=law, delay=delay)
    nominal = loop_of(drivetrain)
    cell: Cell = {name: (float(low), float(high)) for name, (low, high) in box.items()}
    claim = CellClaim(
        drivetrain, loop_of, (float(speed), float(fastest)), (float(torque_load[0]), float(torque_load[1])),
        isinstance(law, ContinuousLaw), substeps,
    )  # fmt: skip
    search = BoxSearch(claim, cell, workers or os.cpu_count() or 1, progress or (lambda share, text: None))
    wanted = {
        "box": {name: list(ends) for name, ends in cell.items()},
        "speed_from": float(speed), "speed_to": float(fastest),
        "torque_load": list(claim.torque_load), "both_directions": nominal.is_odd, "limit": None,
    }  # fmt: skip
    data: dict[str, Any] = {
        "claim": None, "wanted": wanted, "drivetrain": drivetrain_data(drivetrain),
        "law": law.to_dict() if isinstance(law, ContinuousLaw) else pruned(law, ("torque_motor",)).to_dict(),
        "delay": delay, "segments": [], "cells": {},
    }  # fmt: skip
    reason, stops_at = "", None
    try:
        goal = search.goal(nominal.limit is not None)
        if goal.step is not None:
            wanted["limit"] = {"step": goal.step, "share": goal.share}
        data["segments"] = list(goal.segments)
        if earlier is not None and all(earlier.get(key) == data[key] for key in data if key != "cells"):
            data["cells"] = earlier["cells"]
        search.prove(data)
        data["claim"] = data.pop("wanted")
    except CellUnproved as error:
        reason, stops_at = str(error), error.shares
    except KeyboardInterrupt:
        reason = "interrupted"
    return BoxProof(
        proved=data["claim"] is not None, box=cell, speed=speed, fastest=fastest, torque_load=claim.torque_load,
        step=search.claim.step, delay=delay, both_directions=nominal.is_odd, cells=proved(data["cells"]),
        share=share_proved(data["cells"]), certificate=data, reason=reason, stops_at=stops_at,
    )  # fmt: skip


def _check(
    box: Mapping[str, Sequence[float]],
    speed: float,
    fastest: float,
    torque_load: tuple[float, float],
    substeps: int,
    workers: int | None,
) -> None:
    """Raise ``InvalidInput`` for what the annotations do not say."""
    unknown = sorted(set(box) - set(PARAMETERS))
    if unknown:
        raise InvalidInput("box", f"{unknown}", f"names out of {PARAMETERS}", "Check the names.")
    for name, ends in box.items():
        if len(ends) != 2 or not 0.0 < ends[0] <= ends[1] < math.inf:
            raise InvalidInput(
                f"box[{name!r}]", repr(ends), "smallest and largest share above 0", "1 is nominal."
            )
    if not 0.0 < speed < fastest < math.inf:
        raise InvalidInput(
            "speed", f"{speed!r} to {fastest!r} rad/s", "two speeds above 0 that rise", "Swap them."
        )
    if not torque_load[0] <= torque_load[1] or not math.isfinite(sum(torque_load)):
        raise InvalidInput(
            "torque_load", repr(torque_load), "smallest and largest torque in Nm", "Swap them."
        )
    for name, count in (("substeps", substeps), ("workers", workers)):
        if count is not None and count < 1:
            raise InvalidInput(name, repr(count), "a whole number from 1 on", "Leave it out.")
