"""InputCheck: when an input of a law is rejected and replaced by its prediction."""

from __future__ import annotations

import math
from dataclasses import asdict, dataclass, fields
from typing import Any

from ..errors import InvalidInput
from ..plain_data import flag, number, shown, table, text, whole

#: After this time of rejected samples the signal is accepted again by default, s (option).
HOLD = 0.03
#: Time constant with which accepted errors are forgotten by default, s (option).
MEMORY = 1.0


@dataclass(frozen=True)
class InputCheck:
    """A measured input that is compared with the law's prediction, and replaced by it while it is bad.

    The error is sample minus prediction. "Recent" values fade by ``forget``. Bad is a sample that is

    - **missing**: not within ±1e30, NaN and infinity included;
    - a **jump**: its error exceeds ``limit`` and 1.5 times the largest recent error; or it differs from the error
    before
      by more than a quarter of ``limit`` and three times the largest recent change. (Wrong parameters let the error
      drift; only an impact changes it from one sample to the next.) After a jump, a sample must be within half the
      limit, and nearer to its prediction than to the bad sample;
    - **frozen**: the same value as the bad sample before; or unchanged for five samples or more while the error drifts:
      the error, and its change since, exceed 2.25 times the largest recent change. In a run of eight samples or more
      that is longer than any recent run, 0.75 times, falling to 0.075 times the longer it lasts.

    A bad sample is replaced by the prediction, so the law sees no error. Limits adapt: errors, changes and runs of
    accepted samples count fully, the first sample of every jump counts an eighth. No law is locked out: after ``hold``
    bad samples in a row (four times as many while the signal is frozen), and at the start, every finite sample is
    accepted until ``hold`` samples in a row were no jump.

    Parameters
    ----------
    input : str
    limit : float, unit of the input
        Choose it several times the errors of good samples.
    hold : int
        Samples.
    forget : float
        Factor per sample on the largest error, the largest change, and the longest run.
    keep : bool
        A bad sample is replaced by the last good one instead of the prediction: for a law that cannot predict further
        than one sample.
    alone : bool
        For a law without a model of what moves the signal, whose prediction soon follows a frozen one: a value other
        than zero is frozen if it came more than five times in a row, and three times as often as any recent one.
    missing_only : bool
        Every sample but a missing one is accepted: for a command, which may stand still and jump. The last good one
        takes its place while an input that the prediction needs is bad too.
    """

    input: str
    limit: float
    hold: int
    forget: float
    keep: bool = False
    alone: bool = False
    missing_only: bool = False

    def __post_init__(self) -> None:
        where = f"check of {shown(self.input)}"
        object.__setattr__(self, "limit", number(f"{where}: limit", self.limit))
        object.__setattr__(self, "forget", number(f"{where}: forget", self.forget))
        if not self.limit > 0.0:
            raise InvalidInput(f"{where}: limit", repr(self.limit), "a positive number", "Check the unit.")
        if not (isinstance(self.hold, int) and self.hold >= 1 and 0.0 <= self.forget <= 1.0):
            raise InvalidInput(
                where, f"hold {self.hold!r}, forget {self.forget!r}",
                "a whole number of samples, a factor between 0 and 1", "Use InputCheck.over_time.",
            )  # fmt: skip

    @classmethod
    def over_time(
        cls,
        input: str,
        limit: float,
        dt: float,
        keep: bool = False,
        alone: bool = False,
        hold: float = HOLD,
        memory: float = MEMORY,
    ) -> InputCheck:
        """The check with its times in s, for the sample time ``dt`` (s)."""
        return cls(input, limit, max(1, round(hold / dt)), math.exp(-dt / memory), keep, alone)

    @classmethod
    def when_missing(cls, input: str) -> InputCheck:
        """The check that replaces missing samples alone."""
        return cls(input, limit=1e30, hold=1, forget=0.0, missing_only=True)

    def start(self) -> list[float]:
        """Its memory at the start (``kernels.law.input_check``), when every finite sample is accepted."""
        if self.missing_only:
            return []
        return [0.0, 0.0, 0.0, 0.0, 2.0 * self.hold, 0.0, 0.0, 0.0]

    def to_dict(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_dict(cls, data: object, where: str = "InputCheck.from_dict") -> InputCheck:
        """The check that ``to_dict`` wrote; raises ``InvalidInput`` for anything else."""
        content = table(where, data, {field.name for field in fields(cls)})
        flags = {name: flag(f"{where}, {name}", content[name]) for name in ("keep", "alone", "missing_only")}
        name, hold = text(f"{where}, input", content["input"]), whole(f"{where}, hold", content["hold"])
        return cls(name, content["limit"], hold, content["forget"], **flags)
