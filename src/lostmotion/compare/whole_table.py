"""Keeps the table of all entries and cases in a folder: hours of work, not replaced by a part of it unasked."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path
from typing import Any

from ..errors import InvalidInput
from ..io.storage.json_files import read_json
from ..plain_data import mapping
from .score_table import ScoreTable


def keep_whole_table(
    folder: Path, new: ScoreTable[Any], subject: str, entries: Collection[str], cases: Collection[str]
) -> None:
    """Raise if the folder contains a whole table that would lose entries, cases, rigs or length.

    Whole is a table of all entries and cases of a comparison, quick or not. A part of one may be replaced: its scores
    stay. Entries and cases that the package no longer has are ignored.

    Parameters
    ----------
    folder : Path
    new : ScoreTable
        Its scores may still be missing.
    subject : str
        "observers" or "controllers": the key of the entries.
    entries, cases : collection of str
        Names that the package has.

    Raises
    ------
    InvalidInput
    """
    try:
        old = read_json(folder / "leaderboard.json", "leaderboard")
        settings = mapping("settings", old["settings"])
        old_entries, old_cases = ({row["name"] for row in old[what]} for what in (subject, "cases"))
        longer = settings.get("duration", 0.0) > new.settings.get("duration", 0.0)
        lost = {
            subject: len(old_entries & set(entries) - set(new.entries)),
            "cases": len(old_cases & set(cases) - {case.name for case in new.cases}),
            "rigs": len(set(old["seeds"]) - set(new.seeds)),
        }
    except (InvalidInput, KeyError, TypeError):
        return  # no table, or not of this package
    if settings.get("part"):
        return
    words = [f"{count} of its {what}" for what, count in lost.items() if count]
    words += ["its longer recordings"] if longer else []
    if words:
        raise InvalidInput(
            str(folder / "leaderboard.json"),
            f"a table that would lose {', '.join(words)}",
            "a folder without a larger table",
            "Choose another folder (--out), or replace the table with --force.",
        )
