"""``simulate`` with laws: what is given is checked, then the loop runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from .inputs import check_lengths, plant_inputs, possible_inputs
from .laws_in_loop import Law, LawsInLoop
from .moved_end import MovedEnd
from .plant_run import PlantRun
from .sensors import Sensor

Array = NDArray[np.float64]

#: Relative difference up to which two sample times count as equal (numerics: rounding).
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
    loop, names = laws_in_loop(drivetrain, law, dt, given, delay, sensors, moved)
    run = PlantRun(drivetrain, dt, names, state, check_lengths(given))
    if moved is not None:
        moved.place(run.plant.layout, run.s)
    return loop.simulate(run, seed, energy)


def laws_in_loop(
    drivetrain: Drivetrain,
    law: Law | Sequence[Law],
    dt: float,
    given: Mapping[str, Array],
    delay: int | Sequence[int],
    sensors: Mapping[str, Sensor],
    moved: MovedEnd | None,
) -> tuple[LawsInLoop, tuple[str, ...]]:
    """What runs in the loop, checked, and the names of the plant's inputs."""
    laws = _laws(law)
    every = tuple(_samples(part, dt) for part in laws)
    delays = _delays(delay, len(laws))
    if not given:
        raise InvalidInput(
            "simulate", "no signal of known length", "a set-point or a torque", "Give speed_reference."
        )
    length = check_lengths(given)
    if max(delays) >= length:
        raise InvalidInput(
            "simulate.delay", f"{max(delays)} samples", f"fewer than the {length} of the signals",
            "Its unit is one sample of the plant.",
        )  # fmt: skip
    _check_makers(laws, given, possible_inputs(drivetrain))
    made = [name for part in laws for name in part.outputs]
    names = plant_inputs(drivetrain, {**given, **dict.fromkeys(made)})
    _check_wiring(laws, given, sensors, names, made)
    return LawsInLoop(laws, every, delays, given, sensors, moved), names


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
            "simulate: signals that no law reads",
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
