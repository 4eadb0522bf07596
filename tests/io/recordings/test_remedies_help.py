"""Remedies of a recording's file help: a test meets a problem, does what its remedy says, and the problem is gone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from lostmotion.errors import InputProblems, LostMotionError, Problem
from lostmotion.io import read_recording
from lostmotion.io.recordings.checks import check_identifiable

ROWS, DT = 6000, 1e-3
TIME = DT * np.arange(ROWS)
TORQUE = 3.0 * np.sin(2.0 * np.pi * 0.7 * TIME) + np.random.default_rng(1).normal(size=ROWS)
SPEED = np.cumsum(TORQUE) * DT / 0.1
AS_IT_IS = {
    "time": {"column": "t", "unit": "s"},
    "channels": {
        "torque_motor": {"column": "u", "unit": "Nm"},
        "speed_motor": {"column": "w", "unit": "rad/s"},
    },
}


def told(folder: Path, columns: dict[str, Any], keys: dict[str, Any]) -> tuple[Problem, ...]:
    """What reading a CSV of these columns with these keys of a [[recording]] tells, errors and warnings."""
    table = np.column_stack(list(columns.values()))
    with (folder / "log.csv").open("w") as file:
        np.savetxt(file, table, delimiter=",", header=",".join(columns), comments="", fmt="%.12g")
    try:
        recording = read_recording(folder / "log.csv", **keys)
    except InputProblems as error:
        return error.problems
    except LostMotionError as error:
        return (error.problem,)  # type: ignore[attr-defined]
    return (*recording.meta["problems"], *check_identifiable(recording))


def changed(**channel: Any) -> dict[str, Any]:
    """The keys with another channel for the torque."""
    torque = {**AS_IT_IS["channels"]["torque_motor"], **channel}
    return {**AS_IT_IS, "channels": {**AS_IT_IS["channels"], "torque_motor": torque}}


def spiked(value: float, rows: slice) -> np.ndarray:
    values = SPEED.copy()
    values[rows] = value
    return values


def gap() -> np.ndarray:
    return np.where(np.arange(ROWS) < ROWS // 2, TIME, TIME + 0.5)


LATE = {**AS_IT_IS, "window": (3.5, 6.0)}

#: What the file holds, the keys that meet the problem, words of its remedy, the file or the keys that follow it.
CASES = {
    "sign": ({"u": -TORQUE}, AS_IT_IS, "Set sign = -1 for torque_motor", changed(sign=-1)),
    "current": ({}, changed(unit="A"), "Add scale in Nm per A", changed(unit="A", scale=1.0)),
    "time in ms": ({"t": 1e3 * TIME}, AS_IT_IS, 'unit = "ms"', {**AS_IT_IS, "time": {"column": "t", "unit": "ms"}}),
    "time in ns": ({"t": 1e9 * TIME}, AS_IT_IS, 'unit = "ns"', {**AS_IT_IS, "time": {"column": "t", "unit": "ns"}}),
    "time goes back": (
        {"t": TIME[::-1]}, AS_IT_IS, "time = { sample_time = ... }", {**AS_IT_IS, "time": {"sample_time": DT}},
    ),
    "a gap, resampled": ({"t": gap()}, AS_IT_IS, 'Ask for resample = "1 ms"', {**AS_IT_IS, "resample": "1 ms"}),
    "a gap, window": ({"t": gap()}, AS_IT_IS, "choose a window without gaps", LATE),
    "no number": ({"w": spiked(np.nan, slice(9, 12))}, AS_IT_IS, "Give a window without them", LATE),
    "a lost bit": ({"w": spiked(900.0, slice(800, 801))}, AS_IT_IS, "by window = [...]", LATE),
    "a stuck speed": ({"w": spiked(0.7, slice(0, 3100))}, AS_IT_IS, "by window = [...]", LATE),
    "too large": ({"w": spiked(1e40, slice(3, 4))}, AS_IT_IS, "give a window without these rows", LATE),
    "too short": (
        {}, {**AS_IT_IS, "window": (1.0, 1.3)}, "widen the window", {**AS_IT_IS, "window": (1.0, 4.0)},
    ),
    "no torque": (
        {},
        {**AS_IT_IS, "channels": {"speed_motor": AS_IT_IS["channels"]["speed_motor"]}},
        "channels.torque_motor",
        AS_IT_IS,
    ),
    "swapped": (
        {"u": SPEED, "w": TORQUE},
        AS_IT_IS,
        "exchange them in channels",
        {
            **AS_IT_IS,
            "channels": {
                "torque_motor": {"column": "w", "unit": "Nm"},
                "speed_motor": {"column": "u", "unit": "rad/s"},
            },
        },
    ),
    "sample time beside a time": (
        {"time": TIME},
        {**AS_IT_IS, "time": {"sample_time": 0.005}},
        "Leave time out",
        {"channels": AS_IT_IS["channels"]},
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_a_remedy_helps(tmp_path: Path, case: str) -> None:
    columns, keys, words, helped = CASES[case]
    data = {"t": TIME, "u": TORQUE, "w": SPEED} | columns
    met = told(tmp_path, data, keys)
    assert [p for p in met if words in p.remedy], [p.remedy for p in met]
    left = told(tmp_path, data, helped)
    assert not [p for p in left if words in p.remedy or p.severity == "error"], left


def test_without_a_fault_nothing_is_told(tmp_path: Path) -> None:
    assert told(tmp_path, {"t": TIME, "u": TORQUE, "w": SPEED}, AS_IT_IS) == ()
