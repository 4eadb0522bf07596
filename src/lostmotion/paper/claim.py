"""A claim of the paper, the number that was computed for it on the virtual rig, and the verdict."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

Verdict = Literal["holds", "partly", "does not hold"]


@dataclass(frozen=True)
class Claim:
    """What the paper says, and what the virtual rig says to it.

    Parameters
    ----------
    name : str
        Unique; key in ``claims.json``.
    says : str
        What the paper says, in one sentence.
    where : str
        Section, figure, table or equation.
    quantity : str
        What was computed, with its unit.
    value : tuple of floats
        The numbers computed.
    tolerance : str
        What the numbers must fulfil.
    verdict : {"holds", "partly", "does not hold"}
    sentence : str
        The result in words.
    """

    name: str
    says: str
    where: str
    quantity: str
    value: tuple[float, ...]
    tolerance: str
    verdict: Verdict
    sentence: str

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def judged(*conditions: bool) -> Verdict:
    """All conditions of a claim met: holds; some of them: partly; none: does not hold."""
    return "holds" if all(conditions) else "partly" if any(conditions) else "does not hold"


def signed(value: float, form: str) -> str:
    """A number that may be negative, by its format, with a minus sign instead of a hyphen."""
    return f"{value:{form}}".replace("-", "−")
