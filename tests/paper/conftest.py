"""The paper's experiments, done once for all tests of this folder."""

from __future__ import annotations

import pytest

from lostmotion.paper.experiments import Experiments, perform


@pytest.fixture(scope="session")
def experiments() -> Experiments:
    return perform(quick=True)
