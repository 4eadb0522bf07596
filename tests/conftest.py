"""Shared by all tests: where real data lies, and one finished run of the main job."""

from __future__ import annotations

import os
import signal
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings

from lostmotion.child_process import use_one_blas_thread

ROOT = Path(__file__).resolve().parent.parent

# A shell that runs the tests in the background lets them ignore Ctrl-C or the end of
# its terminal, and so would the commands that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)
if hasattr(signal, "SIGHUP"):
    signal.signal(signal.SIGHUP, signal.SIG_DFL)

# As the command does: two workers with two threads each on two cores take a fifth longer.
use_one_blas_thread()

# How long an example takes to make says something about a busy machine, nothing about the code.
settings.register_profile("any machine", suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("any machine")


@pytest.fixture(scope="session")
def measured_data() -> Path:
    """Folder of the real measurements (LOSTMOTION_DATA, default ../shared/data); skips where it is missing."""
    folder = Path(os.environ.get("LOSTMOTION_DATA", ROOT.parent / "shared" / "data"))
    if not (folder / "aalto").is_dir():
        pytest.skip(f"no measured data in {folder}: set LOSTMOTION_DATA")
    return folder


@pytest.fixture
def fit_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Rehearsals of an excitation with the fit alone: limits, files and what is said of them are the same."""
    import lostmotion as lm

    monkeypatch.setattr("lostmotion.experiment.design.identify", partial(lm.identify, second_estimator=False))


@pytest.fixture
def short_search(monkeypatch: pytest.MonkeyPatch) -> None:
    """A search of the second estimator that ends early: for tests of what is made of its result."""
    room = "lostmotion.identification.prediction_error.contact_switching"
    monkeypatch.setattr(f"{room}.search.room.LONG", 5_000_000)
    monkeypatch.setattr(f"{room}.search.final_fits.STEPS", 8_000)
    monkeypatch.setattr(f"{room}.starts.grid.RATIOS", (0.1, 0.5, 2.0, 10.0))
    monkeypatch.setattr(f"{room}.starts.grid.POLES", (0.5, 1.0, 2.0))
    monkeypatch.setattr(f"{room}.starts.grid.BACKLASHES", (0.1, 3.0))


@pytest.fixture(scope="session")
def finished_run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, Any]]:
    """Output folder and results of the main job on the virtual rig, seed 1."""
    from lostmotion.run import run

    out = tmp_path_factory.mktemp("main_job") / "out"
    return out, run(out=out)
