"""simulate: a drivetrain under given torques, or under a law in the loop, exactly from event to event."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Event, Recording
from ..systems import DiscreteSystem, Stepper
from .modes import GAP
from .moved_end import moved_end, started
from .sensors import Sensor
from .tables import Plant


def simulate(
    drivetrain: Drivetrain,
    *,
    dt: float,
    torque_motor: ArrayLike | None = None,
    torque_load: ArrayLike | None = None,
    law: DiscreteSystem | Stepper | Sequence[DiscreteSystem | Stepper] | None = None,
    state: Sequence[float] | Mapping[str, Any] | None = None,
    delay: int | Sequence[int] = 0,
    sensors: Mapping[str, Sensor] | None = None,
    seed: int = 0,
    energy: bool = False,
    **signals: ArrayLike,
) -> Recording:
    """Simulate a drivetrain exactly, torques held over each sample, with or without a law in the loop.

    Parameters
    ----------
    drivetrain : Drivetrain
        A chain of n inertias; backlash on any shaft, set-valued friction at any inertia.
    dt : float, s
        Sample time of the plant.
    torque_motor, torque_load : (n,) arrays, Nm
        Torque into the first and into the last inertia, positive in the direction of positive speed.
    law : DiscreteSystem, Stepper, or sequence of them, optional
        Each at its own sample time, `dt` or a multiple of it; its outputs are held from step to step. Reads by name
        the given `signals`, the outputs of the other laws, and the plant's signals. Its output ``torque_motor`` (or
        another torque's name) drives the plant, unless that torque is given: then it only watches. As an *input*
        a torque is what acts on the plant in this sample, after limits and delay, as it is recorded. All outputs are
        recorded, and ``input_fault_<name>`` of a law that checks its inputs; where laws share a name, ``<name>_1``,
        ``<name>_2`` … in their order.
    state : sequence or mapping, optional
        Start: ``twist, speed_motor, speed_load`` for two masses (n − 1 twists, then n speeds, for a chain), or the
        ``final_state`` of an earlier recording, to go on from (laws start anew). Default: at rest in the middle of
        the gap.
    delay : int, or sequence of int for each law
        Computing delay in samples of the plant: the torque computed at sample k acts from sample k + delay on.
    sensors : mapping of law input → Sensor, optional
        What the law sees; default: the plant's signals as they are.
    seed : int
        Seed of the sensors' noise.
    energy : bool
        Whether to integrate energies as well, see ``Recording.energy``.
    **signals : (n,) arrays
        Inputs of the law that do not come from the plant, such as ``speed_reference``; torques into other inertias by
        their number, ``torque_1`` to ``torque_n`` (Nm); the speed or the angle of a held end, ``speed_load`` (rad/s) or
        ``angle_load`` (rad), or of the motor, linear from sample to sample: see ``moved_end``.

    Returns
    -------
    Recording
        Row k holds the state before torque k acts. ``events``: impacts, separations, sticking, slipping.
        ``final_state``: the state after the last torque.

    Raises
    ------
    InvalidInput
        For NaN, wrong lengths, a sample time that is not positive, signals that nobody reads or makes, a signal that
        depends on itself within one sample.
    """
    given = {"torque_motor": torque_motor, "torque_load": torque_load, **signals}
    values = {name: check_signal(name, array) for name, array in given.items() if array is not None}
    check_sample_time(dt)
    moved = moved_end(drivetrain, dt, values)
    if moved is not None:
        for kind in ("speed", "angle"):
            values.pop(f"{kind}_{drivetrain.locked}", None)
        values[f"acceleration_{drivetrain.locked}"] = moved.acceleration
    state = started(drivetrain, state, moved)
    if law is not None:
        from .closed_loop import simulate_law

        return simulate_law(drivetrain, law, dt, values, state, delay, sensors or {}, seed, energy, moved)
    known = possible_inputs(drivetrain)
    if not values or set(values) - set(known):
        raise InvalidInput(
            "simulate",
            f"signals {sorted(values)} and no law",
            f"some of {known}, or a law",
            "Give the torque.",
        )
    length = check_lengths(values)
    names = plant_inputs(drivetrain, values)
    run = PlantRun(drivetrain, dt, names, state, length)
    if moved is not None:
        moved.place(run.plant.layout, run.s)
        if moved.jumps:
            from .mixed_loop import MixedLoop

            torques = {name: values.get(name, np.zeros(length)) for name in names}
            return MixedLoop((), (), (), torques, {}, moved).simulate(run, seed, energy)
    inputs = np.column_stack([values.get(name, np.zeros(length)) for name in names])
    inputs[:, 0] = _set_point(drivetrain, inputs[:, 0], dt, state)
    from ..kernels.plant import run_open_loop
    from ..kernels.two_mass import run_open_loop_two_mass

    usual = (run.plant.layout.states, len(names), len(run.plant.elements)) == (4, 1, 2)
    kernel = run_open_loop_two_mass if usual else run_open_loop
    run.finish(
        lambda tables: kernel(
            tables, run.s, run.digits, inputs, run.work, run.states, run.modes, run.events, run.cursor
        )
    )
    return run.recording({name: inputs[:, j] for j, name in enumerate(names)}, inputs, energy)


def possible_inputs(drivetrain: Drivetrain) -> tuple[str, ...]:
    """All inputs that a plant can have: torques, and the acceleration of an end that is moved."""
    by_index = (f"torque_{i + 1}" for i in range(len(drivetrain.inertias)))
    moved = () if drivetrain.locked is None else (f"acceleration_{drivetrain.locked}",)
    return ("torque_motor", "torque_load", *by_index, *moved)


def plant_inputs(drivetrain: Drivetrain, signals: Mapping[str, Any]) -> tuple[str, ...]:
    """The plant's inputs: the motor torque, and what else is given."""
    return tuple(name for name in possible_inputs(drivetrain) if name == "torque_motor" or name in signals)


def _set_point(
    drivetrain: Drivetrain, torque: NDArray[np.float64], dt: float, state: Any
) -> NDArray[np.float64]:
    """The torque set-point within the actuator's limits."""
    actuator = drivetrain.actuator
    torque = np.clip(torque, -actuator.torque_limit, actuator.torque_limit)
    if math.isfinite(actuator.rate_limit):
        from ..kernels.rate_limit import limit_rate

        torque = limit_rate(torque, actuator.rate_limit * dt, last_set_point(state))
    return torque


def last_set_point(state: Any) -> float:
    """Torque set-point before the first sample: that of the recording which is gone on from."""
    return float(state.get("torque_motor", 0.0)) if isinstance(state, Mapping) else 0.0


def check_sample_time(dt: float) -> None:
    if not (math.isfinite(dt) and dt > 0.0):
        raise InvalidInput("simulate.dt", repr(dt), "a positive sample time in s", "Give the sample time.")


def check_signal(name: str, values: ArrayLike) -> NDArray[np.float64]:
    """A one-dimensional finite signal."""
    array = np.asarray(values, dtype=float)
    if array.ndim != 1 or array.size < 2:
        raise InvalidInput(
            name, f"shape {array.shape}", "a one-dimensional array of two or more samples", "Reshape."
        )
    bad = np.flatnonzero(~np.isfinite(array))
    if bad.size:
        raise InvalidInput(
            name,
            f"{array[bad[0]]} in sample {bad[0]}",
            "finite numbers",
            "Remove or interpolate bad samples.",
        )
    return np.ascontiguousarray(array)


def check_lengths(signals: Mapping[str, NDArray[np.float64]]) -> int:
    lengths = {name: values.size for name, values in signals.items()}
    if len(set(lengths.values())) != 1:
        raise InvalidInput("simulate", f"lengths {lengths}", "signals of one length", "Crop or extend them.")
    return next(iter(lengths.values()))


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
        from ..kernels.plant import EVENT_COLUMNS
        from ..kernels.plant_tables import new_work

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
                    "Check.",
                )
            x[:expected] = start
        return self.plant.start_digits(x)

    def finish(self, kernel: Any) -> None:
        """Runs the kernel to the end of the recording; numba compiles or loads it on the first call."""
        from ..kernels.plant import CHATTERING, DONE, NEED_EVENT_SPACE, NEED_MODE

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
        from ..kernels.signals import same, signals_of, spans

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
