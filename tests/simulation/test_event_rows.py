"""Events from the rows of the kernel: what enters and leaves a contact at once is none, listed or counted."""

from __future__ import annotations

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.drivetrain import CONTACT_LAWS, Drivetrain, Friction, Shaft
from lostmotion.events import KINDS
from lostmotion.kernels.batch.summary import count_events
from lostmotion.simulation.contact_states import GAP, PLUS, elements
from lostmotion.simulation.event_rows import KernelEvents

#: One shaft with backlash, and friction at the load.
PLANT = Drivetrain((0.02, 0.1), (Shaft(6e3, 0.4, 0.012),), (Friction(), Friction(2.0)))
ELEMENTS = elements(PLANT)
LOAD = len(ELEMENTS) - 1
SHAFT, REST = 0, ELEMENTS[LOAD].rest
LATER = np.nextafter(759.6, np.inf)


def rows(*changes: tuple[float, int, int, int]) -> np.ndarray:
    """Time in samples, element, old and new digit; speed 1 rad/s."""
    return np.array([(*change, 1.0) for change in changes])


def listed(given: np.ndarray) -> list[str]:
    return [event.kind for event in KernelEvents(given, PLANT, ELEMENTS, 1e-4)]


def counted(given: np.ndarray) -> list[int]:
    kind = np.array([{"shaft": 0, "friction": 1}[e.kind] for e in ELEMENTS])
    rest, counts = np.array([e.rest for e in ELEMENTS]), np.zeros(4)
    count_events.py_func(given, len(given), 0, kind, rest, np.full(4, -1.0), counts)
    return counts.astype(int).tolist()


@pytest.mark.parametrize("second", [759.6, LATER])
@pytest.mark.parametrize("third", [759.6, LATER])
def test_of_three_changes_at_once_one_stands(second, third):
    """The torque of the physical law is zero at its separation: rounding may undo it once, and tell the time anew."""
    given = rows(
        (759.6, SHAFT, PLUS, GAP), (second, SHAFT, GAP, PLUS), (max(second, third), SHAFT, PLUS, GAP)
    )
    assert listed(given) == ["separation"]
    assert counted(given) == [0, 1, 0, 0]


def test_a_speed_that_passes_through_rest_does_not_stick():
    given = rows((5.5, LOAD, REST + 1, REST), (5.5, LOAD, REST, REST - 1), (9.0, LOAD, REST - 1, REST))
    assert listed(given) == ["stick"]
    assert counted(given) == [0, 0, 1, 0]


def test_four_changes_at_once_are_none_and_later_ones_stand():
    chatter = [(7.0, SHAFT, *((PLUS, GAP), (GAP, PLUS))[i % 2]) for i in range(4)]
    given = rows(*chatter, (8.0, SHAFT, PLUS, GAP), (9.0, SHAFT, GAP, PLUS))
    assert listed(given) == ["separation", "impact"]
    assert counted(given) == [1, 1, 0, 0]


@pytest.mark.parametrize("contact", CONTACT_LAWS)
def test_impacts_and_separations_of_a_shaft_alternate(contact):
    shafts = (Shaft(6e3, 0.4, 0.012, contact), Shaft(2e4, 0.2, 0.004, contact))
    plant = Drivetrain((0.02, 0.03, 0.1), shafts, (Friction(0.5), Friction(), Friction(1.0)))
    torque = 10.0 * np.random.default_rng(0).standard_normal(4000)
    events = lm.simulate(plant, dt=1e-4, torque_motor=torque, state=np.zeros(5)).events
    for place in ("shaft 1", "shaft 2"):
        kinds = [event.kind for event in events if event.place == place]
        assert len(kinds) > 10
        assert kinds == [KINDS[i % 2] for i in range(len(kinds))]
