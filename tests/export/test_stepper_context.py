"""Steppers as C: hybrid predictive control and scheduled gains give the very bits of Python; others are refused."""

from __future__ import annotations

import ctypes
import shutil

import numpy as np
import pytest
from table_i import PAPER

from lostmotion import export
from lostmotion.controllers import hybrid_predictive, scheduled_lqi
from lostmotion.curves import dead_zone
from lostmotion.errors import InvalidInput
from lostmotion.observers import extended_kalman

needs_compiler = pytest.mark.skipif(
    not any(map(shutil.which, ("cc", "gcc", "clang"))), reason="no C compiler on this machine"
)
LAW = hybrid_predictive(
    PAPER, dt=1e-4, largest_error=1.0, largest_torque=73.5, torque_limit=73.5, contact_speed=0.4
)
SCHEDULED = scheduled_lqi(
    PAPER.with_parameters(lag=3e-4), dt=1e-4, largest_error=2.0, largest_torque=73.5, torque_limit=73.5
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


def loads(count):
    """Inputs (count, 8) of a drive whose load inertia is tracked, in the order of the scheduled law."""
    reference, _, elastic, motor, load, friction, acting, pull = crossings(count).T
    inertia = PAPER.inertia_load * (1.0 + 0.8 * np.sin(50.0 * np.arange(count) * 1e-4))
    return np.column_stack([reference, elastic, motor, load, 0.1 * friction, 0.1 * acting, pull, inertia])


@needs_compiler
@pytest.mark.parametrize(("law", "made"), [(LAW, crossings), (SCHEDULED, loads)], ids=["hybrid", "scheduled"])
def test_in_c_it_has_the_bits_of_python(law, made, tmp_path):
    code = ctypes.CDLL(str(export.shared_library(law, tmp_path)))
    state = ctypes.create_string_buffer(code.law_size())
    code.law_init(state)
    inputs, torque = made(3000), ctypes.c_double()
    run = law.run(dict(zip(law.inputs, inputs.T, strict=True)))
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
