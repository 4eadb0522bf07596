"""Names of cases, observers and controllers as typed on a keyboard: ASCII for − and ∞, any case."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from difflib import get_close_matches

from ..errors import InvalidInput

_ASCII = str.maketrans({"−": "-", "–": "-", "∞": "infinity"})


def plain(name: str) -> str:
    """A name in lower case, with ASCII for − and ∞, without blanks."""
    return "".join(name.translate(_ASCII).casefold().split())


def known_names(subject: str, what: str, given: Sequence[str], known: Sequence[str]) -> list[str]:
    """The names as in the list of known ones, for a comparison of ``subject``.

    Raises
    ------
    InvalidInput
        For unknown names, with the nearest known one; and for none.
    """
    expected = f"a list of names of {what}"
    listed = f"`lostmotion compare {subject} --list` lists all names."
    if isinstance(given, str) or not isinstance(given, Collection) or not given:
        raise InvalidInput(f"compare_{subject}.{what}", repr(given), expected, listed)
    spelled = {plain(name): name for name in known}
    for name in given:
        word = plain(name) if isinstance(name, str) else ""
        if word not in spelled:
            near = [repr(spelled[found]) for found in get_close_matches(word, spelled)]
            meant = f"Did you mean {' or '.join(near)}? " if near else ""
            raise InvalidInput(f"compare_{subject}.{what}", repr(name), expected, meant + listed)
    return [spelled[plain(name)] for name in given]
