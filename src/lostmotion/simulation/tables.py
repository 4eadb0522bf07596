"""A plant's modes gathered in arrays for the kernel; a mode is built when it is first entered."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from .modes import GAP, MINUS, PLUS, Element, Layout, Mode, build_mode, elements, friction_segment, relaxes

#: Most combinations of contact and friction states (chosen: 8 MB for the table of rows).
_MOST_MODES = 1_000_000


class Plant:
    """All that the kernels need to know of a drivetrain at one sample time; grows as modes are entered."""

    def __init__(self, drivetrain: Drivetrain, dt: float, inputs: tuple[str, ...]) -> None:
        self.drivetrain = drivetrain
        self.dt = dt
        self.layout = Layout(drivetrain, inputs)
        self.elements = elements(drivetrain)
        digits = [e.digits for e in self.elements]
        self.radix = np.array([math.prod(digits[i + 1 :]) for i in range(len(digits))], dtype=np.int64)
        count = math.prod(digits)
        if count > _MOST_MODES:
            raise InvalidInput(
                "simulate",
                f"{count} combinations of contact and friction states",
                f"at most {_MOST_MODES}",
                "Leave out backlashes or points of the Stribeck curves.",
            )
        self.row_of_mode = np.full(count, -1, dtype=np.int64)
        self.modes: list[Mode] = []
        self._blocks: dict[tuple[int, int], NDArray[np.float64]] = {}

    def digits_of(self, mode: int) -> tuple[int, ...]:
        return tuple((mode // int(r)) % e.digits for r, e in zip(self.radix, self.elements, strict=True))

    def enter(self, digits: Sequence[int] | NDArray[np.int64]) -> None:
        """Builds the mode of these digits if it does not stand yet."""
        mode = int(np.dot(self.radix, np.asarray(digits, dtype=np.int64))) if len(digits) else 0
        if self.row_of_mode[mode] < 0:
            self.modes.append(build_mode(self.layout, self.elements, tuple(int(d) for d in digits), self.dt))
            self.row_of_mode[mode] = len(self.modes) - 1

    def start_digits(self, x: NDArray[np.float64]) -> NDArray[np.int64]:
        """The mode in which a state lies; sets the shaft angle of the physical law in x where the twist tells it."""
        digits = [self._start_digit(e, x) for e in self.elements]
        return np.array(digits, dtype=np.int64)

    def _start_digit(self, element: Element, x: NDArray[np.float64]) -> int:
        layout, i = self.layout, element.index
        if element.kind in ("sum", "difference"):
            return 1  # put right by an event at once where it is wrong
        if element.kind == "friction":
            speed = x[layout.speed(i)]
            if speed == 0.0:
                return element.rest
            side = range(element.rest + 1, element.digits) if speed > 0.0 else range(element.rest)
            segments = {d: friction_segment(self.drivetrain.frictions[i], d, element.rest) for d in side}
            return next(d for d, (_, _, low, high) in segments.items() if low <= speed <= high)
        shaft = self.drivetrain.shafts[i]
        reach = x[layout.twist(i)]
        if shaft.contact == "viscoelastic":
            reach += shaft.damping / shaft.stiffness * (x[layout.speed(i)] - x[layout.speed(i + 1)])
        half = 0.5 * shaft.backlash
        if relaxes(shaft):
            inside = np.clip(reach, -half, half)
            x[layout.shaft_angle(i)] = reach - inside
        return PLUS if reach > half else MINUS if reach < -half else GAP

    def _block(self, mode: Mode, order: int) -> NDArray[np.float64]:
        """One mode's numbers in the order that the kernel reads, see ``kernels.plant``."""
        from ..kernels.plant import HEADER
        from ..kernels.vectors import LANES

        n, e, columns = self.layout.states, len(self.elements), self.layout.columns
        high, wide, long = (-(-count // LANES) * LANES for count in (n, e, order + 1))
        own = len(mode.state_series)
        columnwise = np.zeros((columns, high + 4 * wide))
        columnwise[:, :n] = mode.delta.T
        for i, rows in enumerate((mode.guard, mode.guard_rate, mode.swing, mode.remainder)):
            columnwise[:, high + i * wide :][:, :e] = rows.T
        bounds = np.full((2, wide), ((-np.inf,), (np.inf,)))
        bounds[:, :e] = mode.lower, mode.upper
        header = np.zeros(HEADER)
        header[:2] = mode.piece / self.dt, own
        states = np.zeros((order, columns, high))
        states[:own, :, :n] = mode.state_series.transpose(0, 2, 1)
        guards = np.zeros((e, columns, long))
        guards[:, :, : own + 1] = mode.guard_series.transpose(1, 2, 0)
        return np.concatenate([part.ravel() for part in (columnwise, bounds, header, states, guards)])

    def tables(self) -> Any:
        """The kernel's view of the modes built so far."""
        from ..kernels.plant import BRANCH, FRICTION, SHAFT, PlantTables

        layout, n = self.layout, self.layout.states
        e = len(self.elements)

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
        order = max(len(mode.state_series) for mode in self.modes)
        for i, mode in enumerate(self.modes):
            if (i, order) not in self._blocks:
                self._blocks[i, order] = self._block(mode, order)
        kinds = {"shaft": SHAFT, "friction": FRICTION}
        return PlantTables(
            flat=np.concatenate([self._blocks[i, order] for i in range(len(self.modes))]),
            row=self.row_of_mode.copy(),
            radix=self.radix,
            kind=np.array([kinds.get(x.kind, BRANCH) for x in self.elements], dtype=np.int64),
            stick=np.array([x.rest if x.kind == "friction" else -1 for x in self.elements], dtype=np.int64),
            speed_row=speed_row,
            reset_row=reset_row,
            reset_slot=reset_slot,
            order=order,
            idle=layout.angle_motor,
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

    def signal_rows(self, mode: Mode) -> NDArray[np.float64]:
        """(signals, C) rows over [x, inputs, 1]; ``torque_shaft`` is the torque in the softest shaft."""
        layout, n = self.layout, self.layout.n
        unit = np.eye(layout.columns)
        rows = [unit[layout.speed(i)] for i in range(n)] + [unit[layout.angle_motor]]
        if n > 1:
            twist = np.sum([unit[layout.twist(i)] for i in range(n - 1)], axis=0)
            softest = int(np.argmin([shaft.stiffness for shaft in self.drivetrain.shafts]))
            rows += [unit[layout.angle_motor] - twist, twist, mode.shaft_torques[softest]]
        if n > 2:
            rows += [unit[layout.twist(i)] for i in range(n - 1)] + list(mode.shaft_torques)
        return np.array(rows)
