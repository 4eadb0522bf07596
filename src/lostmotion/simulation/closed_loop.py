"""A drivetrain with a law in the loop: which signal of whom is which input of the law, then the kernel."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from ..systems import DiscreteSystem, connect
from .sensors import Sensor, disturbance
from .simulate import PlantRun, check_lengths, plant_inputs

if TYPE_CHECKING:
    from ..kernels.closed_loop import SensorTables

Array = NDArray[np.float64]

#: Relative difference up to which two sample times count as equal (chosen: rounding).
_SAME_TIME = 1e-9


def simulate_law(
    drivetrain: Drivetrain,
    law: DiscreteSystem | Sequence[DiscreteSystem],
    dt: float,
    given: Mapping[str, Array],
    state: Sequence[float] | Mapping[str, Any] | None,
    delay: int,
    sensors: Mapping[str, Sensor],
    seed: int,
    energy: bool,
) -> Recording:
    """``simulate`` with a law; `given` holds checked (n,) signals from outside."""
    if not isinstance(law, DiscreteSystem):
        law = _joined(tuple(law))
    every = round(law.dt / dt)
    if every < 1 or abs(law.dt / (every * dt) - 1.0) > _SAME_TIME:
        raise InvalidInput(
            "simulate.dt",
            f"{dt} s",
            f"a whole fraction of the law's sample time, {law.dt} s",
            "Choose another.",
        )
    if not isinstance(delay, int) or delay < 0:
        raise InvalidInput("simulate.delay", repr(delay), "zero or more samples", "Give a whole number.")
    if not given:
        raise InvalidInput(
            "simulate", "no signal of known length", "a set-point or a torque", "Give speed_reference."
        )
    length = check_lengths(given)
    names = plant_inputs(drivetrain, given)
    run = PlantRun(drivetrain, dt, names, state, length)
    wiring = _Wiring(run, law, given, sensors, names)

    from ..kernels.closed_loop import run_closed_loop

    law_state = np.concatenate([law.initial_state, np.zeros(len(law.inputs))])
    torque = np.zeros((length, len(names)))
    measured = np.zeros((length, len(law.inputs)))
    outputs = np.zeros((length + delay, len(law.outputs)))
    columns = np.column_stack(list(given.values()))
    noise = disturbance(sensors, law.inputs, length, seed)
    last = np.full(len(law.inputs), np.nan)
    law_tables = law.tables()
    law_work = np.zeros(len(law.states) + len(law.inputs) + len(law.curves))
    law_inputs, law_outputs = np.zeros(len(law.inputs)), np.zeros(len(law.outputs))
    limit, step = drivetrain.actuator.torque_limit, drivetrain.actuator.rate_limit * dt
    run.finish(
        lambda tables: run_closed_loop(
            tables, run.s, run.digits, columns, wiring.drive, every, delay, limit, step, law_tables, law_state,
            wiring.tables(last, noise), dt, run.work, run.states, run.modes, torque, measured, outputs, law_work,
            law_inputs, law_outputs, run.events, run.cursor,
        )
    )  # fmt: skip
    made = {name: outputs[delay : length + delay, i] for i, name in enumerate(law.outputs)}
    made |= {name: values for name, values in given.items()}
    made |= {name: torque[:, j] for j, name in enumerate(names)}
    made |= {f"{name}_measured": measured[:, i] for i, name in enumerate(law.inputs) if name in sensors}
    return run.recording(made, torque, energy, law=law_state[: len(law.states)].copy())


def _joined(laws: tuple[DiscreteSystem, ...]) -> DiscreteSystem:
    """Several laws as one: all their outputs, and as inputs what none of them makes."""
    outputs = tuple(name for law in laws for name in law.outputs)
    inputs = tuple(dict.fromkeys(name for law in laws for name in law.inputs if name not in outputs))
    return connect(laws, inputs=inputs, outputs=outputs)


class _Wiring:
    """Sources of the law's inputs and of the plant's inputs."""

    def __init__(
        self,
        run: PlantRun,
        law: DiscreteSystem,
        given: Mapping[str, Array],
        sensors: Mapping[str, Sensor],
        names: tuple[str, ...],
    ) -> None:
        self.plant = run.plant
        self.signals = run.plant.signal_names()
        columns = list(given)
        self.sensors = [sensors.get(name, Sensor(name)) for name in law.inputs]
        unknown = sorted(set(sensors) - set(law.inputs))
        if unknown:
            raise InvalidInput(
                "simulate.sensors", f"{unknown}", f"inputs of the law {law.inputs}", "Check the names."
            )
        self.source = np.array([self._source(s.source, columns) for s in self.sensors], dtype=np.int64)
        unread = sorted(set(given) - set(law.inputs) - set(names))
        if unread:
            raise InvalidInput(
                "simulate",
                f"signals {unread} that nobody reads",
                f"inputs of the law {law.inputs}",
                "Check the names.",
            )
        self.drive = np.array([self._drive(name, law.outputs, columns) for name in names], dtype=np.int64)

    def _source(self, name: str, given: list[str]) -> int:
        if name in given:
            return -1 - given.index(name)
        if name in self.signals:
            return self.signals.index(name)
        raise InvalidInput(
            f"law input {name!r}",
            "no such signal",
            f"a given signal or one of {self.signals}",
            "Give it to simulate.",
        )

    @staticmethod
    def _drive(name: str, outputs: tuple[str, ...], given: list[str]) -> int:
        if name in given:
            return -1 - given.index(name)
        if name in outputs:
            return outputs.index(name)
        raise InvalidInput(
            f"simulate: {name}",
            f"a law with outputs {outputs}",
            f"an output {name!r}, or {name} given",
            "Add it.",
        )

    def tables(self, last: Array, noise: Array) -> SensorTables:
        from ..kernels.closed_loop import SensorTables

        return SensorTables(
            signal=np.array([self.plant.signal_rows(mode) for mode in self.plant.modes]),
            source=self.source,
            resolution=np.array([s.resolution for s in self.sensors]),
            difference=np.array([int(s.difference) for s in self.sensors], dtype=np.int64),
            last=last,
            disturbance=noise,
        )
