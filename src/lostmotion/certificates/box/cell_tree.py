"""A box of drivetrains cut into cells: a tree whose leaves are proofs, so that nothing lies between two of them."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from .cell import Cell

#: A node as JSON holds it: {"proof": …}, {"cut": parameter, "at": share, "below": node, "above": node}, or {} where
#: nothing is proved yet.
Node = dict[str, Any]


def open_cells(node: Node, cell: Cell) -> Iterator[tuple[Node, Cell]]:
    """The leaves without a proof, with their cells."""
    if "cut" in node:
        below, above = sides(cell, node["cut"], node["at"])
        yield from open_cells(node["below"], below)
        yield from open_cells(node["above"], above)
    elif "proof" not in node:
        yield node, cell


def cut(node: Node, cell: Cell, name: str) -> list[tuple[Node, Cell]]:
    """Cut an open leaf in the middle; returns the two new leaves with their cells."""
    low, high = cell[name]
    node |= {"cut": name, "at": 0.5 * (low + high), "below": {}, "above": {}}
    below, above = sides(cell, name, node["at"])
    return [(node["below"], below), (node["above"], above)]


def sides(cell: Cell, name: str, at: float) -> tuple[Cell, Cell]:
    """The two parts of a cell."""
    low, high = cell[name]
    return {**cell, name: (low, at)}, {**cell, name: (at, high)}


def proved(node: Node) -> int:
    """Number of leaves with a proof."""
    if "cut" in node:
        return proved(node["below"]) + proved(node["above"])
    return int("proof" in node)


def share_proved(node: Node) -> float:
    """Share of the box's volume that is proved: each cut halves it."""
    if "cut" in node:
        return 0.5 * (share_proved(node["below"]) + share_proved(node["above"]))
    return float("proof" in node)
