"""The largest share of the gap's slope: the values of the method's prototype, and the search for κ."""

from __future__ import annotations

import numpy as np
import pytest
from table_i import PAPER

from lostmotion.certificates import best_injection, observer_share
from lostmotion.certificates.observer.error_bound import error_model
from lostmotion.errors import InvalidInput

BOTH = ("torque_shaft", "speed_motor")
RIGID_DAMPER = PAPER.with_contact("dead_zone")


@pytest.mark.parametrize(
    "measured, coulomb, injection, share",
    [
        (("speed_motor",), 2.0, {}, 0.4666),
        (("speed_motor",), 0.0, {}, 0.891),
        (("speed_motor",), 0.0, {"speed_motor": 1.43e-3}, 0.9625),
        (BOTH, 2.0, {}, 0.7707),
        (BOTH, 2.0, {"torque_shaft": 1.39e-4}, 1.0),
    ],
)
def test_the_paper_s_observers(measured, coulomb, injection, share):
    plant = RIGID_DAMPER.with_parameters(coulomb=coulomb)
    assert observer_share(plant, measured, injection=injection) == pytest.approx(share, abs=1.2e-3)


@pytest.mark.parametrize("gain", [[[0.5, -1.24], [54.66, -396.13], [-6.62, 93.5]],
                                  [[0.48, -0.72], [-25.57, -113.2], [1.38, 150.79]]])  # fmt: skip
def test_it_ends_below_the_share_from_which_a_linear_gap_is_unstable(gain):
    plant = RIGID_DAMPER.with_parameters(coulomb=0.0)
    model = error_model(plant, BOTH, gain)
    gap = model.differences[0]
    slopes = np.linspace(0.0, 1.0, 1001)
    stable = [
        np.max(np.linalg.eigvals(model.A + s * np.outer(gap.effect, gap.row)).real) < 0.0 for s in slopes
    ]
    limit = slopes[np.argmin(stable)]
    assert 0.9 * limit < observer_share(plant, BOTH, gain=gain) <= limit


def test_an_unstable_observer_has_none():
    assert observer_share(PAPER, gain=[[0.0], [-50.0], [0.0]]) == 0.0


def test_the_search_finds_the_window():
    """With the torque sensor nearly the whole slope; the window of κ is narrow."""
    found = best_injection(RIGID_DAMPER, BOTH, signal="torque_shaft", largest=1.55e-4)
    assert found.factor == pytest.approx(1.39e-4, rel=0.02)
    assert found.without == pytest.approx(0.7707, abs=1e-3) and found.share > 0.9999


def test_misuse():
    with pytest.raises(InvalidInput, match="a gap"):
        observer_share(PAPER.with_parameters(backlash=0.0))
