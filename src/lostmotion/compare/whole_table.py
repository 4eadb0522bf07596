"""Keeps the table of all observers and cases in a folder: hours of work, not replaced by a part of it unasked."""

from __future__ import annotations

from pathlib import Path

from ..errors import InvalidInput
from ..io.storage.json_files import read_json
from .cases import CASES
from .contestants import CONTESTANTS
from .leaderboard import Leaderboard


def keep_whole_table(folder: Path, new: Leaderboard) -> None:
    """Raise if the folder contains a whole table that would lose observers, cases, rigs or length.

    Whole is a table of all observers and cases of a comparison, quick or not. A part of one may be replaced: its scores
    stay. Observers and cases that the package no longer has are ignored.

    Parameters
    ----------
    folder : Path
    new : Leaderboard
        Its scores may still be missing.

    Raises
    ------
    InvalidInput
    """
    try:
        old = read_json(folder / "leaderboard.json", "leaderboard")
        settings = old["settings"]
        observers, cases = ({row["name"] for row in old[what]} for what in ("observers", "cases"))
        longer = settings["duration"] > new.settings["duration"]
        lost = {
            "observers": len(observers & {entry.name for entry in CONTESTANTS} - set(new.observers)),
            "cases": len(cases & {case.name for case in CASES} - {case.name for case in new.cases}),
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
