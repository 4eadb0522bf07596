"""Where limit cycles exist over two parameters: the exact orbit at each point, and what describing functions expect."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DiscreteSystem
from .harmonic_balance import harmonic_balance
from .shooting import SETTLE, ending

Array = NDArray[np.float64]

#: What is simulated at a point: drivetrain, law and set-point (rad/s), out of the two parameters.
Build = Callable[[float, float], tuple[Drivetrain, DiscreteSystem, float]]


@dataclass(frozen=True, eq=False)
class LimitCycleMap:
    """Limit cycles over two parameters; a row for each value of the second, a column for each of the first.

    Parameters
    ----------
    first, second : (name, unit)
        What the axes show; a unit may be "".
    first_values : (a,) array, second_values : (b,) array
    swing : (b, a) array, rad/s
        Largest minus smallest load speed, of the orbit if there is one; 0 where the loop comes to rest.
    frequency : (b, a) array, Hz
        Of the exact periodic orbit; NaN where the loop rests, or swings without a period that repeats.
    expected : (b, a) array of bool
        Whether describing functions expect a stable limit cycle.
    """

    first: tuple[str, str]
    second: tuple[str, str]
    first_values: Array
    second_values: Array
    swing: Array
    frequency: Array
    expected: NDArray[np.bool_]


@checks_arguments
def limit_cycle_map(
    build: Build,
    first: tuple[str, str],
    first_values: Sequence[float],
    second: tuple[str, str],
    second_values: Sequence[float],
    *,
    delay: int = 0,
    settle: float = SETTLE,
    progress: Callable[[float], None] | None = None,
) -> LimitCycleMap:
    """The limit cycle that the loop ends in from rest, at every pair of values.

    Parameters
    ----------
    build : function of (first, second) → (drivetrain, law, set-point in rad/s)
    first, second : (name, unit)
    first_values, second_values : sequences of float
    delay, settle
        As for ``limit_cycle``.
    progress : function of the share done, optional

    Raises
    ------
    InvalidInput
        Without values, and as ``limit_cycle`` and ``harmonic_balance``.
    """
    if not callable(build):
        raise InvalidInput("limit_cycle_map.build", repr(build), "a function of two numbers", "Give one.")
    shape = len(second_values), len(first_values)
    if not all(shape):
        raise InvalidInput("limit_cycle_map", f"{shape} values", "one or more of each", "Give the values.")
    swing, frequency = np.zeros(shape), np.full(shape, np.nan)
    expected = np.zeros(shape, dtype=bool)
    for place in np.ndindex(shape):
        drivetrain, law, reference = build(float(first_values[place[1]]), float(second_values[place[0]]))
        balance = harmonic_balance(drivetrain, law, reference=reference, delay=delay)
        expected[place] = any(harmonic.is_stable for harmonic in balance.expected)
        swing[place], orbit = ending(drivetrain, law, reference, 0.0, delay, None, settle)
        if orbit is not None:
            swing[place], frequency[place] = orbit.swing("speed_load"), orbit.frequency
        if progress is not None:
            progress((place[0] * shape[1] + place[1] + 1) / (shape[0] * shape[1]))
    return LimitCycleMap(
        first, second, np.array(first_values, dtype=float), np.array(second_values, dtype=float), swing, frequency,
        expected,
    )  # fmt: skip
