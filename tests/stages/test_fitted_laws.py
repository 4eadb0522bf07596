"""Default laws suit drives of other sizes: two of those of ``benchmarks/fitted_laws.py``, on seeds of their own.

Their drives are identified within seconds; of others the search for further inertias takes a minute.
"""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

from lostmotion.stages.design import design
from lostmotion.stages.parameters import find_parameters

PLACE = Path(__file__).resolve().parents[2] / "benchmarks" / "fitted_laws.py"


@pytest.fixture(scope="module")
def benchmark() -> ModuleType:
    spec = importlib.util.spec_from_file_location("fitted_laws", PLACE)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules["fitted_laws"] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    module.ROWS = 20_000  # half of the benchmark's recordings
    return module


@pytest.mark.parametrize("seed", [2003, 2005])
def test_a_drive_of_another_size_gets_laws_that_suit_it(benchmark: ModuleType, seed: int) -> None:
    drive = benchmark.user_drive(seed)
    material = benchmark.material_of(drive)
    laws = design(material, find_parameters(material))
    for name in benchmark.LAWS:
        metrics, _ = benchmark.judged(drive, laws, name)
        assert benchmark.passes(metrics, drive.torque_limit), (name, metrics)
