"""A plant's modes gathered in arrays for the kernel; a mode is built when it is first entered."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .contact_states import GAP, MINUS, PLUS, Layout, elements, relaxes
from .packing import chain_of, numbers_of

Array = NDArray[np.float64]

#: Most combinations of contact and friction states (numerics: 8 MB for the table of rows).
_MOST_MODES = 1_000_000
#: Contact states for which there is room at first (numerics: all nine of two masses; longer chains enter few of
#: theirs).
ROOM = 16


@dataclass(frozen=True, eq=False)
class Mode:
    """One mode of a plant: rows over s = [x, inputs, 1] (C numbers), torques in Nm.

    Parameters
    ----------
    digits : tuple of int
        One for each element of the plant.
    rows : (4 n − 2 + N + E, C)
        As in ``kernels.plant.contact_states.ModeWork``.
    block : (B,)
        The kernel's numbers, see ``kernels.plant.layout``.
    n, states : int
        Inertias and states.
    dt : float, s
    """

    digits: tuple[int, ...]
    rows: Array
    block: Array
    n: int
    states: int
    dt: float

    @property
    def shaft_torques(self) -> Array:
        """(n − 1, C)"""
        return self.rows[: self.n - 1]

    @property
    def springs(self) -> Array:
        """(n − 1, C): k·dz(twist) of the shafts with backlash, as this mode sees it."""
        return self.rows[self.n - 1 : 2 * self.n - 2]

    @property
    def external(self) -> Array:
        """(n, C): torque on each inertia from outside the chain."""
        return self.rows[2 * self.n - 2 : 3 * self.n - 2]

    @property
    def frictions(self) -> Array:
        """(n, C)"""
        return self.rows[3 * self.n - 2 : 4 * self.n - 2]

    @property
    def rate(self) -> Array:
        """(N, C): dx/dt."""
        return self.rows[4 * self.n - 2 : 4 * self.n - 2 + self.states]

    @property
    def guard(self) -> Array:
        """(E, C)"""
        return self.rows[4 * self.n - 2 + self.states :]

    def driving_torque(self, i: int) -> Array:
        """(C,): torque on inertia i without its friction."""
        torque = self.external[i].copy()
        if i > 0:
            torque += self.shaft_torques[i - 1]
        if i < self.n - 1:
            torque -= self.shaft_torques[i]
        return torque

    @property
    def piece(self) -> float:
        """Time over which the Taylor series hold, s."""
        return float(self.block[self._header]) * self.dt

    @property
    def state_series(self) -> Array:
        """(O, N, C): Taylor coefficients of the state over a sub-step, from order 1 on."""
        from ..kernels.plant.layout import HEADER

        columns, order, high = self.rows.shape[1], int(self.block[self._header + 1]), _groups(self.states)
        table = self.block[self._header + HEADER :][: order * columns * high]
        return table.reshape(order, columns, high)[:, :, : self.states].transpose(0, 2, 1)

    @property
    def table(self) -> Array:
        """(C, rows): change of the state over a sample, guards, their rates, swings and remainders, in groups."""
        from ..kernels.plant.layout import ELEMENT_ROWS

        columns = self.rows.shape[1]
        height = _groups(self.states) + ELEMENT_ROWS * _groups(len(self.guard))
        return self.block[: columns * height].reshape(columns, height)

    @cached_property
    def _header(self) -> int:
        return self.table.size + 2 * _groups(len(self.guard))


def _groups(count: int) -> int:
    """Numbers that hold `count` of them in whole groups of four."""
    from ..kernels.numerics.vectors import LANES

    return -(-count // LANES) * LANES


class Plant:
    """All that the kernels need to know of a drivetrain at one sample time; grows as modes are entered."""

    def __init__(self, drivetrain: Drivetrain, dt: float, inputs: tuple[str, ...]) -> None:
        from ..kernels.plant.contact_states import new_mode_work
        from ..kernels.plant.layout import block_size
        from ..kernels.plant.taylor_series import ORDER

        self.drivetrain = drivetrain
        self.dt = dt
        self.layout = Layout(drivetrain, inputs)
        self.elements = elements(drivetrain)
        digits = [e.digits for e in self.elements]
        self.radix = np.array([math.prod(digits[i + 1 :]) for i in range(len(digits))], dtype=np.int64)
        count = check_modes(digits)
        self.row_of_mode = np.full(count, -1, dtype=np.int64)
        self.chain = chain_of(self.layout, self.elements)
        self.numbers = numbers_of(drivetrain, dt)
        self.size = block_size.py_func(self.layout.states, self.layout.columns, len(digits), ORDER)
        self._work = new_mode_work(self.chain)
        self._built = np.zeros(1, dtype=np.int64)
        room, signals = min(count, ROOM), len(self.signal_weights)
        self._flat = np.zeros((room, self.size))
        self._rows = np.zeros((room, *self._work.rows.shape))
        self._digits = np.zeros((room, len(digits)), dtype=np.int64)
        self._signal = np.zeros((room, signals, self.layout.columns))
        self._span = np.zeros((room, signals, 2), dtype=np.int64)

    @property
    def modes(self) -> list[Mode]:
        """The contact states entered so far, in the order of ``row_of_mode``."""
        layout = self.layout
        return [
            Mode(
                tuple(self._digits[i].tolist()),
                self._rows[i],
                self._flat[i],
                layout.n,
                layout.states,
                self.dt,
            )
            for i in range(int(self._built[0]))
        ]

    def enter(self, digits: Sequence[int] | NDArray[np.int64]) -> None:
        """Builds the tables of the contact state of these digits if they do not stand yet."""
        from ..kernels.plant.entered import enter

        digits = np.asarray(digits, dtype=np.int64)
        if not enter(self.entered(), digits):
            self.grow()
            enter(self.entered(), digits)

    @property
    def room(self) -> int:
        """For how many contact states there is room."""
        return len(self._flat)

    def grow(self) -> None:
        """Room for twice as many contact states."""
        self._flat, self._rows, self._signal = map(_doubled, (self._flat, self._rows, self._signal))
        self._digits, self._span = map(_doubled, (self._digits, self._span))

    def start_digits(self, x: Array) -> NDArray[np.int64]:
        """The mode in which a state lies; sets the shaft angle of the physical law in x where the twist tells it."""
        from ..kernels.plant.equations import start_digits

        digits = np.zeros(len(self.elements), dtype=np.int64)
        start_digits(self.chain, self.numbers, x, digits)
        return digits

    @cached_property
    def element_tables(self) -> dict[str, Any]:
        """What the kernel needs to know of the elements, the same in all modes."""
        layout, n, e = self.layout, self.layout.states, len(self.elements)
        speed_row, reset_row = np.zeros((e, n)), np.zeros((e, 3, n + 1))
        reset_slot = np.full(e, -1, dtype=np.int64)
        for j, element in enumerate(self.elements):
            i = element.index
            if element.kind not in ("shaft", "friction"):
                continue
            speed_row[j, layout.speed(i)] = 1.0
            if element.kind == "friction":
                reset_slot[j] = layout.speed(i)
                continue
            speed_row[j, layout.speed(i + 1)] = -1.0
            if relaxes(self.drivetrain.shafts[i]):
                reset_slot[j] = layout.shaft_angle(i)
                for digit in (MINUS, PLUS):
                    reset_row[j, digit, layout.twist(i)] = 1.0
                    reset_row[j, digit, n] = -(digit - GAP) * 0.5 * self.drivetrain.shafts[i].backlash
        stick = [x.rest if x.kind == "friction" else -1 for x in self.elements]
        return {
            "kind": self.chain.elements[:, 0].copy(),
            "stick": np.array(stick, dtype=np.int64),
            "speed_row": speed_row,
            "reset_row": reset_row,
            "reset_slot": reset_slot,
        }

    def entered(self) -> Any:
        """The kernels' view of the contact states entered so far; stale after ``grow``."""
        from ..kernels.plant.entered import Entered

        return Entered(
            tables=self.tables(),
            chain=self.chain,
            numbers=self.numbers,
            weights=self.signal_weights,
            work=self._work,
            rows=self._rows,
            digits=self._digits,
            signal=self._signal,
            span=self._span,
            built=self._built,
            size=self.size,
        )

    def tables(self) -> Any:
        """Their tables alone, see ``kernels.plant.layout``."""
        from ..kernels.plant.layout import PlantTables
        from ..kernels.plant.taylor_series import ORDER

        return PlantTables(
            flat=self._flat.reshape(-1),
            row=self.row_of_mode,
            radix=self.radix,
            order=ORDER,
            idle=self.layout.angle_motor,
            **self.element_tables,
        )

    def signal_names(self) -> tuple[str, ...]:
        """Names of all signals that `signal_rows` gives, in its order."""
        n = self.layout.n
        chain = n > 2
        names = [
            "speed_motor",
            *(f"speed_{i + 1}" for i in range(1, n - 1)),
            *(["speed_load"] if n > 1 else []),
        ]
        names += ["angle_motor"]
        if n > 1:
            names += ["angle_load", "twist", "torque_shaft"]
        if chain:
            names += [f"twist_{i + 1}" for i in range(n - 1)] + [
                f"torque_shaft_{i + 1}" for i in range(n - 1)
            ]
        return tuple(names)

    @property
    def signal_weights(self) -> Array:
        """(signals, C + n − 1): the signals of `signal_names` over [x, inputs, 1] and the shafts' torques.

        ``torque_shaft`` is the torque in the softest shaft.
        """
        return _signal_weights(self.layout)


@lru_cache(maxsize=1)
def _signal_weights(layout: Layout) -> Array:
    """The last ones are kept, since simulations come in series."""
    n = layout.n
    unit = np.eye(layout.columns + n - 1)
    shaft_torques = list(unit[layout.columns :])
    rows = [unit[layout.speed(i)] for i in range(n)] + [unit[layout.angle_motor]]
    if n > 1:
        twist = np.sum([unit[layout.twist(i)] for i in range(n - 1)], axis=0)
        softest = int(np.argmin([shaft.stiffness for shaft in layout.drivetrain.shafts]))
        rows += [unit[layout.angle_motor] - twist, twist, shaft_torques[softest]]
    if n > 2:
        rows += [unit[layout.twist(i)] for i in range(n - 1)] + shaft_torques
    return np.array(rows)


def _doubled(array: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([array, np.zeros_like(array)])


def check_modes(digits: Sequence[int]) -> int:
    """Number of combinations of the elements' digits."""
    count = math.prod(digits)
    if count > _MOST_MODES:
        raise InvalidInput(
            "simulate",
            f"{count} combinations of contact and friction states",
            f"at most {_MOST_MODES}",
            "Leave out backlashes or points of the Stribeck curves.",
        )
    return count
