"""Laws of all kinds in one loop: DiscreteSystems and steppers, each at its own sample time and with its own delay."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
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
    from ..kernels.loop.several_laws import Drive, Laws, Readings

Array = NDArray[np.float64]
Law = DiscreteSystem | Stepper

#: Stands where no law is a DiscreteSystem.
_NO_LAW = DiscreteSystem(inputs=("none",), outputs=("none",), dt=1.0)


@dataclass(frozen=True, eq=False)
class MixedLoop:
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
        from ..kernels.loop.several_laws import ALGEBRAIC_LOOP, run_mixed_loop

        length, inputs = run.length, self.inputs
        laws = self._laws(run)
        steps, tables = self._steps()
        drive = self._drive(run)
        torque = np.zeros((length, len(run.plant.layout.inputs)))
        measured = np.zeros((length, len(inputs)))
        outputs = np.zeros((length, len(self.outputs)))
        faults = np.zeros((length, len(self.laws)), dtype=np.int64)
        columns = np.column_stack([np.zeros((length, 0)), *self.given.values()])
        noise = disturbance(self.sensors, inputs, length, seed)
        last = np.full(len(inputs), np.nan)
        trial, good = np.zeros(laws.state.size), np.zeros(len(inputs))
        readings = self._readings(run, last, noise)
        run.keep_states(of_all=True)

        def kernel(entered: Any) -> int:
            status = int(
                run_mixed_loop(
                    entered, run.s, run.digits, columns, drive, steps, tables, laws,
                    readings._replace(signal=entered.signal), run.plant.dt, run.work, run.states, run.modes,
                    torque, measured, outputs, faults, trial, good,
                    run.events, run.cursor,
                )
            )  # fmt: skip
            if status == ALGEBRAIC_LOOP:
                raise self._algebraic_loop(int(run.cursor[0]))
            return status

        run.finish(kernel)
        return self._recording(run, torque, measured, outputs, faults, laws, energy)

    def _steps(self) -> tuple[Any, Any]:
        """The steppers' functions and the DiscreteSystems' tables, for the kernel."""
        from ..kernels.loop.several_laws import add_step, add_tables, list_of_tables, no_steps

        steps, tables = no_steps(), None
        for law in self.laws:
            if isinstance(law, Stepper):
                add_step(steps, law.functions.step)
            elif tables is None:
                tables = list_of_tables(law.tables())
            else:
                add_tables(tables, law.tables())
        # The kernel is compiled for a list of tables, even where no law needs it.
        return steps, list_of_tables(_NO_LAW.tables()) if tables is None else tables

    def _laws(self, run: PlantRun) -> Laws:
        """All laws' numbers."""
        from ..kernels.loop.several_laws import Laws

        steppers = [isinstance(law, Stepper) for law in self.laws]
        numbers = [
            -sum(steppers[: i + 1]) if own else i - sum(steppers[:i]) for i, own in enumerate(steppers)
        ]
        parameters = [law.parameters if isinstance(law, Stepper) else np.zeros(0) for law in self.laws]
        states = [law.init() for law in self.laws]
        return Laws(
            number=np.array(numbers, dtype=np.int64),
            parameters=np.concatenate([np.zeros(0), *parameters]),
            parameter_start=_starts(parameters),
            state=np.concatenate([np.zeros(0), *states]),
            state_start=_starts(states),
            input_start=_starts([law.inputs for law in self.laws]),
            output_start=_starts([law.outputs for law in self.laws]),
            every=np.array(self.every, dtype=np.int64),
            late=np.array([self._late(number, run) for number in range(len(self.laws))], dtype=np.int64),
        )

    def _late(self, number: int, run: PlantRun) -> bool:
        """Whether law `number` reads within the sample what it or a later one makes."""
        for name in self.laws[number].inputs:
            kind, at = self._source(name, run)
            makers = []
            if kind == "made":
                makers = [self.law_of_output(at)]
            elif kind == "acting" and (output := self._driver(run.plant.layout.inputs[at])) is not None:
                makers = [m for m in [self.law_of_output(output)] if self.delay[m] == 0]
            if any(maker >= number for maker in makers):
                return True
        return False

    def _driver(self, torque: str) -> int | None:
        """The output that drives a torque on the plant; None if it is given."""
        return None if torque in self.given else self.outputs.index(torque)

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

    def _readings(self, run: PlantRun, last: Array, noise: Array) -> Readings:
        from ..kernels.loop import several_laws as kernel

        kinds = {"plant": kernel.PLANT, "given": kernel.GIVEN, "made": kernel.MADE, "acting": kernel.ACTING}
        sources = [self._source(name, run) for name in self.inputs]
        sensors = [self.sensors.get(name, Sensor(name)) for name in self.inputs]
        return kernel.Readings(
            kind=np.array([kinds[kind] for kind, _ in sources], dtype=np.int64),
            at=np.array([at for _, at in sources], dtype=np.int64),
            signal=np.zeros((0, 0, 0)),  # of each call's contact states
            resolution=np.array([s.resolution for s in sensors], dtype=float),
            difference=np.array([int(s.difference) for s in sensors], dtype=np.int64),
            last=last,
            disturbance=noise,
        )

    def _drive(self, run: PlantRun) -> Drive:
        from ..kernels.loop.several_laws import Drive

        given, actuator = list(self.given), run.plant.drivetrain.actuator
        sources = []
        for name in run.plant.layout.inputs:
            output = self._driver(name)
            sources.append(-1 - given.index(name) if output is None else output)
        return Drive(
            output=np.array(sources, dtype=np.int64),
            delay=np.array(
                [self.delay[self.law_of_output(o)] if o >= 0 else 0 for o in sources], dtype=np.int64
            ),
            limit=actuator.torque_limit,
            step=actuator.rate_limit * run.plant.dt,
            slot=-1 if self.moved is None else run.plant.layout.speed(self.moved.inertia),
            speed=np.zeros(0) if self.moved is None else self.moved.speed,
        )

    def _algebraic_loop(self, sample: int) -> InvalidInput:
        names = ", ".join(law.name for law in self.laws)
        return InvalidInput(
            "simulate",
            f"an algebraic loop through the laws {names} in sample {sample}",
            "no signal that depends on itself within one sample",
            "Give a computing delay, or insert one_sample_delay(signal, dt).",
        )

    def _recording(
        self,
        run: PlantRun,
        torque: Array,
        measured: Array,
        outputs: Array,
        faults: Any,
        laws: Laws,
        energy: bool,
    ) -> Recording:
        made = {name: outputs[:, i] for i, name in enumerate(self.outputs)}
        made |= dict(self.given)
        made |= {name: torque[:, j] for j, name in enumerate(run.plant.layout.inputs)}
        # Of an input that several laws read, the reading of the one that reads most often.
        seldom_first = sorted(range(len(self.laws)), key=lambda law: -self.every[law])
        for law in seldom_first:
            for i, name in enumerate(self.laws[law].inputs):
                if name in self.sensors:
                    made[f"{name}_measured"] = measured[:, laws.input_start[law] + i]
        names = _distinct([part.name for part in self.laws])
        for number, part in enumerate(self.laws):
            if isinstance(part, Stepper) or part.checks:
                made[f"input_fault_{names[number]}"] = (faults[:, number] != 0).astype(float)
        states = tuple(
            laws.state[a:b].copy() for a, b in zip(laws.state_start[:-1], laws.state_start[1:], strict=True)
        )
        return run.recording(made, torque, run.signals(), energy, **({"law": states} if states else {}))


def _distinct(names: Sequence[str]) -> list[str]:
    """Names of which several laws have one get a number each, from 1 on in their order."""
    made: list[str] = []
    for i, name in enumerate(names):
        number, new = names[:i].count(name) + 1, name
        while names.count(name) > 1 and (new in names or new in made):
            new, number = f"{name}_{number}", number + 1
        made.append(new)
    return made


def _starts(parts: Sequence[Any]) -> NDArray[np.int64]:
    return np.cumsum([0, *(len(part) for part in parts)]).astype(np.int64)
