"""Several recordings, and gaps in them."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from lagged_drive import DT, PLANT, speed_from_counts

import lostmotion as lm
from lostmotion.identification import Identification
from lostmotion.identification.prediction_error.segments import Pieces, join

COUNT = 2.0 * np.pi / 2**20


@cache
def recorded(seed: int, duration: float = 3.0) -> lm.Recording:
    torque = lm.signals.excitation(duration, DT, seed=seed, inertia=0.1292, coulomb=2.0, viscous=0.0175)
    run = lm.simulate(PLANT, torque_motor=torque, dt=DT)
    speed = speed_from_counts(run, COUNT)
    return run.only("torque_motor").with_signals("measured", speed_motor=speed)


@cache
def whole() -> Identification:
    return lm.identify(recorded(1), start=PLANT)


def without_rows(recording: lm.Recording, rows: slice) -> lm.Recording:
    keep = np.ones(len(recording), dtype=bool)
    keep[rows] = False
    return lm.Recording(
        time=recording.time[keep], signals={n: recording[n][keep] for n in recording}, meta=recording.meta
    )


def with_nan(recording: lm.Recording, rows: slice) -> lm.Recording:
    speed = recording["speed_motor"].copy()
    speed[rows] = np.nan
    return recording.with_signals("measured", speed_motor=speed)


def errors(found: Identification) -> dict[str, float]:
    return {n: abs(found.values[n] / getattr(PLANT, n) - 1.0) for n in found.names}


def test_a_gap_of_nan_and_missing_rows_are_the_same():
    rows = slice(11000, 14000)
    nan, missing = (
        lm.identify(change(recorded(1), rows), start=PLANT) for change in (with_nan, without_rows)
    )
    assert nan.values == pytest.approx(missing.values, rel=1e-9)
    assert nan.prediction.time.size == missing.prediction.time.size == 27000
    assert all(low <= getattr(PLANT, n) <= high for n, (low, high) in nan.intervals.items())
    (problem,) = [p for p in nan.problems if p.where == "recording"]
    assert "2 segments" in problem.got and "0.3 s left out" in problem.got
    assert not [p for p in whole().problems if p.where == "recording"]


def test_the_observer_starts_anew_after_a_gap():
    """Taken as if there were no gap, the jump in the motion would stand in the innovations."""
    gap = without_rows(recorded(1), slice(11000, 14000))
    found = lm.identify(gap, start=PLANT)
    glued = lm.Recording(time=np.arange(len(gap)) * DT, signals=gap.signals, meta=gap.meta)
    assert found.prediction.rms == pytest.approx(whole().prediction.rms, rel=0.03)
    without = lm.identify(
        glued, start=PLANT, second_estimator=False
    )  # the second estimator looks for a cause
    assert without.prediction.rms > 1.05 * found.prediction.rms


def test_several_recordings_tell_more_than_one():
    together = lm.identify([recorded(1), recorded(2), recorded(3)], start=PLANT)
    assert together.prediction.time.size == 90000
    assert np.all(np.diff(together.prediction.time) > 0.5 * DT)
    for name in ("coulomb", "viscous"):
        low, high = whole().intervals[name]
        low_3, high_3 = together.intervals[name]
        assert high_3 - low_3 < 0.8 * (high - low), name
    assert max(e for n, e in errors(together).items() if n not in ("viscous", "lag")) < 0.005
    assert not [p for p in together.problems if p.where == "recording"]


def test_one_recording_in_a_list_is_that_recording():
    assert lm.identify([recorded(1)], start=PLANT).values == whole().values


def test_what_one_recording_does_not_excite_another_tells():
    """The twist touches one side only: the cost is flat above the smallest gap with room for it."""
    torque = 4.0 + lm.signals.noise(5.0, 120.0, 0.6, 3.0, DT, seed=3)
    run = lm.simulate(PLANT, torque_motor=torque, dt=DT, state=(0.0066, 10.0, 10.0))
    one_sided = run.only("torque_motor", "speed_motor")
    alone = lm.identify(one_sided, start=PLANT, speed_from_counts=False)
    assert alone.values["backlash"] is None
    both = lm.identify([one_sided, recorded(1)], start=PLANT)
    assert both.values["backlash"] == pytest.approx(0.012, rel=0.01)


def test_short_pieces_are_left_out():
    speed = recorded(1)["speed_motor"].copy()
    speed[[5000, 9000]] = np.nan
    pieces = join([recorded(1).with_signals("measured", speed_motor=speed)], ("torque_motor", "speed_motor"))
    assert pieces.bounds == (0, 20999)
    assert pieces.left_out == pytest.approx(0.9001)
    assert pieces.dt == pytest.approx(DT, rel=1e-9)


def test_misuse_is_told():
    with pytest.raises(lm.InvalidInput, match="at least one"):
        lm.identify([], start=PLANT)
    slower = lm.Recording(time=recorded(2).time * 2.0, signals=recorded(2).signals)
    with pytest.raises(lm.InvalidInput, match="one sample time"):
        lm.identify([recorded(1), slower], start=PLANT)
    speed = recorded(1)["speed_motor"].copy()
    speed[::1000] = np.nan
    with pytest.raises(lm.InvalidInput, match="without a gap"):
        lm.identify(recorded(1).with_signals("measured", speed_motor=speed), start=PLANT)
    with pytest.raises(lm.InvalidInput, match="NaN throughout"):
        lm.identify(with_nan(recorded(1), slice(None)), start=PLANT)


def test_rows_are_joined_so_that_means_stay_means():
    """The torque acts from its row on, a count-averaged speed is the mean up to its row; the rest of a piece is cut."""
    time = 0.001 * np.arange(7)
    signals = {"torque_motor": np.arange(7.0), "speed_motor": np.array([5.0, 1.0, 3.0, 2.0, 4.0, 6.0, 9.0])}
    joined = Pieces(time, signals, (0, 4, 7), 0.001, 0.0, 1).joined(2)
    assert joined.bounds == (0, 2, 3) and joined.dt == 0.002
    assert joined.time.tolist() == [0.0, 0.002, 0.004]
    assert joined.signals["torque_motor"].tolist() == [0.5, 2.5, 4.5]
    assert joined.signals["speed_motor"].tolist() == [5.0, 2.0, 4.0]
