"""Every claim of the paper, one file per group; each function takes what it judges as arguments."""

from __future__ import annotations

from collections.abc import Callable

from ..claim import Claim
from ..experiments import Experiments
from . import control, frequency, friction_backlash, gains, modes, observers, realtime

#: Groups in the order of the paper.
GROUPS: dict[str, Callable[[Experiments], list[Claim]]] = {
    "Modes and reduction": modes.claims,
    "Friction and backlash": friction_backlash.claims,
    "Frequency response and coherence": frequency.claims,
    "Observability and gains": gains.claims,
    "Observers": observers.claims,
    "Control": control.claims,
    "In real time": realtime.claims,
}

__all__ = ["GROUPS"]
