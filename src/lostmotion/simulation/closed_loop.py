"""A drivetrain with laws in the loop: which signal of whom is which input of a law, then the kernel.

DiscreteSystems of one sample time are joined and run in a kernel of their own; ``mixed_loop`` runs all else.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from ..systems import DiscreteSystem, connect
from .inputs import check_lengths, plant_inputs, possible_inputs
from .mixed_loop import Law, MixedLoop
from .moved_end import MovedEnd
from .plant_run import PlantRun
from .sensors import Sensor, disturbance

if TYPE_CHECKING:
    from ..kernels.loop.one_law import SensorTables

Array = NDArray[np.float64]

#: Relative difference up to which two sample times count as equal (chosen: rounding).
_SAME_TIME = 1e-9


def simulate_law(
    drivetrain: Drivetrain,
    law: Law | Sequence[Law],
    dt: float,
    given: Mapping[str, Array],
    state: Sequence[float] | Mapping[str, Any] | None,
    delay: int | Sequence[int],
    sensors: Mapping[str, Sensor],
    seed: int,
    energy: bool,
    moved: MovedEnd | None,
) -> Recording:
    """``simulate`` with laws; `given` holds checked (n,) signals from outside."""
    laws = _laws(law)
    every = tuple(_samples(part, dt) for part in laws)
    delays = _delays(delay, len(laws))
    if not given:
        raise InvalidInput(
            "simulate", "no signal of known length", "a set-point or a torque", "Give speed_reference."
        )
    length = check_lengths(given)
    _check_makers(laws, given, possible_inputs(drivetrain))
    made = [name for part in laws for name in part.outputs]
    names = plant_inputs(drivetrain, {**given, **dict.fromkeys(made)})
    _check_wiring(laws, given, sensors, names, made)
    run = PlantRun(drivetrain, dt, names, state, length)
    if moved is not None:
        moved.place(run.plant.layout, run.s)
    joined = None if moved is not None and moved.jumps else _joined(laws, every, delays, sensors, run)
    if joined is None:
        return MixedLoop(laws, every, delays, given, sensors, moved).simulate(run, seed, energy)
    return _simulate_joined(run, joined, every[0], delays[0], given, sensors, seed, energy)


def _simulate_joined(
    run: PlantRun,
    law: DiscreteSystem,
    every: int,
    delay: int,
    given: Mapping[str, Array],
    sensors: Mapping[str, Sensor],
    seed: int,
    energy: bool,
) -> Recording:
    """The kernel with one DiscreteSystem."""
    drivetrain, dt, length, names = run.plant.drivetrain, run.plant.dt, run.length, run.plant.layout.inputs
    wiring = _Wiring(run, law, given, sensors, names)
    run.keep_states(of_all=energy)
    from ..kernels.loop.closed_loop import run_with_law
    from ..kernels.loop.one_law import LoopTables

    law_state, tables = law.init(), law.tables()
    torque = np.empty((length, len(names)))
    measured = np.empty((length, len(law.inputs)))
    outputs = np.empty((length + delay, len(law.outputs)))
    outputs[:delay] = 0.0
    noise = disturbance(sensors, law.inputs, length, seed)
    last = np.full(len(law.inputs), np.nan)
    columns, faults = np.column_stack(list(given.values())), np.zeros(length, dtype=np.int64)
    limit, step = drivetrain.actuator.torque_limit, drivetrain.actuator.rate_limit * dt
    loop = LoopTables(
        wiring.tables(last, noise), columns, wiring.drive, every, delay, limit, step, dt, tables.code,
        tables.numbers, law_state, torque, measured, outputs, faults,
    )  # fmt: skip
    values = np.empty((len(run.plant.signal_names()), length))
    run.finish(
        lambda entered: run_with_law(
            entered, run.two_mass, run.s, run.digits, loop, run.work, run.states, run.modes, run.events,
            run.cursor, values,
        )
    )  # fmt: skip
    made = {name: outputs[delay : length + delay, i] for i, name in enumerate(law.outputs)}
    made |= {name: values for name, values in given.items()}
    made |= {name: torque[:, j] for j, name in enumerate(names)}
    made |= {f"{name}_measured": measured[:, i] for i, name in enumerate(law.inputs) if name in sensors}
    if law.checks:
        made[f"input_fault_{law.name}"] = (faults != 0).astype(float)
    return run.recording(made, torque, values, energy, law=law_state[: len(law.states)].copy())


def _laws(law: Law | Sequence[Law]) -> tuple[Law, ...]:
    """One law or several, checked."""
    laws = (law,) if isinstance(law, Law) else tuple(law) if isinstance(law, Sequence) else ()
    if not laws or not all(isinstance(part, Law) for part in laws):
        raise InvalidInput(
            "simulate.law",
            f"{law!r:.100}",
            "a DiscreteSystem, a Stepper, or a sequence of them",
            "Give the law.",
        )
    return laws


def _samples(law: Law, dt: float) -> int:
    """Samples of the plant (dt in s) from one step of the law to the next."""
    every = round(law.dt / dt)
    if every < 1 or abs(law.dt / (every * dt) - 1.0) > _SAME_TIME:
        raise InvalidInput(
            "simulate.dt",
            f"{dt} s",
            f"a whole fraction of the sample time of {law.name}, {law.dt} s",
            "Choose another.",
        )
    return every


def _delays(delay: int | Sequence[int], laws: int) -> tuple[int, ...]:
    """The computing delay of each law."""
    delays = (delay,) * laws if isinstance(delay, int) else tuple(delay)
    if len(delays) != laws or any(not isinstance(d, int) or d < 0 for d in delays):
        raise InvalidInput(
            "simulate.delay",
            repr(delay),
            f"zero or more samples, one number or one for each of the {laws} laws",
            "Give whole numbers.",
        )
    return delays


def _check_makers(laws: Sequence[Law], given: Mapping[str, Array], torques: tuple[str, ...]) -> None:
    """Every signal has one maker; only a torque may be given although a law makes it: that law then watches."""
    made = [name for law in laws for name in law.outputs]
    twice = sorted({n for n in made if made.count(n) > 1} | (set(given) & set(made) - set(torques)))
    if twice:
        raise InvalidInput(
            f"simulate: {', '.join(twice)}",
            "made or given twice",
            "one maker of each signal",
            "Rename with renamed().",
        )


def _check_wiring(
    laws: Sequence[Law],
    given: Mapping[str, Array],
    sensors: Mapping[str, Sensor],
    names: tuple[str, ...],
    made: Sequence[str],
) -> None:
    """The motor has a torque, and all that is given is read."""
    inputs = {name for law in laws for name in law.inputs}
    read = inputs | {sensor.source for sensor in sensors.values()} | set(names)
    checks = (
        (sorted(set(sensors) - inputs), "simulate.sensors", f"inputs of the laws {sorted(inputs)}"),
        (
            sorted(set(given) - read),
            "simulate: signals that nobody reads",
            f"inputs of the laws {sorted(inputs)}",
        ),
    )
    for wrong, where, expected in checks:
        if wrong:
            raise InvalidInput(where, f"{wrong}", expected, "Check the names.")
    if "torque_motor" not in given and "torque_motor" not in made:
        raise InvalidInput(
            "simulate: torque_motor",
            f"laws with outputs {tuple(made)}",
            "an output 'torque_motor', or torque_motor given",
            "Add it.",
        )


def _joined(
    laws: tuple[Law, ...],
    every: tuple[int, ...],
    delays: tuple[int, ...],
    sensors: Mapping[str, Sensor],
    run: PlantRun,
) -> DiscreteSystem | None:
    """Several laws as one: all their outputs, and as inputs what none of them makes; None where that cannot be.

    A law that reads a torque reads what acts, after limits and delay: joined, it would read what another law makes.
    """
    systems = [law for law in laws if isinstance(law, DiscreteSystem)]
    if len(systems) < len(laws) or len(set(every)) > 1 or len(set(delays)) > 1:
        return None
    actuator = run.plant.drivetrain.actuator
    exact = delays[0] == 0 and math.isinf(actuator.torque_limit) and math.isinf(actuator.rate_limit)
    outputs = tuple(name for law in systems for name in law.outputs)
    inputs = tuple(dict.fromkeys(name for law in systems for name in law.inputs))
    sources = [sensors[name].source if name in sensors else name for name in inputs]
    torques = set(sources) & set(run.plant.layout.inputs)
    sensed = any(name in sensors and source in outputs for name, source in zip(inputs, sources, strict=True))
    if (torques and not exact) or sensed or (set(sensors) & set(outputs)):
        return None
    if len(systems) == 1:
        return None if set(inputs) & set(outputs) else systems[0]
    # Joined, all readers of an input would share one check, and a law that only watches would change the loop.
    for name in inputs:
        checks = {
            next((c for c in law.checks if c.input == name), None) for law in systems if name in law.inputs
        }
        if len(checks) > 1:
            return None
    return connect(systems, inputs=tuple(name for name in inputs if name not in outputs), outputs=outputs)


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
        self.signals = run.plant.signal_names()
        columns = list(given)
        self.sensors = [sensors.get(name, Sensor(name)) for name in law.inputs]
        self._resolution = np.array([s.resolution for s in self.sensors], dtype=float)
        self._difference = np.array([s.difference for s in self.sensors], dtype=np.int64)
        self._exact = np.array([s == Sensor(s.source) for s in self.sensors], dtype=np.int64)
        self.source = np.array([self._source(s.source, columns) for s in self.sensors], dtype=np.int64)
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
        return -1 - given.index(name) if name in given else outputs.index(name)

    def tables(self, last: Array, noise: Array) -> SensorTables:
        from ..kernels.loop.one_law import SensorTables

        return SensorTables(
            source=self.source,
            resolution=self._resolution,
            difference=self._difference,
            last=last,
            disturbance=noise,
            exact=self._exact,
        )
