"""Kernels as C: the operations and types of the Python source, and a refusal of what has no counterpart."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
from numba import types

from lostmotion.export.kernel_source import c_functions

ARRAY, NUMBER, WHOLE = types.float64[::1], types.float64, types.int64
SHARE = 0.25


def njit(*signatures):
    """What the translation reads of a compiled kernel, without the time of compiling it."""
    return lambda function: SimpleNamespace(py_func=function, nopython_signatures=signatures)


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


@njit(NUMBER(ARRAY))
def every_second(values):
    for i in range(0, 4, 2):
        values[i] = 0.0
    return 0.0


@njit(NUMBER(ARRAY))
def over_values(values):
    for value in values:
        return value
    return 0.0


@njit(WHOLE(ARRAY))
def with_else(values):
    for i in range(4):
        values[i] = 0.0
    else:
        return 1
    return 0


@njit(WHOLE(NUMBER))
def while_else(x):
    while x > 1.0:
        x = x - 1.0
    else:
        return 1
    return 0


@njit(WHOLE(ARRAY))
def moving(values):
    """The counter, the end, and what is read after the loop."""
    end = 4
    for i in range(end):
        end = i
    for k in range(1, 4):
        k += 1
    for place in range(int(values[0])):
        values[place] = 7.0
    return i + end


@njit(NUMBER(ARRAY))
def last(values):
    return values[-1]


@njit(NUMBER(WHOLE))
def half(count):
    return 0.5 + count / 2


@njit(NUMBER(NUMBER))
def late_real(x):
    total = 0
    total += x
    return total


@njit(NUMBER(NUMBER, NUMBER))
def or_else(a, b):
    return a or b


@njit(NUMBER(NUMBER))
def never(x):
    return x - FOREVER


@njit(NUMBER(types.float32))
def single(x):
    return 2.0


@njit(NUMBER(NUMBER), WHOLE(WHOLE))
def of_two_types(x):
    return x


@njit(NUMBER(NUMBER))
def chained(x):
    a = b = x
    return a + b


def namesake():
    @njit(NUMBER(NUMBER))
    def scaled(x):
        return x

    return scaled


@njit(NUMBER(ARRAY))
def with_namesakes(values):
    return scaled(values, 2.0) + other(1.0)


FOREVER, other = float("inf"), namesake()


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


def test_a_loop_turns_as_often_as_pythons_and_leaves_the_same_counter():
    (text,) = c_functions(moving, "real")
    assert text.split("\n")[6:] == [
        "    end = 4;",
        "    for (long turn_of_i = 0, end_of_i = end; turn_of_i < end_of_i; turn_of_i++) {",
        "        i = turn_of_i;",
        "        end = i;",
        "    }",
        "    for (long turn_of_k = 1, end_of_k = 4; turn_of_k < end_of_k; turn_of_k++) {",
        "        k = turn_of_k;",
        "        k = k + 1;",
        "    }",
        "    for (long turn_of_place = 0, end_of_place = ((long)values[0]); turn_of_place < end_of_place;"
        " turn_of_place++) {",
        "        place = turn_of_place;",
        "        values[place] = R(7.0);",
        "    }",
        "    return (i + end);",
        "}",
    ]


@pytest.mark.parametrize(
    "kernel, named",
    [
        (with_power, "Pow"),
        (with_swap, "assigned beside"),
        (every_second, r"range\(0, 4, 2\)"),
        (over_values, "a loop over values"),
        (with_else, "else of a loop"),
        (while_else, "else of a loop"),
        (last, r"values\[-1\]"),
        (half, "count / 2 is cut off"),
        (late_real, "total is a whole number first"),
        (or_else, "a or b has no"),
        (never, "inf has no"),
        (single, "float32 has no"),
        (of_two_types, "2 signatures, not one"),
        (chained, "a = b = x has no"),
        (with_namesakes, "two kernels scaled"),
    ],
)
def test_what_has_no_counterpart_is_refused(kernel, named):
    """Also what C would take and do in another way."""
    with pytest.raises(TypeError, match=named):
        c_functions(kernel, "real")
