"""read_recording: formats of text tables, units, windows, resampling, derived speeds, every kind of error."""

from __future__ import annotations

import math
import time as clock
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lostmotion.errors import InputProblems, InvalidInput, Problem
from lostmotion.io.recordings.read import read_recording
from lostmotion.io.storage.recording_files import save_recording
from lostmotion.recording import Recording

ROWS = 200
TIME = 0.001 * np.arange(ROWS)
SPEED = np.sin(40 * TIME) * 500.0  # rpm
TORQUE = np.cos(40 * TIME) * 3.0
RPM = 2 * math.pi / 60

Problems = Callable[[Callable[[], object]], tuple[Problem, ...]]


def lines(separator: str = ",", comma: bool = False, columns: tuple[np.ndarray, ...] = ()) -> list[str]:
    rows = [
        separator.join(repr(float(v)) for v in row)
        for row in zip(*(columns or (TIME, SPEED, TORQUE)), strict=True)
    ]
    return [row.replace(".", ",") for row in rows] if comma else rows


def write(folder: Path, text: str | list[str], name: str = "rig.csv", encoding: str = "utf-8") -> Path:
    path = folder / name
    path.write_bytes(("\n".join(text) + "\n" if isinstance(text, list) else text).encode(encoding))
    return path


NUMBERED = {"speed_motor": {"column": 1, "unit": "rpm"}, "torque_motor": {"column": 2, "unit": "Nm"}}
NAMED = {"speed_motor": "Speed", "torque_motor": {"column": "Torque", "sign": -1}}


def check(recording: Recording, sign: int = 1) -> None:
    np.testing.assert_array_equal(recording.time, TIME)
    np.testing.assert_allclose(recording["speed_motor"], SPEED * RPM, rtol=1e-15)
    np.testing.assert_array_equal(recording["torque_motor"], sign * TORQUE)


@pytest.mark.parametrize(
    ("header", "channel", "contradicts"),
    [
        ("Speed [rpm]", {"unit": "rad/s"}, True),
        ("Speed [rpm]", {"unit": "U/min"}, False),
        ("Speed [rpm]", {}, False),
        ("Speed [raw]", {"unit": "rad/s"}, False),
        ("Speed [counts/s]", {"unit": "rad/s"}, True),
        ("Speed [V]", {"unit": "rad/s", "scale": 10.0}, False),  # the scale says how
        ("Speed [rpm]", {"unit": "rad/s", "scale": 1}, False),
    ],
)
def test_a_header_that_says_another_unit_is_refused(
    tmp_path: Path, header: str, channel: dict[str, object], contradicts: bool
) -> None:
    path = write(tmp_path, [f"Time [s],{header},Torque [Nm]", *lines()])
    channels = {"speed_motor": {"column": 1, **channel}, "torque_motor": {"column": 2, "unit": "Nm"}}
    if not contradicts:
        assert np.ptp(read_recording(path, channels=channels)["speed_motor"]) > 0.0
        return
    with pytest.raises(InputProblems, match=r"unit 'rad/s' for a column whose header says.*scale = 1"):
        read_recording(path, channels=channels)


@pytest.mark.parametrize(
    ("separator", "comma"),
    [(",", False), (";", False), (";", True), ("\t", False), ("\t", True), ("  ", False), (" ", True)],
)
def test_separators_and_decimal_signs(tmp_path: Path, separator: str, comma: bool) -> None:
    bare = write(tmp_path, lines(separator, comma))
    check(read_recording(bare, time={"column": 0, "unit": "s"}, channels=NUMBERED))
    if separator.strip(" "):
        header = separator.join(["Time [s]", "Speed [rpm]", "Torque [Nm]"])
        check(read_recording(write(tmp_path, [header, *lines(separator, comma)]), channels=NAMED), sign=-1)


def test_preamble_comments_blank_lines_byte_order_mark_and_trailing_separator(tmp_path: Path) -> None:
    text = [
        "# rig 7",
        "Export of a logger",
        "",
        "Time;Speed;Torque;",
        "% a remark",
        *(f"{r};" for r in lines(";")),
    ]
    text.insert(20, "")
    text.insert(21, "// paused")
    path = write(tmp_path, "\r\n".join(text), encoding="utf-8-sig")
    recording = read_recording(path, channels={**NAMED, "speed_motor": {"column": "Speed", "unit": "U/min"}})
    check(recording, sign=-1)


def test_byte_order_mark_before_the_names_and_a_remark_below_them(tmp_path: Path) -> None:
    path = write(
        tmp_path, ["Time;Speed [rpm];Torque", "recorded on rig 7", *lines(";")], encoding="utf-8-sig"
    )
    check(read_recording(path, channels=NAMED), sign=-1)


def test_quoted_numbers(tmp_path: Path) -> None:
    quoted = [",".join(f'"{field}"' for field in line.split(",")) for line in lines()]
    path = write(tmp_path, ['"Time","Speed [rpm]","Torque, filtered"', *quoted])
    channels = {"speed_motor": "Speed", "torque_motor": "Torque, filtered"}
    check(read_recording(path, channels=channels))


def test_unit_row_below_the_names_quotes_and_utf16(tmp_path: Path) -> None:
    path = write(
        tmp_path,
        ['"Time","Speed","Torque"', '"ms","1/min","mNm"', *lines(columns=(TIME * 1e3, SPEED, TORQUE * 1e3))],
        encoding="utf-16",
    )
    recording = read_recording(path, channels=NAMED)
    np.testing.assert_allclose(recording.time, TIME, rtol=1e-14)
    np.testing.assert_allclose(recording["speed_motor"], SPEED * RPM, rtol=1e-14)
    np.testing.assert_allclose(recording["torque_motor"], -TORQUE, rtol=1e-14)


def test_windows_1252_header_with_micro_and_degree(tmp_path: Path) -> None:
    path = write(
        tmp_path, ["Time (µs);Angle (°)", *lines(";", columns=(TIME * 1e6, SPEED))], encoding="cp1252"
    )
    recording = read_recording(path, time="Time", channels={"angle_motor": "Angle"})
    np.testing.assert_allclose(recording["angle_motor"], np.deg2rad(SPEED)[1:], rtol=1e-14)
    assert recording.dt == pytest.approx(1e-3)


def test_signals_and_time_are_found_by_their_own_names(tmp_path: Path) -> None:
    recording = read_recording(write(tmp_path, ["time,speed_motor [rpm],torque_motor", *lines()]))
    check(recording)
    assert dict(recording.origin) == {"speed_motor": "measured", "torque_motor": "measured"}


def test_scale_offset_and_sign_make_a_torque_of_a_current(tmp_path: Path) -> None:
    path = write(tmp_path, ["t,n [rpm],Iq [A]", *lines()])
    spec = {"column": "Iq [A]", "scale": 1.9, "offset": 0.5, "sign": -1}
    expected = -(1.9 * TORQUE + 0.5)
    for unit in ("Nm", ""):
        found = read_recording(path, channels={"speed_motor": "n", "torque_motor": {**spec, "unit": unit}})
        np.testing.assert_allclose(found["torque_motor"], expected, rtol=1e-14)
    in_milliampere = {"column": 2, "unit": "mA", "scale": 1.9}
    found = read_recording(path, channels={"torque_motor": in_milliampere})
    np.testing.assert_allclose(found["torque_motor"], 1.9e-3 * TORQUE, rtol=1e-14)


def test_a_current_without_torque_constant_and_a_wrong_dimension_are_refused(
    tmp_path: Path, problems_of: Problems
) -> None:
    path = write(tmp_path, ["t,n [rpm],Iq [A]", *lines()])
    current, wrong = problems_of(
        lambda: read_recording(
            path, channels={"torque_motor": "Iq", "speed_motor": {"column": "n", "unit": "Nm"}}
        )
    )
    assert "Nm per A" in current.remedy and "unit 'A'" in current.got
    assert wrong.expected == "a unit of rad/s"


def test_speed_is_derived_from_counts_as_a_mean_over_the_sample(tmp_path: Path) -> None:
    counts = np.round(4096 / (2 * math.pi) * 30 * TIME**2 * 1000)
    path = write(tmp_path, lines(columns=(TIME, counts, TORQUE)))
    recording = read_recording(
        path,
        time=0,
        channels={
            "angle_motor": {"column": 1, "unit": "counts", "counts_per_rev": 4096, "sign": -1},
            "torque_motor": 2,
        },
    )
    np.testing.assert_array_equal(recording.time, TIME[1:])
    np.testing.assert_allclose(
        recording["speed_motor"], -np.diff(counts) * 2 * math.pi / 4096 / np.diff(TIME), rtol=1e-12
    )
    np.testing.assert_array_equal(recording["torque_motor"], TORQUE[1:])
    assert recording.origin["speed_motor"] == "derived" and recording.origin["angle_motor"] == "measured"
    assert recording.meta["speed_motor"] == "mean over the sample, from angle_motor"
    assert recording.meta["speed_from_counts"] is True


def test_sample_time_instead_of_a_time_column(tmp_path: Path) -> None:
    recording = read_recording(
        write(tmp_path, lines()), time={"sample_time": "0.5 ms"}, channels=NUMBERED, speed_from_counts=True
    )
    np.testing.assert_allclose(recording.time, 0.0005 * np.arange(ROWS), rtol=1e-15)
    assert recording.meta["speed_from_counts"] is True


def test_whether_the_speed_is_a_mean_is_left_open_unless_it_is_said(tmp_path: Path) -> None:
    path = write(tmp_path, lines())
    assert "speed_from_counts" not in read_recording(path, time=0, channels=NUMBERED).meta
    said = read_recording(path, time=0, channels=NUMBERED, speed_from_counts=False)
    assert said.meta["speed_from_counts"] is False


@pytest.mark.parametrize(
    ("step", "unit", "known"),
    [
        (0.001, "rpm", True),
        (0.01, "rad/s", True),
        (0.0599, "rad/s", False),
        (1.0, "rpm", False),
        (0.1, "counts/s", False),
    ],
)
def test_decimals_of_a_file_are_no_counts(tmp_path: Path, step: float, unit: str, known: bool) -> None:
    speed = np.array([float(f"{v:.9g}") for v in np.round(SPEED / 10.0) * step])
    path = write(tmp_path, lines(columns=(TIME, speed, TORQUE)))
    channel = {"column": 1, "unit": unit, "counts_per_rev": 4096}
    meta = read_recording(path, time=0, channels={"speed_motor": channel}).meta
    assert meta.get("speed_from_counts") is (False if known else None)
    said = read_recording(path, time=0, channels={"speed_motor": channel}, speed_from_counts=True)
    assert said.meta["speed_from_counts"] is True


def test_window_is_half_open_and_hides_what_lies_outside(tmp_path: Path) -> None:
    torque = TORQUE.copy()
    torque[[3, 180]] = np.nan
    path = write(tmp_path, lines(columns=(TIME, SPEED, torque)))
    recording = read_recording(path, time=0, channels=NUMBERED, window=(0.01, 0.15))
    np.testing.assert_array_equal(recording.time, TIME[10:150])
    np.testing.assert_array_equal(recording["torque_motor"], TORQUE[10:150])
    with pytest.raises(InputProblems, match="torque_motor: got NaN or infinity in line 4 "):
        read_recording(path, time=0, channels=NUMBERED, window=(0.002, 0.15))
    with pytest.raises(InputProblems, match=r"between 0 and 0\.199 s"):
        read_recording(path, time=0, channels=NUMBERED, window=(3.0, 4.0))


def test_nan_and_infinity_are_named_with_their_lines(tmp_path: Path, problems_of: Problems) -> None:
    speed, torque = SPEED.copy(), TORQUE.copy()
    speed[4], torque[[7, 9]] = np.inf, np.nan
    path = write(tmp_path, ["t,n,M", *lines(columns=(TIME, speed, torque))])
    first, second = problems_of(lambda: read_recording(path, channels={"speed_motor": 1, "torque_motor": 2}))
    assert first.where.endswith("speed_motor") and "line 6 (1 values)" in first.got
    assert second.where.endswith("torque_motor") and "line 9, line 11 (2 values)" in second.got


def test_text_and_empty_fields_are_named_with_their_lines(tmp_path: Path, problems_of: Problems) -> None:
    rows = lines(";", comma=True)
    rows[5] = "0,005;abc;1,0"
    rows[8] = "0,008;1,0;;"
    rows[8] = "0,008;;1,0"
    path = write(tmp_path, ["t;Speed;Torque", *rows])
    (problem,) = problems_of(lambda: read_recording(path, channels=NAMED))
    assert problem.where.endswith("rig.csv, column 'Speed'") and problem.got == "text 'abc' in line 7, 10"
    # A column that nobody asked for may hold texts.
    assert "torque_motor" in read_recording(path, channels={"torque_motor": "Torque"})


def test_a_cut_off_last_line_is_named(tmp_path: Path, problems_of: Problems) -> None:
    rows = lines()
    rows[-1] = rows[-1].split(",")[0]
    (problem,) = problems_of(lambda: read_recording(write(tmp_path, rows), time=0, channels=NUMBERED))
    assert (
        problem.where.endswith(f"line {ROWS}") and problem.got == "1 fields" and "cut off" in problem.remedy
    )


def test_time_must_increase(tmp_path: Path, problems_of: Problems) -> None:
    time = TIME.copy()
    time[50] = time[49]
    path = write(tmp_path, lines(columns=(time, SPEED, TORQUE)))
    (problem,) = problems_of(lambda: read_recording(path, time=0, channels=NUMBERED))
    assert "0.049 s after 0.049 s in line 51 (1 such steps)" in problem.got


@pytest.mark.parametrize("bad_time", [0.049, math.nan])
def test_problems_of_time_and_signals_come_together(
    tmp_path: Path, bad_time: float, problems_of: Problems
) -> None:
    time, torque = TIME.copy(), TORQUE.copy()
    time[50], torque[[7, 90]] = bad_time, math.nan
    path = write(tmp_path, lines(columns=(time, SPEED, torque)))
    first, second = problems_of(lambda: read_recording(path, time=0, channels=NUMBERED))
    assert first.where.endswith("time") and "line 51 " in first.got
    assert second.where.endswith("torque_motor") and "line 8, line 91 (2 values)" in second.got
    # Outside the window nothing is said of the signals.
    _, part = problems_of(lambda: read_recording(path, time=0, channels=NUMBERED, window=(0.02, 0.15)))
    assert "line 91 (1 values)" in part.got


@pytest.mark.parametrize(("jitter", "fails"), [(0.04, False), (0.06, True)])
def test_raster_is_kept_within_five_percent(tmp_path: Path, jitter: float, fails: bool) -> None:
    time = TIME.copy()
    time[100:] += jitter * 1e-3
    path = write(tmp_path, lines(columns=(time, SPEED, TORQUE)))
    if not fails:
        assert read_recording(path, time=0, channels=NUMBERED).meta["problems"] == ()
        return
    with pytest.raises(InputProblems, match=r"1 of 199 steps off .* line 101: 1\.06 ms.*resample = \"1 ms\""):
        read_recording(path, time=0, channels=NUMBERED)


@pytest.mark.parametrize(("resample", "step"), [(True, 1e-3), ("0.5 ms", 5e-4), (2e-3 / 1.6, 1.25e-3)])
def test_resampling_only_when_asked_and_said(
    tmp_path: Path, resample: str | float | bool, step: float
) -> None:
    time = np.delete(TIME, 100)
    path = write(tmp_path, lines(columns=(time, 1e4 * time, np.delete(TORQUE, 100))))
    recording = read_recording(path, time=0, channels=NUMBERED, resample=resample)
    np.testing.assert_allclose(np.diff(recording.time), step, rtol=1e-9)
    np.testing.assert_allclose(recording["speed_motor"], 1e4 * recording.time * RPM, rtol=1e-9, atol=1e-12)
    assert recording.time[-1] == pytest.approx(0.199, abs=step)
    (warning,) = recording.meta["problems"]
    assert warning.severity == "warning" and "steps from 1 to 2 ms, resampled to" in warning.got


def test_too_short(tmp_path: Path, problems_of: Problems) -> None:
    path = write(tmp_path, lines()[:99])
    (problem,) = problems_of(lambda: read_recording(path, time=0, channels=NUMBERED))
    assert (problem.got, problem.expected) == ("99 samples", "at least 100")


def test_misnamed_channels_are_all_named_with_close_matches(tmp_path: Path, problems_of: Problems) -> None:
    path = write(tmp_path, ["Time [s];Motor Speed [rpm];Torque", *lines(";")])
    channels = {
        "speed_motor": "motor sped",
        "torque_motor": {"column": "Torque", "unit": "Nn"},
        "speed_load": 7,
        "twist": {"colum": 1},
    }
    found = problems_of(lambda: read_recording(path, channels=channels))
    texts = {p.where.rsplit(", ", 1)[-1].split(" (")[0]: p for p in found}
    assert texts["speed_motor"].remedy == "Did you mean 'Motor Speed [rpm]'?"
    assert "a number from 0 to 2" in texts["speed_load"].expected
    assert "Give at least the column" in texts["twist"].remedy
    assert texts["torque_motor"].got == "unknown unit 'Nn'" and "mNm" in texts["torque_motor"].expected
    assert len(found) == 4


def test_doubled_names_and_names_without_header(tmp_path: Path, problems_of: Problems) -> None:
    path = write(tmp_path, ["t,M,M", *lines()])
    (problem,) = problems_of(lambda: read_recording(path, channels={"torque_motor": "M"}))
    assert "one of [1, 2]" in problem.remedy
    bare = write(tmp_path, lines())
    assert (
        "no header"
        in problems_of(lambda: read_recording(bare, time=0, channels={"torque_motor": "M"}))[0].expected
    )
    missing = problems_of(lambda: read_recording(bare, channels=NUMBERED))
    assert [p.got for p in missing] == ["no time"]
    assert "no channels" in problems_of(lambda: read_recording(bare, time=0))[0].got


@pytest.mark.parametrize(
    "spec",
    [
        {"column": 1, "sign": 2},
        {"column": 1, "scale": 0},
        {"column": 1, "scale": math.nan},
        {"column": 1.5},
        {"column": True},
        {"column": 1, "unit": 3},
        {"column": 1, "sing": -1},
        None,
    ],
)
def test_bad_channels_are_refused(tmp_path: Path, spec: object, problems_of: Problems) -> None:
    (problem,) = problems_of(
        lambda: read_recording(write(tmp_path, lines()), time=0, channels={"speed_motor": spec})
    )
    assert "speed_motor" in problem.where


@pytest.mark.parametrize(
    ("content", "got"),
    [
        (b"", "an empty file"),
        (b"\n\n# nothing\n", "an empty file"),
        (b"a|b\n1|2\n", "no line of numbers"),
        (b"\x7fELF\0\0\1" * 50, "a binary file"),
        (b"PK\x03\x04" + b"x" * 50, "a damaged file"),
    ],
)
def test_files_that_are_no_recordings(
    tmp_path: Path, content: bytes, got: str, problems_of: Problems
) -> None:
    path = tmp_path / "rig.csv"
    path.write_bytes(content)
    (problem,) = problems_of(lambda: read_recording(path, time=0, channels={"speed_motor": 1}))
    assert problem.got.startswith(got) and str(path) in problem.where


def test_missing_file_and_folder(tmp_path: Path, problems_of: Problems) -> None:
    write(tmp_path, lines())
    (missing,) = problems_of(lambda: read_recording(tmp_path / "rigg.csv"))
    assert missing.got == "no such file" and "rig.csv" in missing.remedy
    (folder,) = problems_of(lambda: read_recording(tmp_path))
    assert folder.got == "a folder"


def test_wrong_separator_in_a_later_line(tmp_path: Path, problems_of: Problems) -> None:
    rows = lines(";")
    rows[150] = rows[150].replace(";", ",")
    (problem,) = problems_of(lambda: read_recording(write(tmp_path, rows), time=0, channels=NUMBERED))
    assert problem.where.endswith("line 151") and "separator" in problem.remedy


def test_saved_recordings_are_read_with_their_origin_and_checked(
    tmp_path: Path, problems_of: Problems
) -> None:
    original = Recording(
        TIME,
        {"speed_motor": SPEED, "torque_motor": TORQUE},
        {"speed_motor": "simulated"},
        meta={"seed": 3, "speed_from_counts": True},
    )
    path = tmp_path / "rig.npz"
    save_recording(original, path)
    recording = read_recording(path, window=(0.05, 0.2))
    np.testing.assert_array_equal(recording["speed_motor"], SPEED[50:])
    assert recording.origin["speed_motor"] == "simulated"
    assert recording.meta["seed"] == 3 and recording.meta["speed_from_counts"] is True
    assert (
        problems_of(lambda: read_recording(path, channels=NUMBERED))[0].got
        == "channels for a saved recording"
    )


def test_hash_of_the_file_is_kept(tmp_path: Path) -> None:
    import hashlib

    path = write(tmp_path, lines())
    recording = read_recording(path, time=0, channels=NUMBERED)
    assert recording.meta["sha256"] == hashlib.sha256(path.read_bytes()).hexdigest()
    assert recording.meta["sources"] == {"speed_motor": "column 1", "torque_motor": "column 2"}


def test_a_hundred_thousand_rows_are_read_fast(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    table = np.column_stack([1e-4 * np.arange(100_000), rng.normal(size=(100_000, 4))])
    path = tmp_path / "long.csv"
    np.savetxt(path, table, delimiter=",", fmt="%.8g")
    start = clock.process_time()
    recording = read_recording(
        path,
        time=0,
        channels={
            n: i + 1 for i, n in enumerate(("speed_motor", "torque_motor", "speed_load", "torque_shaft"))
        },
    )
    seconds = clock.process_time() - start
    assert len(recording) == 100_000
    assert seconds < 3.0  # measured 0.3 s; a reading line by line in Python takes longer than this


def test_aalto_sensor_files_need_no_resampling(real_data: Callable[[str], Path]) -> None:
    for name, rows in (("sin_sensor.csv", 9400), ("step_sensor.csv", 12867)):
        recording = read_recording(
            real_data(f"aalto/{name}"),
            time={"column": 0, "unit": "s"},
            channels={"speed_motor": {"column": 1, "unit": "rad/s"}, "speed_load": 2, "torque_shaft": 3},
        )
        assert len(recording) == rows and recording.dt == pytest.approx(0.996e-3, rel=1e-5)
        assert [p.where.rsplit(", ")[-1] for p in recording.meta["problems"]] == ["torque_shaft"]
        assert "never reverses" in recording.meta["problems"][0].got


def test_aalto_motor_files_have_gaps(real_data: Callable[[str], Path], problems_of: Problems) -> None:
    path = real_data("aalto/step_motor.csv")
    (problem,) = problems_of(lambda: read_recording(path, time=0, channels={"torque_motor": 2}))
    assert "the longest: 125.003 ms" in problem.got


def test_invalid_window_and_resample_are_problems_too(tmp_path: Path) -> None:
    path = write(tmp_path, lines())
    for bad in (
        {"window": (0.1, 0.05)},
        {"resample": "3 Nm"},
        {"resample": "0.5 s"},
        {"time": {"sample_time": "-1 ms"}},
        {"time": {"sample_time": 1, "column": 0}},
    ):
        with pytest.raises(InputProblems):
            read_recording(path, **{"time": 0, "channels": NUMBERED, **bad})
    assert not issubclass(InputProblems, InvalidInput)
