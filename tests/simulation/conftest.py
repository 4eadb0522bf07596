"""Plants that several tests of the simulation share."""

from __future__ import annotations

import pytest
from table_i import TABLE_I

from lostmotion import Drivetrain


@pytest.fixture
def paper() -> Drivetrain:
    """Table I of Fietzek & Rinderknecht under the paper's own law."""
    return Drivetrain.two_mass(**TABLE_I, contact="dead_zone")
