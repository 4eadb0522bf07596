"""Names of cases and observers as a keyboard has them: without −, ∞, or the right case."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from difflib import get_close_matches

from ..errors import InvalidInput

_ASCII = str.maketrans({"−": "-", "–": "-", "∞": "infinity"})


def plain(name: str) -> str:
    """What two spellings of one name have in common: letters in lower case, ASCII for − and ∞, no blanks."""
    return "".join(name.translate(_ASCII).casefold().split())


def known_names(what: str, given: Sequence[str], known: Sequence[str]) -> list[str]:
    """The names as the list of the known has them.

    Raises
    ------
    InvalidInput
        For names that are not in it, with the nearest one that is; and for none.
    """
    expected = f"a list of names of {what}"
    listed = "`lostmotion compare observers --list` lists all names."
    if isinstance(given, str) or not isinstance(given, Collection) or not given:
        raise InvalidInput(f"compare_observers.{what}", repr(given), expected, listed)
    spelled = {plain(name): name for name in known}
    for name in given:
        word = plain(name) if isinstance(name, str) else ""
        if word not in spelled:
            near = [repr(spelled[found]) for found in get_close_matches(word, spelled)]
            meant = f"Did you mean {' or '.join(near)}? " if near else ""
            raise InvalidInput(f"compare_observers.{what}", repr(name), expected, meant + listed)
    return [spelled[plain(name)] for name in given]
