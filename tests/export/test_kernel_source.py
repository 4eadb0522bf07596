"""Kernels as C: the operations and types of the Python source, and a refusal of what has no counterpart."""

from __future__ import annotations

import pytest
from numba import njit, types

from lostmotion.export.kernel_source import c_functions

ARRAY, NUMBER, WHOLE = types.float64[::1], types.float64, types.int64
SHARE = 0.25


@njit(NUMBER(ARRAY, NUMBER))
def scaled(values, factor):
    total = 0.0
    for i in range(1, 3):
        total += factor * values[i] - SHARE
    return total


@njit(WHOLE(ARRAY, ARRAY))
def caller(source, target):
    """Not a line of C."""
    first, count = scaled(source[2:5], 1.5), 0
    while 0.0 < first <= 8.0 and not count >= 3:
        target[count] = first if first > 2.0 else -first
        count += 1
        first = first + float(count)
    if count == 0:
        target[0] = 1e30
    else:
        target[0] = target[0] / 3.0
    return int(first)


@njit(NUMBER(NUMBER))
def with_power(x):
    return x**2


@njit(NUMBER(NUMBER, NUMBER))
def with_swap(a, b):
    a, b = b, a
    return a - b


def test_the_whole_of_two_kernels():
    assert c_functions(caller, "real") == [
        """static real scaled(const real *values, real factor)
{
    long i;
    real total;
    total = R(0.0);
    for (i = 1; i < 3; i++) {
        total = total + ((factor * values[i]) - R(0.25));
    }
    return total;
}""",
        """static long caller(const real *source, real *target)
{
    real first;
    long count;
    first = scaled((source + 2), R(1.5));
    count = 0;
    while (((R(0.0) < first && first <= R(8.0)) && (!(count >= 3)))) {
        target[count] = ((first > R(2.0)) ? first : (-first));
        count = count + 1;
        first = (first + ((real)count));
    }
    if ((count == 0)) {
        target[0] = R(1e+30);
    } else {
        target[0] = (target[0] / R(3.0));
    }
    return ((long)first);
}""",
    ]


@pytest.mark.parametrize("kernel, named", [(with_power, "Pow"), (with_swap, "assigned beside")])
def test_what_has_no_counterpart_is_refused(kernel, named):
    with pytest.raises(TypeError, match=named):
        c_functions(kernel, "real")
