"""The law, alone and in the loop with the two-mass plant: time per sample, with the exported C beside it.

    python benchmarks/closed_loop.py --runs 25          # a Markdown table
    python benchmarks/closed_loop.py --observers        # every fixed-gain observer over a recording

Set-point steps of ±2 rad/s every 0.1 s, 20 000 samples of 0.1 ms, observer and pole placement of the paper's Table I.
Process time, median of the runs and the smallest one. `simulate` is the slope between 2000 and 20 000 samples, without
what does not grow with the length; the whole call stands beside it.
"""

from __future__ import annotations

import ctypes
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion.kernels.law.step import law_run
from lostmotion.kernels.loop import blocks as kernels
from lostmotion.simulation import variants
from lostmotion.simulation.plant_run import PlantRun
from lostmotion.systems import DiscreteSystem

DT, N, SHORT = 1e-4, 20_000, 2_000
PLANT = lm.Drivetrain.two_mass(**TABLE_I, contact="dead_zone")
MODEL = PLANT.with_contact("viscoelastic")
REFERENCE = np.where(np.arange(N) * DT % 0.2 < 0.1, -2.0, 2.0)

#: C that runs an exported law over all rows of its inputs.
_DRIVER = Path(__file__).parents[1] / "tests" / "fixtures" / "law_driver.c"


def law() -> DiscreteSystem:
    observer = lm.observers.kalman(MODEL, dt=DT)
    control = lm.controllers.pole_placement(MODEL, poles=(-400, -400, -400), dt=DT, torque_limit=73.5)
    names = ("speed_reference", "speed_motor")
    return lm.connect([observer, control], inputs=names, outputs=("torque_motor",))


def seconds(work: Callable[[], object], runs: int) -> tuple[float, float]:
    """Median and smallest process time of a call, the first one left out."""
    work()
    times = []
    for _ in range(runs):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return float(np.median(times)), float(np.min(times))


def c_run(joined: DiscreteSystem, inputs: np.ndarray, folder: Path) -> Callable[[], object]:
    """The exported C over all inputs, compiled as its README says."""
    lm.export.c(joined, folder, name="law", vectors=2)
    (folder / "driver.c").write_bytes(_DRIVER.read_bytes())
    library = folder / "law.so"
    command = ["cc", *lm.export.C_FLAGS, "-shared", "-fPIC", "-o", str(library), "law.c", "driver.c"]
    subprocess.run(command, cwd=folder, check=True)
    code = ctypes.CDLL(str(library))
    outputs = np.empty((len(inputs), len(joined.outputs)))
    faults = np.empty(len(inputs), dtype=np.uint64)
    arrays = (inputs, outputs, faults)  # held by the call, since C gets their addresses alone
    return lambda: code.run(*(ctypes.c_void_p(a.ctypes.data) for a in arrays), ctypes.c_long(len(inputs)))


def kernel_time(joined: DiscreteSystem, runs: int) -> tuple[float, float]:
    """The compiled loop alone, without what ``simulate`` does around it."""
    spent: list[float] = []
    finish = PlantRun.finish

    def timed(self: PlantRun, kernel: Callable) -> None:
        def measured(tables: object) -> int:
            start = time.process_time()
            status = kernel(tables)
            spent[-1] += time.process_time() - start
            return int(status)

        spent.append(0.0)
        finish(self, measured)

    PlantRun.finish = timed  # type: ignore[method-assign]
    try:
        for _ in range(runs + 1):
            lm.simulate(PLANT, dt=DT, law=joined, speed_reference=REFERENCE)
    finally:
        PlantRun.finish = finish  # type: ignore[method-assign]
    return float(np.median(spent[1:])), float(np.min(spent[1:]))


def warm_loop(joined: DiscreteSystem, runs: int) -> tuple[float, float]:
    """The kernel once more from the start, in the memory of a finished run and with all its modes' tables made."""
    kernel, kept = kernels.run_with_laws, []

    def keeping(*arguments: Any) -> int:
        kept[:] = arguments
        return int(kernel(*arguments))

    kernels.run_with_laws = keeping
    try:
        lm.simulate(PLANT, dt=DT, law=joined, speed_reference=REFERENCE)
    finally:
        kernels.run_with_laws = kernel
    start = PlantRun(PLANT, DT, ("torque_motor",), None, N)
    s, digits, loop, cursor = kept[2], kept[3], kept[4], kept[10]
    kept[11] = np.empty_like(kept[11])  # the finished run's is read-only
    kept[4] = loop = loop._replace(torque=np.empty_like(loop.torque), outputs=np.empty_like(loop.outputs))

    def again() -> None:
        s[:], digits[:], cursor[:], loop.state[:] = start.s, start.digits, 0.0, joined.init()
        if kernel(*kept) != 0:
            raise RuntimeError("the loop did not come to its end")

    return seconds(again, runs)


def variants_with_law(joined: DiscreteSystem, runs: int) -> tuple[float, float]:
    """A variant of N samples in a batch on one thread."""
    plants = variants(PLANT, 20)
    work = seconds(
        lambda: lm.simulate_batch(plants, dt=DT, law=joined, speed_reference=REFERENCE, workers=1), runs
    )
    return work[0] / len(plants), work[1] / len(plants)


def loop_rows(runs: int) -> list[tuple[str, float, float]]:
    joined = law()
    loop = lm.simulate(PLANT, dt=DT, law=joined, speed_reference=REFERENCE)
    inputs = np.column_stack([REFERENCE, loop["speed_motor"]])
    tables = joined.tables()
    rows = [("law alone", *seconds(lambda: law_run(tables, joined.init(), inputs), runs))]
    with tempfile.TemporaryDirectory() as folder:
        rows.append(("exported C alone", *seconds(c_run(joined, inputs, Path(folder)), runs)))
    torque = loop["torque_motor"]
    rows.append(("loop, kernel in warm memory", *warm_loop(joined, runs)))
    rows.append(("loop, compiled part of `simulate`", *kernel_time(joined, runs)))
    whole, short = (
        seconds(lambda r=r: lm.simulate(PLANT, dt=DT, law=joined, speed_reference=r), runs)
        for r in (REFERENCE, REFERENCE[:SHORT])
    )
    open_loop = seconds(lambda: lm.simulate(PLANT, dt=DT, torque_motor=torque), runs)
    scale = N / (N - SHORT)
    rows.append(("`simulate`, slope", (whole[0] - short[0]) * scale, (whole[1] - short[1]) * scale))
    rows.append(("`simulate`, whole call", *whole))
    rows.append(("variant in a batch", *variants_with_law(joined, max(3, runs // 5))))
    rows.append(("`simulate` with the same torque given, whole call", *open_loop))
    return [(name, middle / N * 1e9, least / N * 1e9) for name, middle, least in rows]


def observer_rows(runs: int) -> list[tuple[str, float, float]]:
    both = ("torque_shaft", "speed_motor")
    observers = {
        "Observer 1": lm.observers.kalman(MODEL, dt=DT),
        "Observer 2": lm.observers.kalman(MODEL, measured=both, dt=DT),
        "with load torque": lm.observers.kalman(MODEL, dt=DT, load_torque=True, speed_from_counts=True),
        "scheduled": lm.observers.kalman(MODEL, dt=DT, contact_scheduling=True),
        "H∞ with load torque": lm.observers.h_infinity(MODEL, dt=DT, load_torque=True),
        "disturbance_observer": lm.observers.disturbance_observer(MODEL, dt=DT),
        "shaft torque": lm.observers.shaft_torque(MODEL.stiffness, dt=DT),
    }
    torque = 6.0 * np.sign(np.sin(2.0 * np.pi * 5.0 * DT * np.arange(N)))
    torque = torque + 10.0 * np.random.default_rng(0).standard_normal(N)
    recording = lm.simulate(PLANT, dt=DT, torque_motor=torque)
    rows = []
    for name, observer in observers.items():
        inputs = np.column_stack([recording[signal] for signal in observer.inputs])
        tables, start = observer.tables(), observer.init()
        kernel = seconds(lambda t=tables, s=start, u=inputs: law_run(t, s.copy(), u), runs)
        run = seconds(lambda o=observer: o.run(recording), runs)
        rows += [(f"{name}, kernel", *kernel), (f"{name}, `run`", *run)]
    return [(name, middle / N * 1e9, least / N * 1e9) for name, middle, least in rows]


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument("--runs", type=int, default=25)
    parser.add_argument("--observers", action="store_true")
    arguments = parser.parse_args()
    rows = observer_rows(arguments.runs) if arguments.observers else loop_rows(arguments.runs)
    print("| 20 000 samples | ns per sample, median | smallest |")
    print("|---|---|---|")
    for name, middle, least in rows:
        print(f"| {name} | {middle:.1f} | {least:.1f} |")


if __name__ == "__main__":
    main()
