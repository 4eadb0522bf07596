"""Errors and problems: what went wrong, where, what was got, what was expected, and what to do."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from typing import Any, Literal

Severity = Literal["error", "warning"]

#: What is quoted from a file or a name is cut to so many characters (option: half a screen).
LONGEST = 1000


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

    def __post_init__(self) -> None:
        for part in ("where", "got"):
            object.__setattr__(self, part, _presentable(getattr(self, part)))

    @classmethod
    def error(cls, where: str, got: str, expected: str, remedy: str) -> Problem:
        return cls("error", where, got, expected, remedy)

    @classmethod
    def warning(cls, where: str, got: str, expected: str, remedy: str) -> Problem:
        return cls("warning", where, got, expected, remedy)

    def __str__(self) -> str:
        return f"{self.where}: got {self.got}, expected {self.expected}. {self.remedy}"

    def as_dict(self) -> dict[str, Any]:
        return asdict(self)


def _presentable(text: str) -> str:
    """At most `LONGEST` characters, all of which a terminal can show: what a file holds may be anything."""
    if len(text) > LONGEST:
        text = f"{text[: LONGEST // 2]} … {text[-LONGEST // 2 :]}"
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c == "\n" else ascii(c)[1:-1] for c in text)


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


@contextmanager
def within(place: str) -> Iterator[None]:
    """Puts the place, a file, before that of an ``InvalidInput`` that its content raises."""
    try:
        yield
    except InvalidInput as error:
        p = error.problem
        raise InvalidInput(f"{place}, {p.where}", p.got, p.expected, p.remedy) from None
