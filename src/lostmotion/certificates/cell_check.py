"""The numbers of a cell as plain data, and their exact check by the verifier."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Any

from . import verify_certificate
from .cell import Cell, CellProof
from .certificate import proof_data
from .semidefinite import Unknowns


def cell_data(proof: CellProof, unknowns: Unknowns) -> dict[str, Any]:
    """P at each knot and all multipliers of a cell, in the order in which the verifier needs them."""
    given = [proof.at_corner(unknowns, i) for i in range(len(proof.flows))]
    data = proof_data(proof.flows[0], given[0])
    multipliers = {name: v for name, v in data["multipliers"].items() if not name.startswith("flow_")}
    for i, own in enumerate(given):
        each = proof_data(proof.flows[i], own)["multipliers"]
        multipliers |= {f"flow_{i}_{name[5:]}": v for name, v in each.items() if name.startswith("flow_")}
    return {**data, "multipliers": multipliers}


def cell_verdict(header: Mapping[str, Any], numbers: Mapping[str, Any], cell: Cell) -> str | None:
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
