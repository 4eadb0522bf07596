"""Errors and problems: what went wrong, where, what was got, what was expected, and what to do."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import asdict, dataclass
from typing import Any, Literal

Severity = Literal["error", "warning"]


@dataclass(frozen=True)
class Problem:
    """One finding about an input or a result, in the form in which it is shown to the user.

    Parameters
    ----------
    severity : {"error", "warning"}
        An error stops the work; a warning goes into the report and the work goes on.
    where : str
        The place: a file and channel, an argument, a parameter.
    got, expected : str
        What was found there, and what was expected instead.
    remedy : str
        What the user can do about it.
    """

    severity: Severity
    where: str
    got: str
    expected: str
    remedy: str

    def __str__(self) -> str:
        return f"{self.where}: got {self.got}, expected {self.expected}. {self.remedy}"

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


class LostMotionError(Exception):
    """Base of all errors that the package raises on purpose."""


class InvalidInput(LostMotionError, ValueError):
    """Misuse of a function: raised at once, with where, got, expected and remedy.

    Examples
    --------
    >>> raise InvalidInput("inertia_motor", "-0.1 kg m2", "a positive number", "Check the sign and the unit.")
    Traceback (most recent call last):
    lostmotion.errors.InvalidInput: inertia_motor: got -0.1 kg m2, ...
    """

    def __init__(self, where: str, got: str, expected: str, remedy: str) -> None:
        self.problem = Problem("error", where, got, expected, remedy)
        super().__init__(str(self.problem))

    def __reduce__(self) -> tuple[Any, ...]:
        p = self.problem  # what another process raised comes back by its arguments
        return type(self), (p.where, p.got, p.expected, p.remedy)


class InputProblems(LostMotionError):
    """All problems of a file or configuration, collected and raised together."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__("\n".join(f"{p.severity}: {p}" for p in self.problems))

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self.problems,)
