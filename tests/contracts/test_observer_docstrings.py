"""What the docstring of every observer must have: what it raises, and where it comes from."""

from __future__ import annotations

import inspect

import pytest

from lostmotion import observers

#: Beside the observers: a result, and a number for their arguments.
OTHERS = ("Covariances", "speed_of_counts")
FUNCTIONS = [getattr(observers, name) for name in observers.__all__ if name not in OTHERS]


@pytest.mark.parametrize("make", FUNCTIONS, ids=lambda make: make.__name__)
@pytest.mark.parametrize("section", ["Returns", "Raises", "Notes"])
def test_every_observer_says_what_it_raises_and_its_source(make, section):
    lines = inspect.getdoc(make).splitlines()
    assert section in lines
    assert lines[lines.index(section) + 1] == "-" * len(section)
