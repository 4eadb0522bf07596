"""README and docs: their code runs, links lead somewhere, tables and pages stay short, the commands are named."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
#: Pages for users: a benchmark's own page may be as long and wide as its tables, and a reference of keys is looked up.
SHORT_PAGES = [p for p in PAGES if p.parent.name != "benchmarks" and p.name != "configuration.md"]
LONGEST_PAGE, WIDEST_TABLE = 150, 120
BLOCK = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)


def name(page: Path) -> str:
    return str(page.relative_to(ROOT))


#: The tutorial's blocks need its commands between them: ``test_tutorial``.
EXECUTED = [p for p in PAGES if BLOCK.search(p.read_text()) and p.name != "tutorial.md"]


@pytest.mark.parametrize("page", EXECUTED, ids=name)
def test_code_blocks_run(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All blocks of a page in turn, in one namespace and an empty folder."""
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, Any] = {}
    for number, block in enumerate(BLOCK.findall(page.read_text())):
        exec(compile(block, f"{page.name}, block {number + 1}", "exec"), namespace)


def test_api_example_closes_the_loop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    namespace: dict[str, Any] = {}
    exec(BLOCK.findall((ROOT / "README.md").read_text())[0], namespace)
    assert abs(namespace["loop"]["speed_load"][-1] - 2.0) < 0.02
    assert (tmp_path / "out" / "drive_law.c").exists()


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_links_lead_somewhere(page: Path) -> None:
    for target, anchor in re.findall(r"\]\(([^)#]*)#?([^)]*)\)", page.read_text()):
        if target.startswith("http"):
            continue
        goal = page.parent / target if target else page
        assert goal.exists(), target
        assert not anchor or anchor in anchors(goal), f"{target}#{anchor}"


def anchors(page: Path) -> set[str]:
    """Of the headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", page.read_text(), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("page", SHORT_PAGES, ids=name)
def test_a_page_is_short_and_its_tables_fit_on_a_screen(page: Path) -> None:
    lines = page.read_text().splitlines()
    assert len(lines) <= LONGEST_PAGE
    assert [line for line in lines if line.startswith("|") and len(line) > WIDEST_TABLE] == []


def test_readme_names_both_commands() -> None:
    text = (ROOT / "README.md").read_text()
    assert ".venv/bin/pip install . && .venv/bin/lostmotion run" in text
    assert '.venv/bin/pip install ".[test]" && .venv/bin/pytest' in text
    assert '.venv/bin/pip install --quiet ".[test]" && .venv/bin/pytest' in (ROOT / ".ci" / "run").read_text()


@pytest.mark.parametrize("page", PAGES, ids=name)
def test_files_that_are_named_exist_and_no_place_is_left_open(page: Path) -> None:
    text = page.read_text()
    for named in re.findall(r"(?:^|[ `(])((?:src|tests|benchmarks|docs|examples)/[\w./-]+\.\w+)", text):
        assert (ROOT / named).exists() or (page.parent / named).exists(), named
    assert not re.findall(r"^[A-Z]+_[A-Z_]+$", text, re.MULTILINE)
