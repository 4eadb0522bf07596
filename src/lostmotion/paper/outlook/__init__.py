"""What the paper leaves open (section VI), answered: a paragraph, a figure or numbers, and a page to read on."""

from __future__ import annotations

from collections.abc import Iterator

from ..experiments import Experiments, Identified
from .answer import Answer
from .controllers import controllers
from .covariances import from_data
from .observers import other_observers
from .oscillation import oscillation
from .robustness import robustness
from .stability import stability


def answers(e: Experiments, identified: Identified, quick: bool) -> Iterator[Answer]:
    """One after the other, in the order of the paper's outlook."""
    yield stability(quick)
    yield robustness(e)
    yield controllers(e, identified)
    yield oscillation(e)
    yield from_data(e, identified)
    yield other_observers(e, identified)


__all__ = ["Answer", "answers"]
