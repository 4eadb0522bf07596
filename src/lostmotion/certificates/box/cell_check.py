"""The numbers of a cell as plain data, and their exact check by the verifier."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from typing import Any

from .. import verify_certificate
from ..certificate import proof_data
from ..semidefinite import Unknowns
from .cell import Cell, CellProof


def cell_data(proof: CellProof, unknowns: Unknowns) -> list[dict[str, Any]]:
    """P at each knot and all multipliers of each corner of a cell, in the order in which the verifier needs them."""
    return [proof_data(own, proof.at_corner(unknowns, i)) for i, own in enumerate(proof.proofs)]


def cell_verdict(header: Mapping[str, Any], numbers: Sequence[Mapping[str, Any]], cell: Cell) -> str | None:
    """None if the numbers prove the cell in exact fractions, else why not.

    ``header``: the certificate without its cells.
    """
    read = verify_certificate.parsed
    try:
        verify_certificate.verify_cell(
            read(json.dumps(header)), read(json.dumps(numbers)), read(json.dumps(cell))
        )
    except verify_certificate.NotProved as reason:
        return str(reason)
    return None
