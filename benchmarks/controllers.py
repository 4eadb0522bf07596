"""Time per step of the leaderboard's control laws, with their observers, as exported C and in a batch of loops.

    python benchmarks/controllers.py --runs 15          # a Markdown table

20 000 steps over the inputs of a step −2 → 2 rad/s on the paper's drivetrain, 0.1 ms; process time, the smallest of the
runs. Laws with the extended Kalman filter are not exported. The batch: four drivetrains; its peaks are those of
``simulate``.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from closed_loop import c_run, seconds
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion.compare.controllers import CONTESTANTS
from lostmotion.compare.controllers.contestants import Contestant, Law, Setting
from lostmotion.systems import DiscreteSystem

DT, N, LIMIT = 1e-4, 20_000, 73.5
PLANT = lm.Drivetrain.two_mass(**TABLE_I, lag=3e-4)
SETTING = Setting(PLANT, DT, LIMIT)
REFERENCE = np.where(np.arange(N) * DT % 0.2 < 0.1, -2.0, 2.0)
ACTING = {"torque_motor_acting": lm.Sensor("torque_motor")}


def laws_of(entry: Contestant) -> list[Law]:
    """Observer and controllers; all read the torque that acts."""
    laws = list(entry.control(SETTING))
    if entry.observer is not None:
        laws.insert(0, entry.observer(SETTING).renamed({"torque_motor": "torque_motor_acting"}))
    return laws


def arguments_of(entry: Contestant, laws: list[Law]) -> dict:
    reference = f"{entry.kind}_reference"
    sensors = {name: s for name, s in ACTING.items() if any(name in law.inputs for law in laws)}
    return {"law": laws, "delay": 1, "sensors": sensors, reference: REFERENCE}


def time_in_c(entry: Contestant, laws: list[Law], runs: int) -> float | None:
    """ns per step of the joined law; None where a part is no DiscreteSystem."""
    if not all(isinstance(law, DiscreteSystem) for law in laws):
        return None
    made = {name for law in laws for name in law.outputs}
    inputs = tuple(dict.fromkeys(n for law in laws for n in law.inputs if n not in made))
    joined = lm.connect(laws, inputs=inputs, outputs=("torque_motor",))
    run = lm.simulate(PLANT, dt=DT, **arguments_of(entry, laws))
    signals = {**run.signals, "torque_motor_acting": run["torque_motor"]}
    columns = np.ascontiguousarray(np.column_stack([signals[name] for name in inputs]))
    with tempfile.TemporaryDirectory() as folder:
        return 1e9 * seconds(c_run(joined, columns, Path(folder)), runs)[1] / N


def runs_in_a_batch(entry: Contestant, laws: list[Law]) -> bool:
    """Whether a batch gives the same peaks as single simulations."""
    plants = [PLANT.with_parameters(inertia_load=f * PLANT.inertia_load) for f in (0.8, 0.9, 1.1, 1.2)]
    arguments = arguments_of(entry, laws)
    batch = lm.simulation.simulate_batch(plants, dt=DT, signals=("speed_load",), workers=1, **arguments)
    single = [float(np.max(np.abs(lm.simulate(p, dt=DT, **arguments)["speed_load"]))) for p in plants]
    return bool(np.all(batch.done)) and np.allclose(batch.peak["speed_load"], single, rtol=1e-12)


def main() -> None:
    parser = parser_of(__doc__ or "")
    parser.add_argument("--runs", type=int, default=15)
    runs = parser.parse_args().runs
    print("| law with its observer | C, ns per step | in a batch |\n|---|---|---|")
    for entry in CONTESTANTS:
        laws = laws_of(entry)
        spent, batch = time_in_c(entry, laws, runs), runs_in_a_batch(entry, laws)
        print(f"| {entry.name} | {'–' if spent is None else f'{spent:.0f}'} | {'yes' if batch else 'NO'} |")


if __name__ == "__main__":
    main()
