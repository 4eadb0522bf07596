"""One simulation of a plant: its arrays, the loop around the kernel, and the recording that comes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Event, Recording
from .contact_states import GAP
from .inputs import last_set_point
from .tables import Plant


class PlantRun:
    """The arrays of one simulation, and the loop that builds modes and event space as the kernel asks for them."""

    def __init__(
        self,
        drivetrain: Drivetrain,
        dt: float,
        inputs: tuple[str, ...],
        state: Sequence[float] | Mapping[str, Any] | None,
        length: int,
    ) -> None:
        from ..kernels.plant.event_loop import EVENT_COLUMNS
        from ..kernels.plant.layout import new_work

        self.plant = Plant(drivetrain, dt, inputs)
        layout = self.plant.layout
        self.length = length
        self.s = np.zeros(layout.columns)
        self.s[-1] = 1.0
        self.digits = self._start(state)
        self.plant.enter(self.digits)
        self.work = new_work(layout.states)
        self.states = np.zeros((length + 1, layout.states))
        self.modes = np.zeros(length + 1, dtype=np.int64)
        self.events = np.zeros((1024, EVENT_COLUMNS + layout.states))
        self.cursor = np.array([0.0, 0.0, 0.0, 0.0, last_set_point(state)])

    def _start(self, state: Sequence[float] | Mapping[str, Any] | None) -> NDArray[np.int64]:
        layout = self.plant.layout
        x = self.s[: layout.states]
        if isinstance(state, Mapping):
            digits = np.array(state.get("digits", ()), dtype=np.int64)
            counts = np.array([e.digits for e in self.plant.elements], dtype=np.int64)
            known = digits.shape == counts.shape and np.all((digits >= 0) & (digits < counts))
            if "digits" in state and len(state["state"]) == layout.states and known:
                x[:] = state["state"]
                return digits
            raise InvalidInput(
                "simulate.state", f"{dict(state)}", "the final_state of the same drivetrain", "Check it."
            )
        if state is not None:
            start = np.asarray(state, dtype=float)
            expected = 2 * layout.n - 1
            if start.shape != (expected,) or not np.all(np.isfinite(start)):
                raise InvalidInput(
                    "simulate.state",
                    repr(state),
                    f"{expected} finite numbers: twists (rad), then speeds (rad/s)",
                    "Give the twists first, or the final_state of another run.",
                )
            x[:expected] = start
        return self.plant.start_digits(x)

    def finish(self, kernel: Any) -> None:
        """Runs the kernel to the end of the recording; numba compiles or loads it on the first call."""
        from ..kernels.plant.event_loop import CHATTERING, DONE, NEED_EVENT_SPACE, NEED_MODE

        while True:
            status = kernel(self.plant.tables())
            if status == DONE:
                return
            if status == NEED_MODE:
                self.plant.enter(self.digits)
            elif status == NEED_EVENT_SPACE:
                self.events = np.concatenate([self.events, np.zeros_like(self.events)])
            elif status == CHATTERING:
                raise InvalidInput(
                    "simulate",
                    f"endlessly many events at t = {self.cursor[0] * self.plant.dt:g} s",
                    "a plant whose contacts do not chatter",
                    "Give the shaft some damping, or check inertias and stiffness for wrong units.",
                )

    def signals(self) -> dict[str, NDArray[np.float64]]:
        """All signals at every sample, the one after the last torque included: (n + 1,) each."""
        from ..kernels.plant.signals import same, signals_of, spans

        rows = np.array([self.plant.signal_rows(mode) for mode in self.plant.modes])
        values = signals_of(self.states, self.modes, self.plant.row_of_mode, rows, spans(rows), same(rows))
        return dict(zip(self.plant.signal_names(), values, strict=True))

    def event_list(self) -> tuple[Event, ...]:
        found = []
        rows = self.events[: int(self.cursor[2]), :5]
        for (time, element, old, new, speed), skip in zip(rows.tolist(), _passing(rows), strict=True):
            part = self.plant.elements[int(element)]
            if skip or part.kind not in ("shaft", "friction"):
                continue
            if part.kind == "shaft":
                kind = "impact" if int(new) != GAP else "separation"
            elif int(new) == part.rest:
                kind = "stick"
            elif int(old) == part.rest:
                kind = "slip"
            else:
                continue  # from one segment of the friction curve to the next
            energy = self._impact_energy(part.index, float(speed)) if kind == "impact" else 0.0
            place = f"{part.kind} {part.index + 1}"
            found.append(Event(float(time * self.plant.dt), kind, place, float(speed), energy))
        return tuple(found)

    def _impact_energy(self, shaft: int, speed: float) -> float:
        """½·J·speed² with the reduced inertia of the shaft's ends; a held end counts as infinitely heavy."""
        held = self.plant.drivetrain.locked_inertia
        inertias = self.plant.drivetrain.inertias
        inverse = sum(1.0 / inertias[i] for i in (shaft, shaft + 1) if i != held)
        return 0.5 * speed**2 / inverse

    def recording(
        self, made: Mapping[str, NDArray[np.float64]], inputs: NDArray[np.float64], energy: bool, **final: Any
    ) -> Recording:
        """The finished run: `made` holds (n,) torques and law outputs, beside the plant's own signals."""
        plant_signals = {name: values[:-1] for name, values in self.signals().items()}
        signals = {**made, **plant_signals}
        if energy:
            from .energy import energies

            count = int(self.cursor[2])
            signals |= energies(self.plant, self.states, self.modes, inputs, self.events[:count])
        return Recording(
            time=np.arange(self.length, dtype=float) * self.plant.dt,
            signals=signals,
            origin={name: "simulated" for name in signals},
            events=self.event_list(),
            final_state={
                "names": self.plant.layout.names(),
                "state": tuple(float(v) for v in self.states[-1]),
                "digits": tuple(int(d) for d in self.digits),
                "torque_motor": float(inputs[-1, 0]),
                **final,
            },
        )


def _passing(rows: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Pairs of events that enter and leave one digit at once: a speed that passes through rest does not stick."""
    again = (rows[1:, :2] == rows[:-1, :2]).all(axis=1) & (rows[1:, 2] == rows[:-1, 3])
    passing = np.zeros(len(rows), dtype=bool)
    passing[1:] |= again
    passing[:-1] |= again
    return passing
