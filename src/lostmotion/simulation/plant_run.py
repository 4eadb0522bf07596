"""One simulation of a plant: its arrays, the loop around the kernel, and the recording that comes of it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from .event_rows import KernelEvents
from .inputs import last_set_point
from .tables import Plant

Array = NDArray[np.float64]

#: Samples whose states are kept at once where only signals are wanted (numerics: they fit a core's own cache;
#: of 1 to 64 thousand the fastest).
BLOCK = 4096


class PlantRun:
    """The arrays of one simulation, and the loop that makes room for contact states and events as the kernel asks."""

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
        self.work = new_work(layout.states)
        self.keep_states(of_all=False)
        self.events = np.empty((4096, EVENT_COLUMNS + layout.states))
        self.cursor = np.array([0.0, 0.0, 0.0, 0.0, last_set_point(state), 0.0])

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

    def keep_states(self, *, of_all: bool) -> None:
        """Room for the states of all samples, or of one block: the kernel works block by block as there is room."""
        rows = (self.length if of_all else min(self.length, BLOCK)) + 1
        self.states = np.empty((rows, self.plant.layout.states))
        self.modes = np.empty(rows, dtype=np.int64)

    @property
    def two_mass(self) -> bool:
        """Whether the kernels for two masses, one torque and two elements know the plant."""
        layout = self.plant.layout
        return (layout.states, len(layout.inputs), len(self.plant.elements)) == (4, 1, 2)

    def finish(self, kernel: Callable[[Any], int]) -> None:
        """Runs the kernel to the end of the recording; numba compiles or loads it on the first call."""
        from ..kernels.plant.event_loop import CHATTERING, DONE, NEED_EVENT_SPACE, NEED_MODE

        while True:
            status = kernel(self.plant.entered())
            if status == DONE:
                return
            if status == NEED_MODE:
                self.plant.grow()
            elif status == NEED_EVENT_SPACE:
                self.events = np.concatenate([self.events, np.empty_like(self.events)])
            elif status == CHATTERING:
                raise InvalidInput(
                    "simulate",
                    f"endlessly many events at t = {self.cursor[0] * self.plant.dt:g} s",
                    "a plant whose contacts do not chatter",
                    "Give the shaft some damping, or check inertias and stiffness for wrong units.",
                )

    def signals(self) -> Array:
        """(signals, n): all signals of the plant, from the states of all samples."""
        from ..kernels.plant.signals import fill_signals

        values = np.empty((len(self.plant.signal_names()), self.length))
        fill_signals(self.plant.entered(), self.states, self.modes, 0, self.length, values)
        return values

    def recording(
        self, made: Mapping[str, Array], inputs: Array, values: Array, energy: bool, **final: Any
    ) -> Recording:
        """The finished run.

        Parameters
        ----------
        made : mapping of name → (n,) array
            Torques and law outputs.
        inputs : (n, M) array
            Torques on the plant.
        values : (signals, n) array
            The plant's own signals.
        """
        plant, events = self.plant, self.events[: int(self.cursor[2])]
        signals = {**made, **dict(zip(plant.signal_names(), values, strict=True))}
        if energy:
            from .energy import energies

            signals |= energies(plant, self.states, self.modes, inputs, events)
        last = self.states[(self.length - 1) % (len(self.states) - 1) + 1]
        return Recording(
            time=time_axis(self.length, plant.dt),
            signals={name: read_only(array) for name, array in signals.items()},
            origin=dict.fromkeys(signals, "simulated"),
            events=KernelEvents(events[:, :5].copy(), plant.drivetrain, plant.elements, plant.dt),
            final_state={
                "names": plant.layout.names(),
                "state": tuple(last.tolist()),
                "digits": tuple(self.digits.tolist()),
                "torque_motor": float(inputs[-1, 0]),
                **final,
            },
        )


@lru_cache(maxsize=1)
def time_axis(length: int, dt: float) -> Array:
    """0, dt, 2 dt, …, s; the last one is kept, since simulations come in series."""
    return read_only(np.arange(length, dtype=float) * dt)


def read_only(array: Array) -> Array:
    """An array of our own, handed over: it can no longer be written, nor what it is a part of."""
    part: Any = array
    while isinstance(part, np.ndarray):
        part.setflags(write=False)
        part = part.base
    return array
