"""Flat arrays as records: kernels and numpy read and write the same numbers by name."""

from __future__ import annotations

import subprocess
import sys

import numpy as np
from numba import njit

from lostmotion.kernels.estimators import layout
from lostmotion.kernels.estimators.records import reads, record_type, scratch

INNER = layout.record("first", "second")
OUTER = layout.record("a", ("x", (3,)), ("P", (2, 3)), ("inner", INNER), ("many", INNER, 2), "last")
SWAPPED = layout.record("second", "first")
read, read_inner, read_swapped = reads(OUTER), reads(INNER), reads(SWAPPED)
inner_on_the_stack = scratch(INNER)


@njit
def _write(numbers):
    r = read(numbers)
    r.a = 1.0
    for i in range(3):
        r.x[i] = 10.0 + i
    r.P[1, 2] = 20.0
    r.inner.second = 30.0
    r.many[1].first = r.inner.second + r.P[1, 2]
    r.last = r.x[2]


def test_a_kernel_writes_where_numpy_reads():
    numbers = np.zeros(layout.size(OUTER))
    _write(numbers)
    found = numbers.view(OUTER)[0]
    assert (found["a"], found["last"]) == (1.0, 12.0)
    assert found["x"].tolist() == [10.0, 11.0, 12.0]
    assert found["P"].tolist() == [[0.0] * 3, [0.0, 0.0, 20.0]]
    assert found["inner"].tolist() == (0.0, 30.0)
    assert found["many"].tolist() == [(0.0, 0.0), (50.0, 0.0)]


def test_places_and_sizes_are_numpys():
    assert layout.size(OUTER) == 1 + 3 + 6 + 2 + 4 + 1
    assert [layout.place(OUTER, name) for name in ("a", "x", "P", "inner", "many", "last")] == [
        0,
        1,
        4,
        10,
        12,
        16,
    ]
    values = np.zeros((), OUTER)
    values["P"][1, 2] = 5.0
    assert layout.flat(values).tolist() == [0.0] * 9 + [5.0] + [0.0] * 7


@njit
def _first(r):
    return r.first


@njit
def _of_both(numbers):
    return _first(read_inner(numbers)), _first(read_swapped(numbers))


def test_a_function_knows_records_apart():
    assert _of_both(np.array([1.0, 2.0])) == (1.0, 2.0)
    assert record_type(INNER) != record_type(SWAPPED)


@njit
def _sum_on_the_stack(value):
    r = inner_on_the_stack()
    r.first, r.second = value, 2.0 * value
    return r.first + r.second


def test_a_record_on_the_stack():
    assert _sum_on_the_stack(1.5) == 4.5


def test_the_names_of_compiled_functions_do_not_depend_on_what_else_a_process_made():
    """numba's own do: a function from the cache of another process could be taken for another record's."""
    code = (
        "import sys\nimport numpy as np\nfrom numba import from_dtype\n"
        "for i in range(int(sys.argv[1])): from_dtype(np.dtype([(f'x{i}', float)]))\n"
        "from lostmotion.kernels.estimators.layout import PARAMETERS\n"
        "from lostmotion.kernels.estimators.records import record_type\n"
        "print(record_type(PARAMETERS).mangling_args)\nprint(from_dtype(PARAMETERS).mangling_args)"
    )
    names = [
        subprocess.run([sys.executable, "-c", code, made], capture_output=True, text=True, check=True).stdout
        for made in ("0", "7")
    ]
    (ours, numbas), (ours_again, numbas_again) = (found.splitlines() for found in names)
    assert ours == ours_again
    assert numbas != numbas_again
