"""One word for one thing: replaced words do not come back in docs, comments and messages."""

from __future__ import annotations

import io
import re
import tokenize
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "src" / "lostmotion"

#: Replaced words (a regular expression) and what to say instead.
REPLACED = {
    r"\btold\b": "given, reported, identified",
    r"\bpieces?\b": "segment (of a recording), sub-step (of a sample), intermediate inertia, interval",
    r"\bladders?\b": "constant speeds, gain schedule",
    r"\btouch(es|ed)?\b": "contact",
    r"\bbeliev\w+|\bdoubt\w*": "accepted, rejected, uncertain",
    r"\bof late\b(?!\[)": "recent",
    r"\bforetold\b": "predicted",
    r"\bwander\w*": "drift, random walk",
    r"\bhold(s|ing)? the truth\b|\bheld in %": "contains the truth, coverage",
    r"\bmore than chance\b": "beyond its 95 % noise level",
    r"\bcounts? less\b|\bpulls? (little|the estimate)\b": "is down-weighted, influence",
    r"\bkinship\b": "same topology",
    r"\bnobody\b": "not given",
    r"\bHz mode\b": "eigenmode",
}
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
#: Not read: the names of the draws decide the drives of the zoo, and these parts of the second estimator.
UNREAD = [
    PACKAGE / "rig" / "zoo" / "drive.py",
    *(PACKAGE / "kernels" / "innovations" / f"{name}.py" for name in ("contact_switching", "transitions")),
    *(
        PACKAGE / "identification" / "prediction_error" / "contact_switching" / f"{name}.py"
        for name in ("agreement", "estimate", "filter", "likelihood")
    ),
]
SOURCES = [
    *(path for path in sorted(PACKAGE.rglob("*.py")) if path not in UNREAD),
    *sorted((ROOT / "benchmarks").glob("*.py")),
]


def prose_of_page(path: Path) -> str:
    """The page without code."""
    text = re.sub(r"^```.*?^```", "", path.read_text(), flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"`[^`]*`|^    .*$", "", text, flags=re.MULTILINE)


def prose_of_source(path: Path) -> str:
    """Comments, docstrings and messages, without names in backticks."""
    tokens = tokenize.generate_tokens(io.StringIO(path.read_text()).readline)
    prose = [t.string for t in tokens if t.type in (tokenize.COMMENT, tokenize.STRING) and " " in t.string]
    return re.sub(r"``[^`]*``", "", "\n".join(prose))


def replaced_words(prose: str) -> list[str]:
    return [
        f"{found[0]!r}: say {better}"
        for word, better in REPLACED.items()
        for found in re.finditer(word, prose, re.I)
    ]


@pytest.mark.parametrize("page", PAGES, ids=lambda p: str(p.relative_to(ROOT)))
def test_pages(page: Path) -> None:
    assert replaced_words(prose_of_page(page)) == []


@pytest.mark.parametrize("source", SOURCES, ids=lambda p: str(p.relative_to(ROOT)))
def test_sources(source: Path) -> None:
    assert replaced_words(prose_of_source(source)) == []


def test_a_replaced_word_is_found() -> None:
    assert replaced_words("A touch of late, and what the observer is told.")
    assert not replaced_words("`joint_piece` counts, and piecewise-linear curves")
