"""One short experiment on the virtual rig for the tests of the steppers."""

from __future__ import annotations

import pytest
from rig_runs import Experiment, rig_experiment


@pytest.fixture(scope="session")
def experiment() -> Experiment:
    """3 s of the default excitation (reverses the shaft torque some 50 times per second) on rig 1 at 0.1 ms."""
    return rig_experiment(1, 3.0)
