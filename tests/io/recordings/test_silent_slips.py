"""Slips in a user's own log that once passed without a word: each is told, with a remedy; the sound log is not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from slow_axis import AXIS

import lostmotion as lm
from lostmotion.io import find_problems

#: Sample time (s) and rows of a slow axis, 16 bit; torque held for 36 ms under a speed control.
DT, ROWS = 1e-3, 12_000
Columns = dict[str, np.ndarray]


def recorded() -> Columns:
    """Time (s), motor torque (Nm), speeds of motor and load (rpm)."""
    rng = np.random.default_rng(1)
    wanted = np.repeat(1.5 * np.array([1.0, -0.5, 0.5, -1.0, 0.3, -0.7]), ROWS // 6)
    random = np.repeat(rng.choice([-1.0, -0.5, 0.5, 1.0], ROWS // 36 + 1), 36)[:ROWS] * 135.0
    control = lm.controllers.pi(kp=60.0, ki=30.0, dt=DT, torque_limit=300.0)
    pushed = lm.simulate(AXIS, law=control, speed_reference=wanted + random / 60.0, dt=DT, state=(0, 0, 0))
    turn = 2.0 * np.pi
    counts = np.floor(pushed["angle_motor"] / turn * 2**20)
    return {
        "t_s": pushed.time,
        "M": pushed["torque_motor"],
        "n": 60.0 * np.diff(counts, prepend=0.0) / 2**20 / DT,
        "n_load": pushed["speed_load"] * 30.0 / np.pi,
    }


AS_IT_IS = recorded()
NAMEPLATE = "[nameplate]\ninertia_motor = 2.5\ninertia_load = 40\nstiffness = 2e4\nbacklash = 0.003\n"
RECORDING = """[[recording]]
file = "log.csv"
time = { column = "t_s" }
channels.torque_motor = { column = "M", unit = "Nm" }
channels.speed_motor = { column = "n", unit = "rpm" }
channels.speed_load = { column = "n_load", unit = "rpm" }
"""
NO_LOAD = RECORDING.rpartition("channels")[0]


def told(folder: Path, columns: Columns, toml: str = NAMEPLATE + RECORDING) -> list[str]:
    with (folder / "log.csv").open("w") as file:
        np.savetxt(
            file, np.column_stack([*columns.values()]), "%.16g", ",", header=",".join(columns), comments=""
        )
    (folder / "rig.toml").write_text(toml)
    return [str(problem) for problem in find_problems(folder / "rig.toml")]


def times(column: str, factor: float) -> Callable[[Columns], Columns]:
    return lambda c: {**c, column: factor * c[column]}


def put(column: str, rows: slice, value: float) -> Callable[[Columns], Columns]:
    def change(columns: Columns) -> Columns:
        values = columns[column].copy()
        values[rows] = value
        return {**columns, column: values}

    return change


def each(column: str, rows: int, held: bool) -> Callable[[Columns], Columns]:
    """A column that was sampled in every so many rows."""

    def change(columns: Columns) -> Columns:
        values = columns[column]
        between = (
            np.repeat(values[::rows], rows)
            if held
            else np.interp(range(ROWS), range(0, ROWS, rows), values[::rows])
        )
        return {**columns, column: between}

    return change


def same(columns: Columns) -> Columns:
    return columns


#: Name: the change of the columns, the TOML, what is said, what the remedy names.
SLIPS: dict[str, tuple[Callable[[Columns], Columns], str, str, str]] = {
    "sign": (times("M", -1.0), NO_LOAD, "opposite sign", "sign = -1"),
    "sign of both speeds": (lambda c: {**c, "n": -c["n"], "n_load": -c["n_load"]}, RECORDING, "opposite sign", "sign"),
    "rpm as rad/s": (same, NO_LOAD.replace('"rpm"', '"rad/s"'), "an acceleration as of", "unit and scale"),
    "current as torque": (times("M", 20.0), NO_LOAD, "an acceleration as of", "unit and scale"),
    "swapped": (lambda c: {**c, "M": c["n"], "n": c["M"]}, NO_LOAD, "changes follow the speed", "exchange them"),
    "another run": (lambda c: {**c, "M": np.roll(c["M"], 500)}, NO_LOAD, "does not follow the torque", "one recording"),
    "magnitude": (lambda c: {**c, "n": np.abs(c["n"])}, NO_LOAD, "does not follow the torque", "its sign"),
    "held": (each("n", 4, True), NO_LOAD, "changes only once in 4 rows", 'resample = "4 ms"'),
    "set-point": (each("n", 200, True), NO_LOAD, "changes only once in 200 rows", "log faster"),
    "interpolated": (each("n", 5, False), NO_LOAD, "changes its slope only once in 5 rows", 'resample = "5 ms"'),
    "lost packets": (put("n_load", slice(4500, 4550), 0.0), RECORDING, "then 0 in 50 rows", "window = [...]"),
    "few levels": (lambda c: {**c, "n": 5.0 * np.round(c["n"] / 5.0)}, NO_LOAD, "of only", "channels.angle_motor"),
    "offset": (lambda c: {**c, "n_load": c["n_load"] + 3.0}, RECORDING, "less or more than the motor", "offset"),
    "exchanged": (lambda c: {**c, "n": c["n_load"], "n_load": c["n"]}, RECORDING, "answers the motor", "exchange"),
    "limit in kNm": (same, NO_LOAD + "[law]\ntorque_limit = 0.3\n", "0.3 Nm", "Check the unit"),
    "ms as s": (same, NO_LOAD + "[law]\nsample_time = 1\n", "law.sample_time: got 1 s", "0.001"),
    "us as s": (same, NO_LOAD + '[law]\nsample_time = "1 us"\n', "law.sample_time", "1 ms"),
    "slow poles": (same, NO_LOAD + "[law]\npoles = [-1e-3, -1e-3, -1e-3]\n", "0.001 1/s", "leave them out"),
    "gain": (same, NO_LOAD + "[law]\nkp = 1e6\nki = 1e6\n", "1e+06 Nm s/rad", "leave kp and ki out"),
    "days": (lambda c: {**c, "t_s": 45413.5 + c["t_s"] / 86400.0}, NO_LOAD, "as a spreadsheet counts", 'unit = "d"'),
    "us": (times("t_s", 1e6), NO_LOAD, "a sample time of 1000 s", 'unit = "us"'),
    "minutes": (times("t_s", 1.0 / 60.0), NO_LOAD, "0.2 s", 'unit = "min"'),
    "two sample times": (same, NO_LOAD.replace('column = "t_s"', 'sample_time = "1.1 ms"'), "the same steps", "Leave"),
}  # fmt: skip


def test_the_sound_log_is_not_told_of(tmp_path: Path) -> None:
    assert told(tmp_path, AS_IT_IS) == []
    law = '[law]\ntorque_limit = 300\nsample_time = "2 ms"\nkp = 60\nki = 30\npoles = [-20, -20, -20]\n'
    assert told(tmp_path, AS_IT_IS, NAMEPLATE + NO_LOAD + law) == []


@pytest.mark.parametrize("slip", SLIPS)
def test_a_slip_is_told(tmp_path: Path, slip: str) -> None:
    change, toml, words, remedy = SLIPS[slip]
    found = told(tmp_path, change(AS_IT_IS), NAMEPLATE + toml)
    assert any(words in problem and remedy in problem for problem in found), found


@pytest.mark.parametrize(("slip", "unit"), [("days", "d"), ("us", "us"), ("minutes", "min")])
def test_the_unit_of_the_time_is_the_remedy(tmp_path: Path, slip: str, unit: str) -> None:
    helped = (NAMEPLATE + NO_LOAD).replace('"t_s" }', f'"t_s", unit = "{unit}" }}')
    found = told(tmp_path, SLIPS[slip][0](AS_IT_IS), helped)
    assert found == []


@pytest.mark.parametrize("slip", ["held", "interpolated"])
def test_resampling_is_the_remedy(tmp_path: Path, slip: str) -> None:
    step = {"held": 4, "interpolated": 5}[slip]
    helped = (NAMEPLATE + NO_LOAD).replace("time =", f'resample = "{step} ms"\ntime =')
    (asked,) = told(tmp_path, SLIPS[slip][0](AS_IT_IS), helped)
    assert "as asked for" in asked


def test_two_decimal_signs_in_one_column(tmp_path: Path) -> None:
    """1.234 among decimal commas may be a thousand; a column of its own with a point is none."""
    rows = [";".join(f"{v:.3f}" for v in row) for row in zip(*AS_IT_IS.values(), strict=True)][:1500]
    comma = [row.replace(".", ",") for row in rows]
    mixed = [one if i % 2 else other for i, (one, other) in enumerate(zip(rows, comma, strict=True))]
    toml = NAMEPLATE + NO_LOAD
    for lines, words in (
        (comma, None),
        (mixed, "one decimal sign"),
        ([f"{r.partition(';')[0]};{c.partition(';')[2]}" for r, c in zip(rows, comma, strict=True)], None),
    ):
        (tmp_path / "log.csv").write_text("\n".join([";".join(AS_IT_IS), *lines]))
        (tmp_path / "rig.toml").write_text(toml)
        errors = [str(p) for p in find_problems(tmp_path / "rig.toml") if p.severity == "error"]
        assert all(words is not None and words in error for error in errors) and bool(errors) == bool(words)


def test_an_exponent_that_no_number_has_is_shown(tmp_path: Path) -> None:
    rows = [
        ",".join(f"{v:.5e}".replace("e", "D") for v in row) for row in zip(*AS_IT_IS.values(), strict=True)
    ]
    (tmp_path / "log.csv").write_text("\n".join([",".join(AS_IT_IS), *rows[:200]]))
    (tmp_path / "rig.toml").write_text(NAMEPLATE + NO_LOAD)
    (problem,) = find_problems(tmp_path / "rig.toml")
    assert "D+00" in problem.got and "the exponent" in problem.remedy
