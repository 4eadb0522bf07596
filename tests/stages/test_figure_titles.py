"""The report's figures: what their titles say."""

from __future__ import annotations

from types import SimpleNamespace

from lostmotion.stages.figures import ring_down_title, stability_figure


def test_a_title_has_no_more_digits_than_its_interval_bears_out() -> None:
    intervals = {"frequency": (27.98, 28.61), "damping_ratio": (0.0296, 0.0499)}
    values = {"frequency": 28.283, "damping_ratio": 0.03957}
    ringing = SimpleNamespace(values=values, intervals=intervals)
    shown = ring_down_title(ringing).replace("\u00a0", " ")
    assert shown == "Ring-down: 28.3 Hz, damping ratio 0.040"


def test_what_is_not_proved_is_no_figure() -> None:
    assert stability_figure({"proved": False, "headline": "Stability is not proved"}) == []
    assert stability_figure({"skipped": "no law"}) == []
