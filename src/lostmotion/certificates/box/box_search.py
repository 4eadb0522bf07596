"""Branch and bound over a box of drivetrains, in processes: what is not proved as one cell is cut in two."""

from __future__ import annotations

import signal
from collections.abc import Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass, replace
from multiprocessing import active_children
from typing import Any

from ..running import SHARES, STEP, Progress, Unproved
from .cell import Cell, corners
from .cell_check import cell_data, cell_verdict
from .cell_solver import CellClaim, solve_cell
from .cell_tree import Node, cut, open_cells, proved, share_proved

#: A cell whose sides are all below this share of the box's is not cut again (numerics: so far no box whose corners were
#: proved needed a sixteenth).
SMALLEST_SIDE = 1.0 / 64.0

#: Parameters that are cut. The backlash is not: a cell's proof is that of its largest one (docs/proofs.md, 26).
CUT = ("stiffness", "inertia_load", "inertia_motor", "coulomb")

#: Half-width at which the effect of each parameter on the margin is measured (numerics).
PROBE = 0.02


class CellUnproved(Exception):
    """No proof was found for the drivetrain with these shares of its parameters."""

    def __init__(self, reason: str, shares: Mapping[str, float]) -> None:
        super().__init__(reason)
        self.shares = dict(shares)


@dataclass(frozen=True)
class Goal:
    """What the nominal loop is proved to do (see ``running``), and the segments of its curves at rest."""

    step: float | None
    share: float
    segments: tuple[int, ...]


@dataclass(eq=False)
class BoxSearch:
    """The search for the cells of one box."""

    claim: CellClaim
    box: Cell
    workers: int
    progress: Progress

    def goal(self, has_limit: bool) -> Goal:
        """What is proved at every corner of the box; raises ``CellUnproved`` with the first that is not."""
        points = [{}, *corners(self.box, CUT)]
        largest = {name: ends[1] for name, ends in self.box.items() if name not in CUT}
        failed: CellUnproved | None = None
        for step, share in [(None, 1.0), *((STEP, share) for share in SHARES if has_limit)]:
            self.claim = replace(self.claim, step=step, share=share)
            for i, point in enumerate(points):
                self.progress(0.0, f"corner {i} of {len(points) - 1}")
                shares = {**{name: 1.0 for name in self.box}, **(largest if point else {}), **point}
                try:
                    found = solve_cell(self.claim, {name: (value, value) for name, value in shares.items()})
                except Unproved as error:
                    failed = CellUnproved(str(error), shares)
                    break
            else:
                return Goal(step, share, found.segments)
        assert failed is not None
        raise failed

    def weights(self) -> dict[str, float]:
        """How much of the margin a parameter costs, per half-width: the cut goes through the dearest side."""
        nominal = {name: (1.0, 1.0) for name in self.box}
        at_nominal = solve_cell(self.claim, nominal).margin
        found = {}
        for name in CUT:
            if name in self.box and self.box[name][0] < self.box[name][1]:
                try:
                    margin = solve_cell(self.claim, {**nominal, name: (1.0 - PROBE, 1.0 + PROBE)}).margin
                except Unproved:
                    margin = 0.0
                found[name] = max(at_nominal - margin, 1e-3 * at_nominal)
        return found

    def prove(self, data: dict[str, Any]) -> None:
        """Fill the tree ``data["cells"]``; raises ``CellUnproved`` where cutting does not help."""
        tree: Node = data["cells"]
        header = {**data, "claim": data["wanted"], "cells": None}
        waiting = list(open_cells(tree, self.box))
        weights = self.weights() if waiting else {}
        with _processes(self.workers) as pool:
            running: dict[Future[_Result], tuple[Node, Cell]] = {}
            while waiting or running:
                while waiting and len(running) < self.workers:
                    node, cell = waiting.pop()
                    running[pool.submit(_work, self.claim, header, cell)] = node, cell
                for ended in wait(running, return_when=FIRST_COMPLETED).done:
                    node, cell = running.pop(ended)
                    numbers, reason = ended.result()
                    if numbers is not None:
                        node["proof"] = numbers
                    else:
                        waiting += cut(node, cell, self._side(cell, weights, reason))
                self.progress(share_proved(tree), f"{proved(tree)} cells proved")

    def _side(self, cell: Cell, weights: Mapping[str, float], reason: str) -> str:
        """The parameter to cut; raises ``CellUnproved`` if the cell is small already."""
        sides = {name: cell[name][1] - cell[name][0] for name in weights}
        if all(side < SMALLEST_SIDE * (self.box[n][1] - self.box[n][0]) for n, side in sides.items()):
            raise CellUnproved(reason, {name: ends[1] for name, ends in cell.items()})
        return max(sides, key=lambda name: weights[name] * sides[name])


#: Numbers of each corner of a proved cell, or None and why.
_Result = tuple[list[dict[str, Any]] | None, str]


def _work(claim: CellClaim, header: Mapping[str, Any], cell: Cell) -> _Result:
    """Solve one cell, and check it in exact fractions."""
    try:
        found = solve_cell(claim, cell)
    except Unproved as error:
        return None, str(error)
    numbers = cell_data(found.proof, found.unknowns)
    reason = cell_verdict(header, numbers, cell)
    return (None, f"the exact check failed: {reason}") if reason else (numbers, "")


@contextmanager
def _processes(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A pool whose processes end at once when the block is left by an exception, Ctrl-C too."""
    others = set(active_children())
    with ProcessPoolExecutor(workers, initializer=_leave_interrupts_to_the_parent) as pool:
        try:
            yield pool
        except BaseException:
            for process in set(active_children()) - others:
                process.terminate()
            raise


def _leave_interrupts_to_the_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
