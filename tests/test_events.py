"""Events as columns: equal to a tuple of events, made when looked at."""

from __future__ import annotations

import pickle

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.events import NO_EVENTS, Event, Events

ROWS = (
    Event(0.1, "impact", "shaft 1", -2.0, 0.5),
    Event(0.2, "stick", "friction 2", 0.0),
    Event(0.3, "separation", "shaft 1", 1.0),
)


def test_they_are_a_sequence_of_events():
    events = Events.of(ROWS)
    assert len(events) == 3 and tuple(events) == ROWS and events == ROWS
    assert events[0] == ROWS[0] and events[-1] == ROWS[-1] and events[1:] == ROWS[1:]
    assert ROWS[1] in events and events.index(ROWS[2]) == 2
    assert NO_EVENTS == () and events != ROWS[:2]
    assert Events.of(events) is events and hash(events) == hash(ROWS)
    with pytest.raises(IndexError):
        events[3]


def test_numbers_are_plain_floats():
    assert [type(value) for value in Events.of(ROWS)[0]] == [float, str, str, float, float]
    assert [type(value) for value in next(iter(Events.of(ROWS)))] == [float, str, str, float, float]


def test_kinds_are_found_without_making_objects():
    events = Events.of(ROWS)
    assert events.of_kind("impact") == ROWS[:1] and events.count_of("slip") == 0
    assert events.only(events.time > 0.15) == ROWS[1:]
    np.testing.assert_array_equal(events.time, [0.1, 0.2, 0.3])
    with pytest.raises(ValueError, match="read-only"):
        events.time[0] = 1.0


@pytest.mark.parametrize("kind", ["bump", 3, None, ["impact"]])
def test_an_unknown_kind_is_refused(kind):
    with pytest.raises(lm.InvalidInput, match="one of impact, separation"):
        Events.of([Event(0.1, kind, "shaft 1", 0.0)])
    with pytest.raises(lm.InvalidInput, match=r"Event\.kind"):
        Events.of(ROWS).of_kind(kind)


def test_they_survive_pickling():
    assert pickle.loads(pickle.dumps(Events.of(ROWS))) == ROWS


def test_those_of_a_simulation_are_made_at_the_first_look():
    """Also those of a recording that went through another process before anyone looked."""
    plant = lm.Drivetrain.two_mass(inertia_motor=1.0, inertia_load=1.0, stiffness=1e3, backlash=0.01)
    events = lm.simulate(plant, torque_motor=np.ones(100), dt=1e-2).events
    assert "time" not in vars(events)
    sent = pickle.loads(pickle.dumps(events))
    assert len(events) > 2 and "time" in vars(events)
    assert sent == events and events[0].kind == "impact"
    with pytest.raises(AttributeError):
        events.colour  # noqa: B018
