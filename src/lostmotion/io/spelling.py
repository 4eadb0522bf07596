"""Names in messages: the known one that was probably meant, and lists that stay short."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

#: Longest name that is compared with others, characters (option): the time of it grows with the square.
_LONGEST = 200


def split_unit(text: str) -> tuple[str, str]:
    """``"Speed [rpm]"`` → ``("Speed", "rpm")``; round brackets count too; without brackets the unit is ""."""
    text = text.strip()
    if text.endswith(("]", ")")):
        opening = max(text.rfind("["), text.rfind("("))
        inside = text[opening + 1 : -1]
        if opening >= 0 and not set(inside) & set("])"):
            return text[:opening].strip(), inside.strip()
    return text, ""


def suggestion(key: str, known: Iterable[str]) -> str:
    """The remedy for a misspelt name: the names closest to it."""
    by_lower_case: dict[str, str] = {}
    if len(key) > _LONGEST:
        return "Check the name against the list."
    for name in known:
        by_lower_case.setdefault(name.lower(), name)
        by_lower_case.setdefault(split_unit(name)[0].lower(), name)
    close = difflib.get_close_matches(key.lower(), by_lower_case, n=3)
    names = list(dict.fromkeys(by_lower_case[c] for c in close))
    if names:
        return "Did you mean " + " or ".join(repr(n) for n in names) + "?"
    return "Check the name against the list."


def short_list(items: Iterable[object], limit: int = 12) -> str:
    """Items separated by commas, cut after a dozen."""
    texts = [text if len(text) <= _LONGEST else text[:_LONGEST] + "…" for text in map(str, items)]
    more = f", … ({len(texts)} in all)" if len(texts) > limit else ""
    return ", ".join(texts[:limit]) + more
