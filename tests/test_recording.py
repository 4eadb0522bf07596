"""Recording: copied read-only signals on one time axis."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import lostmotion as lm
from lostmotion.events import Event
from lostmotion.recording import Recording, unit_of

TIME = np.arange(10) * 0.1


def recording() -> Recording:
    return Recording(
        time=TIME,
        signals={"speed_motor": np.arange(10.0), "torque_motor": np.ones(10)},
        origin={"speed_motor": "simulated"},
        events=(Event(0.25, "impact", "shaft 1", 1.0), Event(0.75, "separation", "shaft 1", 1.0)),
        final_state={"state": (1.0,)},
        meta={"seed": 3},
    )


def test_arrays_that_nobody_can_write_are_taken_as_they_are():
    """A part of a writable array is copied, for it can change."""
    own = np.arange(10.0)
    own.setflags(write=False)
    assert Recording(TIME, {"speed_motor": own})["speed_motor"] is own
    base = np.zeros((10, 2))
    part = base[:, 0]
    part.setflags(write=False)
    made = Recording(TIME, {"speed_motor": part})
    base[0, 0] = 99.0
    assert made["speed_motor"][0] == 0.0
    assert made.only("speed_motor")["speed_motor"] is made["speed_motor"]


def test_arrays_are_copied_and_read_only():
    values = np.arange(10.0)
    made = Recording(TIME, {"speed_motor": values})
    values[0] = 99.0
    assert made["speed_motor"][0] == 0.0
    with pytest.raises(ValueError, match="read-only"):
        made["speed_motor"][0] = 1.0
    with pytest.raises(TypeError):
        made.signals["speed_motor"] = values  # type: ignore[index]


def test_window_keeps_rows_and_events_inside():
    part = recording().window(0.2, 0.5)
    np.testing.assert_allclose(part.time, [0.2, 0.3, 0.4])
    np.testing.assert_array_equal(part["speed_motor"], [2.0, 3.0, 4.0])
    assert [e.kind for e in part.events] == ["impact"]
    assert not part.final_state
    assert part.meta["seed"] == 3
    with pytest.raises(lm.InvalidInput, match="window"):
        recording().window(5.0, 6.0)


def test_signals_added_and_withheld():
    more = recording().with_signals("estimated", twist_estimated=np.zeros(10))
    assert more.origin["twist_estimated"] == "estimated"
    assert "twist_estimated" in more and len(more) == 10
    less = more.only("speed_motor")
    assert less.names == ("speed_motor",)
    assert list(less) == ["speed_motor"]
    assert set(less.origin) == {"speed_motor"}
    assert less.events == () and not less.final_state and not less.meta


def test_what_is_withheld_takes_its_meta_along():
    meta = {
        "speed_from_counts": True,
        "averaged": ["speed_motor", "speed_load"],
        "speed_load": "mean over the sample, from angle_load",
        "speed_motor": "mean over the sample, from angle_motor",
        "rig_seed": 7,
        "file": "rig.npz",
        "sha256": "0",
        "law": "pi",
    }
    signals = {"speed_motor": np.ones(10), "speed_load": np.ones(10)}
    less = Recording(TIME, signals, meta=meta).only("speed_motor")
    assert dict(less.meta) == {
        "speed_from_counts": True,
        "averaged": ("speed_motor",),
        "speed_motor": "mean over the sample, from angle_motor",
    }


def test_the_repr_is_a_few_lines_with_units_and_origin_and_no_numbers():
    shown = replace(recording(), origin={"speed_motor": "simulated"}).with_signals(
        "derived", slip=np.zeros(10)
    )
    assert repr(shown).splitlines() == [
        "Recording: 10 samples of 100 ms, 0.9 s, 2 events",
        "  simulated: speed_motor (rad/s)",
        "  measured: torque_motor (Nm)",
        "  derived: slip",
    ]
    many = {f"a_signal_with_a_long_name_{i}": np.zeros(10) for i in range(12)}
    lines = repr(Recording(TIME, many)).splitlines()
    assert len(lines) == 5 and max(map(len, lines)) <= 100


def test_html_shows_the_range_of_each_signal_and_escapes_names():
    gaps = np.where(TIME < 0.5, np.nan, TIME)
    shown = Recording(TIME, {"speed_motor": gaps, "<b>": np.full(10, np.nan)})._repr_html_()
    assert "rad/s" in shown and ">0.500<" in shown and ">0.900<" in shown
    assert "&lt;b&gt;" in shown and "<b><" not in shown and ">–<" in shown


def test_sample_time_is_the_mean_step():
    assert recording().dt == pytest.approx(0.1, rel=1e-14)


def test_units_by_name():
    assert unit_of("speed_load_estimated") == "rad/s"
    assert unit_of("speed_reference") == "rad/s"
    assert unit_of("unheard_of") == ""


@pytest.mark.parametrize(
    "make",
    [
        lambda: Recording(TIME[::-1], {}),
        lambda: Recording(np.zeros(4), {}),
        lambda: Recording(np.array([0.0]), {}),
        lambda: Recording(TIME, {"speed_motor": np.zeros(9)}),
        lambda: recording()["speed_load"],
    ],
)
def test_misuse_is_refused(make):
    with pytest.raises(lm.InvalidInput):
        make()


def test_bounces_merge_into_one_impact():
    times = [0.1, 0.101, 0.1025, 0.2, 0.2005]
    events = [
        Event(t, "impact", "shaft 1", s, abs(s))
        for t, s in zip(times, [1.0, -3.0, 2.0, 1.0, 0.5], strict=True)
    ]
    events.insert(1, Event(0.1005, "impact", "shaft 2", 9.0, 9.0))
    events.insert(2, Event(0.1006, "separation", "shaft 1", 1.0))
    made = Recording(TIME, {}, events=tuple(events))
    merged = made.impacts()
    assert [(e.time, e.place, e.speed, e.energy) for e in merged] == [
        (0.1, "shaft 1", -3.0, 6.0),
        (0.1005, "shaft 2", 9.0, 9.0),
        (0.2, "shaft 1", 1.0, 1.5),
    ]
    assert len(made.impacts(merge=0.0)) == 6


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("twist_1", "rad"),
        ("torque_shaft_12", "Nm"),
        ("speed_2", "rad/s"),
        ("torque_3", "Nm"),
        ("speed", ""),
        ("x_1", ""),
    ],
)
def test_units_of_a_chains_numbered_signals(name, unit):
    assert unit_of(name) == unit


def test_the_first_time_that_does_not_increase_is_named():
    with pytest.raises(lm.InvalidInput, match=r"got 0\.1 s after 0\.2 s in row 2"):
        Recording(np.array([0.0, 0.2, 0.1]), {})
    with pytest.raises(lm.InvalidInput, match=r"got nan s after 0\.0 s in row 1"):
        Recording(np.array([0.0, np.nan, 0.1]), {})


def test_a_slice_is_no_signal():
    with pytest.raises(lm.InvalidInput, match="no such signal"):
        recording()[1:3]
