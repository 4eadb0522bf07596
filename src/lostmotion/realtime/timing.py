"""Timing: when the rig woke up and when the law's answers came."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Timing:
    """Times of one run, of the machine that it ran on; they promise nothing about another run.

    Parameters
    ----------
    period : float, s
        The law's sample time.
    paced : bool
        Whether the clock paced the run; else it went as fast as both processes could.
    round_trip : (n,) array, s
        From sending the inputs until the outputs were there; NaN where they came too late to act.
    wake_up : (n,) array, s
        How much later than its tick the rig woke up; empty in lock-step.
    resent : int
        Requests that were sent again because no answer came (lock-step).
    ignored : int
        Datagrams that were none, or came twice or too late.
    """

    period: float
    paced: bool
    round_trip: Floats
    wake_up: Floats
    resent: int
    ignored: int

    @property
    def missed(self) -> int:
        """Samples whose outputs were not there one period after their tick: the ones before were held."""
        return int(np.count_nonzero(np.isnan(self.round_trip)))

    def summary(self) -> dict[str, float | int | bool | dict[str, float]]:
        """Median, 99 %, 99.9 % and largest value of both times in s, and the counts."""
        found: dict[str, float | int | bool | dict[str, float]] = {
            "period": self.period, "paced": self.paced, "samples": len(self.round_trip), "missed": self.missed,
            "resent": self.resent, "ignored": self.ignored,
        }  # fmt: skip
        for name, values in (("round_trip", self.round_trip), ("wake_up", self.wake_up)):
            there = values[~np.isnan(values)]
            if there.size:
                levels = np.quantile(there, [0.5, 0.99, 0.999, 1.0]).tolist()
                found[name] = dict(zip(("median", "p99", "p999", "largest"), levels, strict=True))
        return found
