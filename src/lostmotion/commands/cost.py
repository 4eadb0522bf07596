"""What a command will cost, said before it begins, and refused where it is absurd."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..errors import InvalidInput
from ..memory import check_memory, size_text

#: A command that takes longer than this, s, says so before it begins; one that takes longer than that is refused
#: (option: ten seconds, a day).
WORTH_SAYING, LONGEST = 10.0, 86400.0

#: Called with a sentence for the user.
Announce = Callable[[str], None]


def silent(sentence: str) -> None:
    """Nothing is said."""


@dataclass(frozen=True)
class Cost:
    """Of simulated samples: ``memory`` in bytes and ``seconds`` of one core for each."""

    samples: float
    memory: float
    seconds: float

    def check(self, where: str, announce: Announce = silent) -> None:
        """Announces what it takes if that is much; raises ``InvalidInput`` beyond memory limit and a day."""
        what = f"{self.samples:.3g} samples"
        memory, seconds = self.samples * self.memory, self.samples * self.seconds
        remedy = "Take fewer: a shorter duration, or a longer dt."
        check_memory(where, what, memory, remedy)
        if seconds > LONGEST:
            raise InvalidInput(
                where, f"{what}, which take about {_time(seconds)}", f"at most {_time(LONGEST)}", remedy
            )
        if seconds > WORTH_SAYING:
            announce(f"{what}: about {_time(seconds)} and {size_text(memory)} of memory")


def _time(seconds: float) -> str:
    for name, unit in (("years", 365.25 * 86400.0), ("days", 86400.0), ("hours", 3600.0), ("minutes", 60.0)):
        if seconds >= 2.0 * unit:
            return f"{seconds / unit:.3g} {name}"
    return f"{seconds:.3g} s"
