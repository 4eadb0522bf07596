"""Laws in the loop of a plant: who reads what, whose torque acts when, and the recording that comes of it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import InvalidInput
from ..recording import Recording
from ..systems import DiscreteSystem, Stepper
from .moved_end import MovedEnd
from .plant_run import PlantRun
from .sensors import Sensor, disturbance

if TYPE_CHECKING:
    from ..kernels.loop.laws import Loop

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Law = DiscreteSystem | Stepper


@dataclass(frozen=True, eq=False)
class LawsInLoop:
    """What runs in the loop.

    Parameters
    ----------
    laws : tuple of DiscreteSystem or Stepper
        In the order in which they are stepped.
    every, delay : tuple of int, one for each law
        Samples of the plant from one step to the next, and from a step until its torque acts.
    given : mapping of name → (n,) array
    sensors : mapping of law input → Sensor
    moved : MovedEnd, optional
    """

    laws: tuple[Law, ...]
    every: tuple[int, ...]
    delay: tuple[int, ...]
    given: Mapping[str, Array]
    sensors: Mapping[str, Sensor]
    moved: MovedEnd | None = None

    @property
    def inputs(self) -> tuple[str, ...]:
        """Inputs of all laws, one behind the other."""
        return tuple(name for law in self.laws for name in law.inputs)

    @property
    def outputs(self) -> tuple[str, ...]:
        return tuple(name for law in self.laws for name in law.outputs)

    def law_of_output(self, output: int) -> int:
        return int(np.searchsorted(np.cumsum([len(law.outputs) for law in self.laws]), output, side="right"))

    def simulate(self, run: PlantRun, seed: int, energy: bool) -> Recording:
        """Runs the plant to its end."""
        from ..kernels.loop.blocks import run_with_laws
        from ..kernels.loop.laws import ALGEBRAIC_LOOP

        loop, steps, kept = self.tables(run, seed)
        run.keep_states(of_all=energy)
        values = np.empty((len(run.plant.signal_names()), run.length))

        def kernel(entered: Any) -> int:
            status = run_with_laws(
                entered, run.two_mass, run.s, run.digits, loop, steps, run.work, run.states, run.modes, run.events,
                run.cursor, values,
            )  # fmt: skip
            if status == ALGEBRAIC_LOOP:
                raise self._algebraic_loop(int(run.cursor[0]))
            return int(status)

        run.finish(kernel)
        del kept  # the laws' numbers, which the kernel reads by their address
        states = tuple(np.split(loop.state, loop.state_start[1:-1])) if self.laws else ()
        final = {"law": tuple(state.copy() for state in states)} if states else {}
        return run.recording(self._made(run, loop), loop.torque, values, energy, **final)

    def tables(self, run: PlantRun, seed: int) -> tuple[Loop, Any, list[Any]]:
        """The kernel's view, the steppers' step functions, and what must live as long as that view."""
        from ..kernels.loop import laws as kernel

        length, inputs, plant = run.length, self.inputs, run.plant
        steps, kept = kernel.no_steps(), []
        codes, numbers = [], []
        for law in self.laws:
            if isinstance(law, Stepper):
                codes.append(0)
                numbers.append(len(steps))
                kernel.add_step(steps, law.functions.step)
            else:
                tables = law.tables()
                kept.append(tables)
                codes.append(tables.code)
                numbers.append(tables.numbers.ctypes.data)
        parameters = [law.parameters if isinstance(law, Stepper) else np.zeros(0) for law in self.laws]
        states = [law.init() for law in self.laws]
        state = np.concatenate([np.zeros(0), *states])
        kinds = {"plant": kernel.PLANT, "given": kernel.GIVEN, "made": kernel.MADE, "acting": kernel.ACTING}
        sources = [self._source(name, run) for name in inputs]
        sensors = [self.sensors.get(name, Sensor(name)) for name in inputs]
        drivers = [self._driver(name) for name in plant.layout.inputs]
        actuator = plant.drivetrain.actuator
        loop = kernel.Loop(
            code=_indices(codes),
            numbers=_indices(numbers),
            parameters=np.concatenate([np.zeros(0), *parameters]),
            parameter_start=_starts(parameters),
            state=state,
            state_start=_starts(states),
            input_start=_starts([law.inputs for law in self.laws]),
            output_start=_starts([law.outputs for law in self.laws]),
            every=_indices(self.every),
            late=_indices(self._late(number, run) for number in range(len(self.laws))),
            kind=_indices(kinds[kind] for kind, _ in sources),
            at=_indices(at for _, at in sources),
            exact=_indices(sensor.exact for sensor in sensors),
            resolution=np.array([sensor.resolution for sensor in sensors], dtype=float),
            difference=_indices(sensor.difference for sensor in sensors),
            last=np.full(len(inputs), np.nan),
            disturbance=disturbance(self.sensors, inputs, length, seed),
            driver=_indices(drivers),
            delay=_indices(self.delay[self.law_of_output(d)] if d >= 0 else 0 for d in drivers),
            limits=np.array([actuator.torque_limit, actuator.rate_limit * plant.dt]),
            slot=-1 if self.moved is None else plant.layout.speed(self.moved.inertia),
            speed=np.zeros(0) if self.moved is None else self.moved.speed,
            given=np.column_stack([np.empty((length, 0)), *self.given.values()]),
            torque=np.empty((length, len(drivers))),
            measured=np.empty((length, len(inputs))),
            outputs=np.empty((length, len(self.outputs))),
            faults=np.zeros((length, len(self.laws)), dtype=np.int64),
            trial=np.empty(state.size),
            now=np.empty(len(inputs)),
            made=np.empty(len(self.outputs)),
            good=np.empty(len(inputs)),
            dt=plant.dt,
        )
        return loop, steps, kept

    def _late(self, number: int, run: PlantRun) -> bool:
        """Whether law `number` reads within the sample what it or a later one makes."""
        for name in self.laws[number].inputs:
            kind, at = self._source(name, run)
            makers = []
            if kind == "made":
                makers = [self.law_of_output(at)]
            elif kind == "acting" and (output := self._driver(run.plant.layout.inputs[at])) >= 0:
                makers = [m for m in [self.law_of_output(output)] if self.delay[m] == 0]
            if any(maker >= number for maker in makers):
                return True
        return False

    def _driver(self, torque: str) -> int:
        """The output that drives a torque on the plant; −1 − its column where it is given."""
        return -1 - list(self.given).index(torque) if torque in self.given else self.outputs.index(torque)

    def _source(self, name: str, run: PlantRun) -> tuple[str, int]:
        """Kind and place of what a law's input reads."""
        name = self.sensors[name].source if name in self.sensors else name
        signals = run.plant.signal_names()
        places: dict[str, Sequence[str]] = {
            "acting": run.plant.layout.inputs, "made": self.outputs, "given": tuple(self.given), "plant": signals,
        }  # fmt: skip
        for kind, names in places.items():
            if name in names:
                return kind, names.index(name)
        raise InvalidInput(
            f"law input {name!r}", "no such signal", f"a given signal, an output of a law, or one of {signals}",
            "Give it to simulate.",
        )  # fmt: skip

    def _algebraic_loop(self, sample: int) -> InvalidInput:
        names = ", ".join(law.name for law in self.laws)
        return InvalidInput(
            "simulate",
            f"an algebraic loop through the laws {names} in sample {sample}",
            "no signal that depends on itself within one sample",
            "Give a computing delay, or insert one_sample_delay(signal, dt).",
        )

    def _made(self, run: PlantRun, loop: Loop) -> dict[str, Array]:
        """All signals beside the plant's own."""
        made = {name: loop.outputs[:, i] for i, name in enumerate(self.outputs)}
        made |= dict(self.given)
        made |= {name: loop.torque[:, j] for j, name in enumerate(run.plant.layout.inputs)}
        # Of an input that several laws read, the reading of the one that reads most often.
        seldom_first = sorted(range(len(self.laws)), key=lambda law: -self.every[law])
        for law in seldom_first:
            for i, name in enumerate(self.laws[law].inputs):
                if name in self.sensors:
                    made[f"{name}_measured"] = loop.measured[:, loop.input_start[law] + i]
        names = _distinct([part.name for part in self.laws])
        for number, part in enumerate(self.laws):
            if isinstance(part, Stepper) or part.checks:
                made[f"input_fault_{names[number]}"] = (loop.faults[:, number] != 0).astype(float)
        return made


def _distinct(names: Sequence[str]) -> list[str]:
    """Names of which several laws have one get a number each, from 1 on in their order."""
    made: list[str] = []
    for i, name in enumerate(names):
        number, new = names[:i].count(name) + 1, name
        while names.count(name) > 1 and (new in names or new in made):
            new, number = f"{name}_{number}", number + 1
        made.append(new)
    return made


def _indices(numbers: Iterable[int]) -> Indices:
    return np.array(list(numbers), dtype=np.int64)


def _starts(parts: Sequence[Any]) -> Indices:
    return np.cumsum([0, *(len(part) for part in parts)]).astype(np.int64)
