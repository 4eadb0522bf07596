"""One folder with claims, figures and one page, whole or not at all; nothing of somebody else's is replaced."""

from __future__ import annotations

import importlib
import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

import lostmotion as lm
from lostmotion.paper.claims import gains, modes
from lostmotion.paper.experiments import Experiments
from lostmotion.paper.figures import structure
from lostmotion.paper.outlook import Answer
from lostmotion.paper.reproduce import reproduce
from lostmotion.paper.reproduction import Reproduction

#: The module: the room has a function of the same name.
module = importlib.import_module("lostmotion.paper.reproduce")


@pytest.fixture
def short(experiments: Experiments, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two groups of claims, one figure, one answer: what takes long is tested for itself."""
    monkeypatch.setattr(module, "perform", lambda quick, progress: experiments)
    monkeypatch.setattr(module, "identify_rig", lambda rig, progress: None)
    monkeypatch.setattr(module, "GROUPS", {"Modes": modes.claims, "Gains": gains.claims})
    monkeypatch.setattr(module, "FIGURES", (structure.reduction,))
    monkeypatch.setattr(module, "DRAWINGS", ())
    monkeypatch.setattr(module, "table_1", lambda e, identified: [])
    answer = Answer("Why <so>?", "Because φ_e is not φ_w.", "stability.md", {"one": 1.0})
    monkeypatch.setattr(module, "answers", lambda e, identified, quick: [answer])


def test_a_page_a_json_and_the_figures(short: None, tmp_path: Path) -> None:
    seen: list[tuple[str, float]] = []
    found = reproduce(
        tmp_path / "out", quick=True, progress=lambda stage, share, text="": seen.append((stage, share))
    )
    written = json.loads((tmp_path / "out" / "claims.json").read_text())
    assert written["kind"] == "claims" and written["claims"] == json.loads(json.dumps(found["claims"]))
    assert found["headline"] == "11 of 11 claims hold." and found["count"]["of"] == 11
    assert sorted(p.name for p in (tmp_path / "out" / "figures").iterdir()) == [
        "figure-04.pdf", "figure-04.png", "figure-04.svg",
    ]  # fmt: skip
    for stage in ("record", "identify", "claims", "outlook", "draw"):
        shares = [share for name, share in seen if name == stage]
        assert shares[0] == 0.0 and shares[-1] == 1.0 and shares == sorted(shares)


def test_the_page_needs_nothing_else_and_shows_every_claim(short: None, tmp_path: Path) -> None:
    found = reproduce(tmp_path / "out", quick=True)
    page = (tmp_path / "out" / "paper.html").read_text()
    assert not re.findall(r"""(?:src|href)=["'](?!data:|#)""", page) and "<script" not in page
    assert "Why &lt;so&gt;?" in page and "φ<sub>e</sub>" in page
    for claim in found["claims"]:
        assert claim["name"][1:].replace("'", "&#39;") in page


def test_somebody_elses_file_stops_it_before_anything_is_computed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "perform", lambda quick, progress: pytest.fail("computed"))
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(lm.InvalidInput, match=r"mine\.txt"):
        reproduce(tmp_path, quick=True)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]


def test_a_second_run_replaces_the_first_with_the_same(short: None, tmp_path: Path) -> None:
    def content() -> dict[str, bytes]:
        return {
            p.relative_to(tmp_path).as_posix(): p.read_bytes() for p in tmp_path.rglob("*") if p.is_file()
        }

    reproduce(tmp_path / "out", quick=True)
    first = content()
    reproduce(tmp_path / "out", quick=True)
    assert content() == first


def test_counts_and_headline_tell_what_does_not_hold(experiments: Experiments) -> None:
    one, *others = modes.claims(experiments)
    claims = {
        "Modes": [replace(one, verdict="partly"), replace(others[0], verdict="does not hold"), *others[1:]]
    }
    found = Reproduction(claims, [], [], "", [], True)
    assert found.headline() == "2 of 4 claims hold, 1 partly, 1 not."
