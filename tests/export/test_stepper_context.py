"""Steppers as C: hybrid predictive control gives the very bits of Python; others are refused."""

from __future__ import annotations

import ctypes
import shutil

import numpy as np
import pytest
from table_i import PAPER

from lostmotion import export
from lostmotion.controllers import hybrid_predictive
from lostmotion.curves import dead_zone
from lostmotion.errors import InvalidInput
from lostmotion.observers import extended_kalman

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler on this machine"
)
LAW = hybrid_predictive(
    PAPER, dt=1e-4, largest_error=1.0, largest_torque=73.5, torque_limit=73.5, contact_speed=0.4
)


def crossings(count):
    """Inputs (count, 8) of a drive that swings through its gap, with lost samples."""
    time = np.arange(count) * 1e-4
    twist = 0.008 * np.sin(40.0 * time) + 0.002 * np.sin(300.0 * time)
    step = np.where(time % 0.1 < 0.05, -2.0, 2.0)
    columns = [
        step, twist, dead_zone(0.5 * PAPER.backlash)(twist), 3.0 * np.cos(40.0 * time),
        2.0 * np.cos(20.0 * time), step, 30.0 * np.sin(70.0 * time), 3.0 * np.sin(time),
    ]  # fmt: skip
    inputs = np.column_stack(columns)
    inputs[np.random.default_rng(1).random(inputs.shape) < 0.01] = np.nan
    return inputs


@needs_compiler
def test_hybrid_predictive_control_in_c_has_the_bits_of_python(tmp_path):
    code = ctypes.CDLL(str(export.shared_library(LAW, tmp_path)))
    state = ctypes.create_string_buffer(code.law_size())
    code.law_init(state)
    inputs, torque = crossings(3000), ctypes.c_double()
    run = LAW.run(dict(zip(LAW.inputs, inputs.T, strict=True)))
    found = []
    for row in inputs:
        code.law_step(state, row.ctypes.data_as(ctypes.c_void_p), ctypes.byref(torque))
        found.append(torque.value)
    assert np.array(found).tobytes() == run["torque_motor"].tobytes()
    # Both limits, and all between.
    assert {-73.5, 73.5} < set(found) and len(set(found)) > 1000


@needs_compiler
def test_it_compiles_without_warning_and_repeats_its_vectors_exactly(tmp_path):
    export.c(LAW, tmp_path, name="hybrid", drivetrain=PAPER)
    check = export.compile_and_check(tmp_path, "hybrid")
    assert check.passed and check.max_difference == 0.0, check.message
    assert "stays within -73.5 … 73.5 Nm" in (tmp_path / "README.md").read_text()


@pytest.mark.parametrize(
    "law, real", [(extended_kalman(PAPER, dt=1e-4), "double"), (LAW, "float")], ids=["filter", "single"]
)
def test_what_cannot_be_exported_is_refused(law, real, tmp_path):
    with pytest.raises(InvalidInput, match="exportable"):
        export.c(law, tmp_path, real=real)
    assert not any(tmp_path.iterdir())
