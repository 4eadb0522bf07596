"""Broken at words for a terminal; as it is for a file."""

from __future__ import annotations

import io

import pytest

from lostmotion.display.wrapping import wrapped

SENTENCE = "  warning: identification: prediction errors with a peak at 762 Hz. A further inertia or shaft."


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("width", [40, 80])
def test_a_terminal_gets_whole_words_within_its_width(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    monkeypatch.setenv("COLUMNS", str(width))
    lines = wrapped(f"{SENTENCE}\n  short", Terminal()).split("\n")
    assert len(lines) > 2 and all(len(line) <= width for line in lines)
    assert " ".join(line.strip() for line in lines) == f"{SENTENCE.strip()} short"
    assert lines[1].startswith("      ") and lines[-1] == "  short"


def test_a_path_stays_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "20")
    path = "a-long-folder/with-another/report.html"
    assert path in wrapped(f"  report: {path}", Terminal()).split()


@pytest.mark.parametrize("stream", [io.StringIO(), None])
def test_what_is_no_terminal_gets_the_line_as_it_is(stream: io.StringIO | None) -> None:
    assert wrapped(SENTENCE, stream) == SENTENCE
