"""What commands say reaches the right stream, and a progress display makes room for it."""

from __future__ import annotations

import io
import sys

import pytest
from rich.console import Console
from rich.live import Live

from lostmotion.cli.messages import say
from lostmotion.terminal import Countdown, StageLines


def test_a_message_goes_to_its_stream_without_colour_for_a_file(capsys: pytest.CaptureFixture[str]) -> None:
    say("result")
    say("warning", fg="yellow", err=True)
    assert capsys.readouterr() == ("result\n", "warning\n")


def test_a_display_that_is_on_makes_room_for_a_message() -> None:
    """The bar's line is cleared first; past the display the words would stand behind it."""
    shown = Console(file=io.StringIO(), force_terminal=True, width=60)
    with Live("a bar", console=shown, auto_refresh=False):
        say("1e+04 samples: about 16 s", err=True)
    assert "\x1b[2K1e+04 samples" in shown.file.getvalue()  # type: ignore[attr-defined]


@pytest.mark.parametrize("width", [40, 80])
def test_a_narrow_terminal_shows_the_whole_time(monkeypatch: pytest.MonkeyPatch, width: int) -> None:
    class Terminal(io.StringIO):
        def isatty(self) -> bool:
            return True

    stream = Terminal()
    monkeypatch.setattr(sys, "stderr", stream)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", str(width))
    with StageLines() as lines:
        lines("identify", 0.4, "fitting with a high gain, 1 of 2")
    with Countdown("compiling kernels, once") as bar:
        bar(3, 7, 20.0)
    text = stream.getvalue()
    assert "0:00:00" in text and "3/7" in text
    assert ("fitting with a high gain, 1 of 2" in text) == (width == 80)
