"""C export: files, warnings, both number types, and results instead of exceptions."""

from __future__ import annotations

import shutil
from datetime import UTC, datetime

import numpy as np
import pytest
from table_i import PAPER

import lostmotion as lm
from lostmotion import export
from lostmotion.controllers import pi, pole_placement
from lostmotion.curves import dead_zone, saturation
from lostmotion.drivetrain import Drivetrain, Shaft
from lostmotion.errors import InvalidInput
from lostmotion.export.facts import output_limits
from lostmotion.io.storage.written_files import MANIFEST
from lostmotion.observers import extended_kalman, kalman
from lostmotion.systems import DiscreteSystem, connect

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler on this machine"
)


@pytest.fixture(scope="module")
def law():
    systems = [kalman(PAPER, dt=1e-4), pole_placement(PAPER, dt=1e-4, torque_limit=73.5)]
    return connect(systems, inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",))


@needs_compiler
def test_double_precision_compiles_without_warning_and_repeats_its_vectors_exactly(law, tmp_path):
    written = export.c(law, tmp_path, name="drive_law")
    assert sorted(p.name for p in written) == ["README.md", "drive_law.c", "drive_law.h", "drive_law_test.c"]
    check = export.compile_and_check(tmp_path, "drive_law")
    assert check.passed, check.message
    assert check.max_difference == 0.0
    assert sorted(p.name for p in tmp_path.iterdir()) == sorted([MANIFEST, *(p.name for p in written)])


@needs_compiler
def test_single_precision_compiles_without_warning_and_comes_close(law, tmp_path):
    export.c(law, tmp_path, real="float")
    check = export.compile_and_check(tmp_path)
    assert check.passed, check.message
    # Torques up to 73.5 Nm in single precision: 4e-6 Nm for each rounding.
    assert 0.0 < check.max_difference < 1e-3


@needs_compiler
def test_one_typedef_makes_it_single_precision(law, tmp_path):
    export.c(law, tmp_path)
    header = tmp_path / "law.h"
    header.write_text(header.read_text().replace("typedef double law_real;", "typedef float law_real;"))
    check = export.compile_and_check(tmp_path)
    assert check.passed, check.message
    assert check.max_difference > 0.0


@needs_compiler
def test_a_changed_number_is_found(law, tmp_path):
    export.c(law, tmp_path)
    source = tmp_path / "law.c"
    number = repr(float(law.A[1, 1]))
    assert number in source.read_text()
    source.write_text(source.read_text().replace(number, repr(float(np.nextafter(law.A[1, 1], 2.0)))))
    check = export.compile_and_check(tmp_path)
    assert not check.passed
    assert check.max_difference > 0.0


@needs_compiler
def test_a_lost_input_check_is_found(law, tmp_path):
    export.c(law, tmp_path)
    source = tmp_path / "law.c"
    source.write_text(source.read_text().replace("value >= R(-1e30) && value <= R(1e30)", "value < R(1e300)"))
    assert not export.compile_and_check(tmp_path).passed


@needs_compiler
def test_code_that_does_not_compile_is_a_result(law, tmp_path):
    export.c(law, tmp_path)
    (tmp_path / "law.c").write_text("int law_step(void) { return; }")
    check = export.compile_and_check(tmp_path)
    assert not check.passed
    assert check.max_difference is None
    assert "does not compile" in check.message


@needs_compiler
@pytest.mark.parametrize(
    "law",
    [
        pi(dt=1e-3, torque_limit=5.0),
        DiscreteSystem(
            inputs=("unused", "u"), outputs=("y", "zero"), states=("x",), dt=1.0, D=[[0, 1], [0, 0]]
        ),
        DiscreteSystem(inputs=("u",), outputs=("y",), dt=1.0, curves=(saturation(1.0),), G=[[1.0]]),
        DiscreteSystem(
            inputs=(), outputs=("y",), states=("x",), dt=1.0, A=[[0.5]], C=[[1.0]], initial_state=[1.0]
        ),
    ],
    ids=["pi", "unused input and state", "unused curve", "no input"],
)
@pytest.mark.parametrize("real", ["double", "float"])
def test_odd_laws_compile_without_warning(law, real, tmp_path):
    export.c(law, tmp_path, real=real)
    check = export.compile_and_check(tmp_path)
    assert check.passed, check.message


def test_without_a_compiler_it_says_so(law, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    check = export.compile_and_check(tmp_path)
    assert check.skipped and not check.passed
    assert "no C compiler" in check.message


def test_the_same_law_gives_the_same_bytes(law, tmp_path):
    for folder in ("a", "b"):
        export.c(law, tmp_path / folder)
    for path in (tmp_path / "a").iterdir():
        assert path.read_bytes() == (tmp_path / "b" / path.name).read_bytes()


def test_the_date_is_that_of_the_environment_else_of_today(law, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    export.c(law, tmp_path)
    for name in ("README.md", "law.h"):
        assert f"lostmotion {lm.__version__} on 2023-11-14" in (tmp_path / name).read_text()
    monkeypatch.delenv("SOURCE_DATE_EPOCH")
    export.c(law, tmp_path)
    assert f"on {datetime.now(UTC).date()}" in (tmp_path / "law.h").read_text()
    for bad in ("today", "9" * 400, "1e9"):
        monkeypatch.setenv("SOURCE_DATE_EPOCH", bad)
        with pytest.raises(InvalidInput, match="SOURCE_DATE_EPOCH"):
            export.c(law, tmp_path)


def test_readme_and_header_say_limits_inputs_and_drivetrain(law, tmp_path):
    plant = Drivetrain.two_mass(inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, backlash=0.012)
    export.c(law, tmp_path, drivetrain=plant)
    readme, header = (tmp_path / "README.md").read_text(), (tmp_path / "law.h").read_text()
    assert (
        "`torque_motor` stays within -73.5 … 73.5 Nm" in readme and "| `backlash` | 0.012 | rad |" in readme
    )
    assert "torque_motor stays within -73.5 ... 73.5 Nm" in header and "backlash = 0.012 rad" in header
    assert "inputs: speed_reference (rad/s), speed_motor (rad/s)" in header
    chain = Drivetrain((0.1, 0.2, 0.3), (Shaft(1e3, 0.1), Shaft(2e3, 0.1)))
    export.c(law, tmp_path, drivetrain=chain)
    assert "stiffness_2 = 2000.0 Nm/rad" in (tmp_path / "law.h").read_text()


def test_only_what_saturations_bound_is_called_limited():
    numbers = dict(inputs=("u",), dt=1.0, curves=(saturation(3.0), dead_zone(1.0)), G=[[1.0], [1.0]])
    law = DiscreteSystem(
        **numbers, outputs=("a", "b", "c", "d"), J=[[2.0, 0.0], [1.0, 1.0], [-1.0, 0.0], [0.0, 0.0]],
        D=[[0.0], [0.0], [1.0], [0.0]],
    )  # fmt: skip
    assert output_limits(law) == {"a": (-6.0, 6.0)}
    assert output_limits(pi(dt=1e-3, torque_limit=5.0)) == {"torque_motor": (-5.0, 5.0)}
    assert output_limits(pi(dt=1e-3)) == {}


def test_nobody_elses_file_is_replaced_and_no_changed_one(law, tmp_path):
    (tmp_path / "README.md").write_text("my notes")
    with pytest.raises(InvalidInput, match=r"1 file that lostmotion has not written.*README\.md"):
        export.c(law, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["README.md"]
    export.c(law, tmp_path, force=True)
    export.c(law, tmp_path)  # its own by now
    (tmp_path / "law.c").write_text("/* tuned on the rig */")
    with pytest.raises(InvalidInput, match=r"changed since: law\.c"):
        export.c(law, tmp_path)
    assert (tmp_path / "law.c").read_text() == "/* tuned on the rig */"


@pytest.mark.parametrize("place", ["file/c", "n" * 300])
def test_a_place_that_cannot_be_written_is_said(law, tmp_path, place):
    (tmp_path / "file").write_text("")
    with pytest.raises(InvalidInput, match="a folder to write into"):
        export.c(law, tmp_path / place)


def test_readme_says_signals_units_and_sample_time(law, tmp_path):
    export.c(law, tmp_path)
    text = (tmp_path / "README.md").read_text()
    for words in (
        "| `speed_reference` | rad/s |",
        "| `torque_motor` | Nm |",
        "0.0001 s",
        "-ffp-contract=off",
    ):
        assert words in text


@pytest.mark.parametrize(
    "changes, complaint",
    [
        ({"name": "2law"}, "'2law'"),
        ({"name": "while"}, "'while'"),
        ({"real": "half"}, "half"),
        ({"vectors": 1}, "2"),
    ],
)
def test_misuse(law, tmp_path, changes, complaint):
    with pytest.raises(InvalidInput, match=complaint):
        export.c(law, tmp_path, **changes)


def test_signal_names_must_be_c_identifiers(law, tmp_path):
    with pytest.raises(InvalidInput, match="Motor speed"):
        export.c(law.renamed({"speed_motor": "Motor speed"}), tmp_path)


def test_a_filter_is_refused_with_what_to_take_instead(tmp_path):
    plant = Drivetrain.two_mass(inertia_motor=0.0182, inertia_load=0.111, stiffness=6285.896, backlash=0.012)
    with pytest.raises(InvalidInput, match=r"Stepper.*expected a DiscreteSystem.*kalman"):
        export.c(extended_kalman(plant, dt=1e-4), tmp_path)


def test_a_seed_below_zero_is_refused(law, tmp_path):
    with pytest.raises(lm.InvalidInput, match="from 0 on"):
        lm.export.c(law, tmp_path, seed=-1)
