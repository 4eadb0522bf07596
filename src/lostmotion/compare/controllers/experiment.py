"""One law in one case on the rig of a seed: the true signals of the run."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ... import rig
from ...curves import PiecewiseLinear, dead_zone, saturation
from ...drivetrain import Drivetrain
from ...recording import Recording
from ...simulation import Sensor
from ...systems import DiscreteSystem
from ..experiment import LEVELS, identified
from ..zoo_drive import zoo_drive
from .cases import Case
from .contestants import Contestant, Law, Setting
from .work import Work, work

#: Longest sample time of plant and record, s (option: crossings and jerk are judged by it).
FINEST = 1e-4
#: Speed over which the true friction turns, rad/s (option: small against every speed of the experiments).
TURN = 0.01
#: Test drives of the zoo for each seed: one of five has one gap and little delay (numerics).
APART = 47
#: What the drive reports: the torque set-point that acts in this sample.
ACTING = {"torque_motor_acting": Sensor("torque_motor")}
#: Sensors that show the truth.
TRUE_SENSORS = {
    "speed_motor": Sensor("speed_motor"),
    **{f"true_{name}": Sensor(name) for name in ("twist", "speed_motor", "speed_load", "torque_load")},
}


@dataclass(frozen=True, eq=False)
class Experiment:
    """A plant with its sensors, the setting of the laws, the work.

    dt (s) is the plant's, delay in samples of the laws.
    """

    plant: rig.Rig
    setting: Setting
    work: Work
    true_states: bool
    dt: float
    delay: int = 1


def experiment(case: Case, seed: int) -> Experiment:
    """The case on the drive of the seed."""
    return _on_the_zoo(case, seed) if case.drive == "zoo" else _on_the_rig(case, seed)


def _on_the_rig(case: Case, seed: int) -> Experiment:
    """The laws are given the model that was identified on the rig as it was."""
    original = rig.varied_rig(seed)
    model = _model(seed)
    model = _misled(model, case)
    sensors = {
        "speed_motor": Sensor(
            "angle_motor", 2.0 * math.pi / 2**case.encoder_bits, difference=True, dropout=case.dropouts
        ),
        **ACTING,
    }
    plant = replace(original, drivetrain=_changed(original.drivetrain, case), sensors=sensors)
    dt = min(case.dt, FINEST)
    asked = work(case.work, dt, plant.drivetrain.inertia_total)
    return Experiment(plant, Setting(model, case.dt, rig.TORQUE_LIMIT), asked, case.true_states, dt)


def _on_the_zoo(case: Case, seed: int) -> Experiment:
    bench = zoo_drive(seed, APART)
    plant = replace(bench.rig, sensors={**bench.rig.sensors, **ACTING})
    dt = bench.dt / math.ceil(bench.dt / FINEST)
    asked = work(case.work, dt, plant.drivetrain.inertia_total)
    setting = Setting(_misled(bench.model, case), bench.dt, rig.TORQUE_LIMIT)
    return Experiment(plant, setting, asked, case.true_states, dt, bench.delay)


def _misled(model: Drivetrain, case: Case) -> Drivetrain:
    return model.with_parameters(**{name: f * getattr(model, name) for name, f in case.factors.items()})


@functools.lru_cache(maxsize=64)
def _model(seed: int) -> Drivetrain:
    """The two masses that an identification finds from one recording."""
    truth = rig.two_mass_equivalent(rig.varied_rig(seed).drivetrain, np.linspace(-LEVELS[1], LEVELS[1], 2000))
    found = identified(seed, {name: value for name, value in truth.items() if value is not None})
    return Drivetrain.two_mass(**found)  # type: ignore[arg-type]


def _changed(drivetrain: Drivetrain, case: Case) -> Drivetrain:
    *others, load = drivetrain.inertias
    shafts = tuple(replace(shaft, backlash=case.backlash * shaft.backlash) for shaft in drivetrain.shafts)
    return replace(drivetrain, inertias=(*others, case.load_inertia * load), shafts=shafts)


def designed(contestant: Contestant, data: Experiment) -> list[Law]:
    """The contestant's laws, an observer before its controllers; ``InvalidInput`` where there are none."""
    laws = list(contestant.control(data.setting))
    if contestant.observer is not None:
        laws.insert(0, true_states(data) if data.true_states else contestant.observer(data.setting))
    return laws


def run(laws: Sequence[Law], data: Experiment) -> Recording:
    """The true signals with the laws in the loop, one sample of computing delay."""
    plant = data.plant
    if data.true_states:
        plant = replace(plant, sensors={**plant.sensors, **TRUE_SENSORS})
    n = len(plant.drivetrain.inertias)
    references: dict[str, Any] = dict(data.work.references)
    _, truth = rig.record(
        plant,
        dt=data.dt,
        law=laws,
        delay=data.delay * round(data.setting.dt / data.dt),
        torque_load=data.work.torque_load,
        state=[0.0] * (n - 1) + [data.work.speed] * n,
        channels=(),
        **references,
    )
    return truth.signals


def true_states(data: Experiment) -> DiscreteSystem:
    """What an observer would tell if it knew the plant's state and the load torque."""
    load = data.plant.drivetrain.frictions[-1]
    half = 0.5 * math.fsum(shaft.backlash for shaft in data.plant.drivetrain.shafts)
    signals = ["true_twist", "true_speed_motor", "true_speed_load"]
    if data.work.torque_load is not None:
        signals.append("true_torque_load")
    rows = np.eye(len(signals))
    nothing = np.zeros(len(signals))
    torque = nothing if data.work.torque_load is None else rows[3]
    friction = saturation(load.coulomb_plus, load.coulomb_plus / TURN)
    stiffness = data.setting.model.stiffness
    outputs = {
        "twist_estimated": (rows[0], (0.0, 0.0)),
        "twist_elastic_estimated": (nothing, (1.0, 0.0)),
        "speed_motor_estimated": (rows[1], (0.0, 0.0)),
        "speed_load_estimated": (rows[2], (0.0, 0.0)),
        "torque_shaft_estimated": (nothing, (stiffness, 0.0)),
        "friction_load_estimated": (load.viscous * rows[2], (0.0, 1.0)),
        "torque_load_estimated": (torque, (0.0, 0.0)),
        "inertia_load_estimated": (nothing, (0.0, 0.0)),
    }
    known = PiecewiseLinear(((0.0, data.setting.model.inertia_load),))
    direct, by_curves = (np.array(part) for part in zip(*outputs.values(), strict=True))
    return DiscreteSystem(
        name="true_states", dt=data.setting.dt, inputs=tuple(signals), outputs=tuple(outputs),
        curves=(dead_zone(half), friction, known), G=rows[[0, 2, 2]], D=direct,
        J=np.column_stack([by_curves, np.eye(len(outputs))[-1]]),
    )  # fmt: skip
