"""All that was reproduced: claims, tables and answers, and the headline."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from ..version import VERSION
from .claim import Claim
from .outlook import Answer
from .tables import Row


@dataclass(frozen=True, eq=False)
class Reproduction:
    """The paper on the virtual rig.

    Parameters
    ----------
    claims : mapping of group → list of Claim
    table_1, table_2 : list of rows
    reading : str
        What the reading of Table II gives.
    answers : list of Answer
    quick : bool
    """

    claims: Mapping[str, list[Claim]]
    table_1: list[Row]
    table_2: list[Row]
    reading: str
    answers: list[Answer]
    quick: bool

    def count(self) -> dict[str, int]:
        """How many claims hold, partly, do not, and of how many."""
        found = Counter(claim.verdict for group in self.claims.values() for claim in group)
        return {**{v: found[v] for v in ("holds", "partly", "does not hold")}, "of": found.total()}

    def headline(self) -> str:
        """One sentence."""
        n = self.count()
        rest = ", ".join(
            f"{n[v]} {word}" for v, word in (("partly", "partly"), ("does not hold", "not")) if n[v]
        )
        return f"{n['holds']} of {n['of']} claims hold{f', {rest}' if rest else ''}."

    def as_dict(self) -> dict[str, Any]:
        """What ``claims.json`` holds."""
        return {
            "version": VERSION,
            "quick": self.quick,
            "headline": self.headline(),
            "count": self.count(),
            "claims": [{"group": name, **c.as_dict()} for name, group in self.claims.items() for c in group],
            "table_1": self.table_1,
            "table_2": self.table_2,
            "outlook": [answer.as_dict() for answer in self.answers],
        }
