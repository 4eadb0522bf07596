"""Time per step of the leaderboard's control laws, with their observers, as exported C and in a batch of loops.

    python benchmarks/controllers.py --runs 15          # a Markdown table

20 000 steps over the inputs of a step −2 → 2 rad/s on the paper's drivetrain, 0.1 ms; process time, the smallest of the
runs. Laws with the extended Kalman filter are not exported. The batch: four drivetrains; its peaks are those of
``simulate``.
"""

from __future__ import annotations

import ctypes
import tempfile
import time
from pathlib import Path

import numpy as np
from closed_loop import c_run, seconds
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion.compare.controllers import CONTESTANTS
from lostmotion.compare.controllers.contestants import Contestant, Law, Setting
from lostmotion.systems import DiscreteSystem, Stepper

DT, N, LIMIT = 1e-4, 20_000, 73.5
#: Samples over which the slowest step is judged: single ones are shorter than a look at the clock is sure.
WINDOW = 10
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
    """ns per step of the law, joined where all parts are DiscreteSystems; None where a part is not exported."""
    if any(isinstance(law, Stepper) and not law.exportable for law in laws):
        return None
    run = lm.simulate(PLANT, dt=DT, **arguments_of(entry, laws))
    if all(isinstance(law, DiscreteSystem) for law in laws):
        made = {name for law in laws for name in law.outputs}
        inputs = tuple(dict.fromkeys(n for law in laws for n in law.inputs if n not in made))
        laws = [lm.connect(laws, inputs=inputs, outputs=("torque_motor",))]
    signals = {**run.signals, "torque_motor_acting": run["torque_motor"]}
    return sum(_one_in_c(law, signals, runs) for law in laws)


def _one_in_c(law: Law, signals: dict[str, np.ndarray], runs: int) -> float:
    columns = np.ascontiguousarray(np.column_stack([signals[name] for name in law.inputs]))
    with tempfile.TemporaryDirectory() as folder:
        return 1e9 * seconds(c_run(law, columns, Path(folder)), runs)[1] / N


def slowest_in_c(entry: Contestant, laws: list[Law], runs: int) -> float:
    """The slowest step of the last law, ns: over windows of ten samples, of each the fastest of the runs."""
    law, run = laws[-1], lm.simulate(PLANT, dt=DT, **arguments_of(entry, laws))
    signals = {**run.signals, "torque_motor_acting": run["torque_motor"]}
    columns = np.ascontiguousarray(np.column_stack([signals[name] for name in law.inputs]))
    with tempfile.TemporaryDirectory() as folder:
        code = ctypes.CDLL(str(lm.export.shared_library(law, folder)))
        spent = [_windows(code, columns) for _ in range(runs)]
    return 1e9 * float(np.max(np.min(spent, axis=0))) / WINDOW


def _windows(code: ctypes.CDLL, columns: np.ndarray) -> list[float]:
    state, output = ctypes.create_string_buffer(code.law_size()), ctypes.c_double()
    rows = [ctypes.c_void_p(row.ctypes.data) for row in columns]
    code.law_init(state)
    found = []
    for first in range(0, len(rows) - WINDOW + 1, WINDOW):
        start = time.perf_counter()
        for row in rows[first : first + WINDOW]:
            code.law_step(state, row, ctypes.byref(output))
        found.append(time.perf_counter() - start)
    return found


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
    parser.add_argument("--law", help="this one alone, with its slowest step")
    arguments = parser.parse_args()
    runs = arguments.runs
    if arguments.law:
        (entry,) = (c for c in CONTESTANTS if c.name == arguments.law)
        laws = laws_of(entry)
        spent, slowest = time_in_c(entry, laws, runs), slowest_in_c(entry, laws, runs)
        print(f"{entry.name}: {spent:.0f} ns per step, slowest {slowest:.0f} ns")
        return
    print("| law with its observer | C, ns per step | in a batch |\n|---|---|---|")
    for entry in CONTESTANTS:
        laws = laws_of(entry)
        spent, batch = time_in_c(entry, laws, runs), runs_in_a_batch(entry, laws)
        print(f"| {entry.name} | {'–' if spent is None else f'{spent:.0f}'} | {'yes' if batch else 'NO'} |")


if __name__ == "__main__":
    main()
