"""simulate: a drivetrain under given torques, or under a law in the loop, exactly from event to event."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..argument_checks import checks_arguments
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..plain_data import seed_of
from ..recording import Recording
from ..systems import DiscreteSystem, Stepper
from .inputs import (
    check_lengths,
    check_sample_time,
    check_signal,
    check_state,
    last_set_point,
    plant_inputs,
    possible_inputs,
)
from .moved_end import moved_end, started
from .plant_run import PlantRun
from .sensors import Sensor


@checks_arguments
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
        For NaN, text, sizes beyond 1e30, wrong lengths, a sample time that is not positive or above 100 s, signals
        that no law or plant reads or makes, a signal that depends on itself within one sample.
    """
    given = {"torque_motor": torque_motor, "torque_load": torque_load, **signals}
    values = {name: check_signal(name, array) for name, array in given.items() if array is not None}
    check_sample_time(dt)
    check_state(state)
    seed_of("simulate.seed", seed)
    moved = moved_end(drivetrain, dt, values)
    if moved is not None:
        for kind in ("speed", "angle"):
            values.pop(f"{kind}_{drivetrain.locked}", None)
        values[f"acceleration_{drivetrain.locked}"] = moved.acceleration
    state = started(drivetrain, state, moved)
    if law is not None:
        from .closed_loop import simulate_law

        return simulate_law(drivetrain, law, dt, values, state, delay, sensors or {}, seed, energy, moved)
    if sensors:
        raise InvalidInput(
            "simulate.sensors", f"{sorted(sensors)} and no law", "sensors of a law's inputs",
            "Give the law, or leave the sensors out: without a law all signals are exact.",
        )  # fmt: skip
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
            from .laws_in_loop import LawsInLoop

            torques = {name: values.get(name, np.zeros(length)) for name in names}
            return LawsInLoop((), (), (), torques, {}, moved).simulate(run, seed, energy)
    columns = [np.zeros(length) if name not in values else values[name] for name in names]
    columns[0] = _set_point(drivetrain, columns[0], dt, state)
    inputs = np.ascontiguousarray(np.array(columns).T)
    run.keep_states(of_all=energy)
    from ..kernels.loop.blocks import run_under_torques

    own = np.empty((len(run.plant.signal_names()), length))
    run.finish(
        lambda entered: run_under_torques(
            entered, run.two_mass, run.s, run.digits, inputs, run.work, run.states, run.modes, run.events,
            run.cursor, own,
        )
    )  # fmt: skip
    made = {name: inputs[:, j] for j, name in enumerate(names)}
    return run.recording(made, inputs, own, energy)


def _set_point(
    drivetrain: Drivetrain, torque: NDArray[np.float64], dt: float, state: Any
) -> NDArray[np.float64]:
    """The torque set-point within the actuator's limits."""
    actuator = drivetrain.actuator
    if math.isfinite(actuator.torque_limit):
        torque = np.clip(torque, -actuator.torque_limit, actuator.torque_limit)
    if math.isfinite(actuator.rate_limit):
        from ..kernels.plant.actuator import limit_rate

        torque = limit_rate(torque, actuator.rate_limit * dt, last_set_point(state))
    return torque
