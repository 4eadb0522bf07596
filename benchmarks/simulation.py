"""Speed and accuracy of the exact simulation beside its peers, on the same work in one run.

    python benchmarks/simulation.py --reference ../shared/reference/two_mass_exact.npz

Prints a Markdown table. Times: process time after compilation, median of several runs; the exact method in numba and
in C take turns. Errors: median and largest over the reference windows, each from its own start, as a fraction of the
range. Without a reference file the part of it in tests/simulation is used. python-control is a peer where it is
installed (pip install control).
"""

from __future__ import annotations

import ctypes
import math
import subprocess
import tempfile
import time
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from shared import TABLE_I, parser_of

import lostmotion as lm
from lostmotion.kernels.loop.any_plant import run_open_loop
from lostmotion.kernels.loop.two_mass import run_open_loop_two_mass
from lostmotion.kernels.plant.entered import enter
from lostmotion.kernels.plant.event_loop import NEED_MODE
from lostmotion.simulation.plant_run import PlantRun

HERE = Path(__file__).parent
DT = 1e-4
PAPER = lm.Drivetrain.two_mass(**TABLE_I, contact="dead_zone")


def seconds(work: Callable[[], object], runs: int) -> float:
    """Median process time of a call, the first one left out."""
    return float(np.median(seconds_in_turn([work], runs)))


def seconds_in_turn(works: list[Callable[[], object]], runs: int) -> np.ndarray:
    """(runs, works) process times, in turn so that a busy machine is busy for all; the first turn is left out."""
    times = np.empty((runs + 1, len(works)))
    for row in times:
        for i, work in enumerate(works):
            start = time.process_time()
            work()
            row[i] = time.process_time() - start
    return times[1:]


def kernel_run(
    torque: np.ndarray, start: np.ndarray, kernel: Callable, plant: lm.Drivetrain = PAPER
) -> Callable:
    """The kernel alone, in memory that is warm and with the contact states' tables made."""
    run = PlantRun(plant, DT, ("torque_motor",), start, torque.size)
    run.keep_states(of_all=True)
    x, digits, inputs = run.s.copy(), run.digits.copy(), torque[:, None].copy()

    def finish(entered: Any) -> int:
        while True:
            status = kernel(
                entered.tables, run.s, run.digits, inputs, 0, torque.size, run.work, run.states, run.modes,
                run.events, run.cursor,
            )  # fmt: skip
            if status != NEED_MODE or not enter(entered, run.digits):
                return int(status)

    def work() -> int:
        run.s[:], run.digits[:], run.cursor[:] = x, digits, 0.0
        run.finish(finish)
        return int(run.cursor[2])

    return work


def plain_c(folder: Path) -> ctypes.CDLL:
    library = folder / "plain.so"
    source = HERE / "simulation_plain.c"
    subprocess.run(
        ["cc", "-O3", "-march=native", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True
    )
    code = ctypes.CDLL(str(library))
    code.run.restype = ctypes.c_long
    return code


def c_run(code: ctypes.CDLL, torque: np.ndarray, start: np.ndarray) -> tuple[Callable, np.ndarray]:
    run = PlantRun(PAPER, DT, ("torque_motor",), start, torque.size)
    run.keep_states(of_all=True)
    for digits in np.ndindex(3, 3):
        run.plant.enter(digits)
    tables = run.plant.tables()
    events = np.zeros((torque.size, run.events.shape[1]))
    double = ctypes.POINTER(ctypes.c_double)
    whole = ctypes.POINTER(ctypes.c_int64)

    def work() -> int:
        s, digits = run.s.copy(), run.digits.copy()
        return int(
            code.run(
                tables.flat.ctypes.data_as(double),
                tables.row.ctypes.data_as(whole),
                tables.order,
                s.ctypes.data_as(double),
                digits.ctypes.data_as(whole),
                torque.ctypes.data_as(double),
                ctypes.c_long(torque.size),
                run.states.ctypes.data_as(double),
                run.modes.ctypes.data_as(whole),
                events.ctypes.data_as(double),
            )
        )

    return work, run.states


@njit(fastmath=True, cache=True)
def rk4(torque, start, steps, dt, smoothing):
    """Fixed-step Runge–Kutta with friction smoothed over `smoothing` rad/s: how it is usually done."""
    h = dt / steps
    x, w, v = start
    rows = np.empty((torque.size + 1, 3))
    slope = np.empty((4, 3))
    for k in range(torque.size):
        rows[k, 0], rows[k, 1], rows[k, 2] = x, w, v
        for _ in range(steps):
            a, b, c = x, w, v
            for stage in range(4):
                rate = b - c
                torque_shaft = 6285.896 * (a - min(max(a, -0.006), 0.006)) + 0.397 * rate
                friction = 2.0 * np.tanh(c / smoothing) + 0.0175 * c
                slope[stage, 0] = rate
                slope[stage, 1] = (torque[k] - torque_shaft) / 0.0182
                slope[stage, 2] = (torque_shaft - friction) / 0.111
                part = h * (0.5, 0.5, 1.0, 0.0)[stage]
                a, b, c = x + part * slope[stage, 0], w + part * slope[stage, 1], v + part * slope[stage, 2]
            x += h / 6.0 * (slope[0, 0] + 2.0 * slope[1, 0] + 2.0 * slope[2, 0] + slope[3, 0])
            w += h / 6.0 * (slope[0, 1] + 2.0 * slope[1, 1] + 2.0 * slope[2, 1] + slope[3, 1])
            v += h / 6.0 * (slope[0, 2] + 2.0 * slope[1, 2] + 2.0 * slope[2, 2] + slope[3, 2])
    rows[torque.size, 0], rows[torque.size, 1], rows[torque.size, 2] = x, w, v
    return rows


def scipy_events(torque: np.ndarray, start: np.ndarray, method: str) -> np.ndarray:
    """scipy's solve_ivp from event to event, restarted at each sample and event (rtol 1e-8)."""
    import sys

    sys.path.insert(0, str(HERE.parent / "tests" / "simulation"))
    from independent import Independent

    return Independent(PAPER, 1e-8, method).run(torque, DT, start)


def python_control(torque: np.ndarray, start: np.ndarray) -> np.ndarray:
    """python-control's input_output_response (rtol 1e-8), friction smoothed; it interpolates the torque linearly."""
    import control

    def rates(_t: float, x: np.ndarray, u: np.ndarray, _params: object) -> list[float]:
        twist, motor, load = x
        rate = motor - load
        shaft = 6285.896 * (twist - min(max(twist, -0.006), 0.006)) + 0.397 * rate
        friction = 2.0 * math.tanh(load / 1e-3) + 0.0175 * load
        return [rate, (u[0] - shaft) / 0.0182, (shaft - friction) / 0.111]

    plant = control.NonlinearIOSystem(rates, inputs=1, states=3, outputs=3, name="two_mass")
    held = np.append(torque, torque[-1])
    instants = np.arange(held.size) * DT
    response = control.input_output_response(plant, instants, held, start, solve_ivp_kwargs={"rtol": 1e-8})
    return np.asarray(response.states).T


def window_errors(solve: Callable, data: dict[str, np.ndarray], kind: str, windows: int) -> np.ndarray:
    exact = data[f"{kind}_states"]
    span = np.ptp(exact.reshape(-1, 3), axis=0)
    errors = []
    for i in range(min(windows, len(exact))):
        got = solve(data[f"{kind}_torque"][i], data[f"{kind}_start"][i])
        errors.append(np.max(np.abs(got[:, :3] - exact[i]) / span))
    return np.array(errors)


def exact_states(torque: np.ndarray, start: np.ndarray) -> np.ndarray:
    rec = lm.simulate(PAPER, torque_motor=torque, dt=DT, state=start)
    rows = np.column_stack([rec["twist"], rec["speed_motor"], rec["speed_load"]])
    return np.vstack([rows, rec.final_state["state"][:3]])


def long_torque(kind: str, n: int = 100_000) -> np.ndarray:
    """Torque of the reference's kind: noise of 10 (3) Nm and a square wave of 6 (1) Nm, seed 0."""
    rms, level = {"contact": (10.0, 6.0), "stiction": (3.0, 1.0)}[kind]
    square = np.sign(np.sin(2.0 * np.pi * 5.0 * np.arange(n) * DT))
    return rms * np.random.default_rng(0).standard_normal(n) + level * square


def whole_call(torque: np.ndarray) -> tuple[Callable, Callable]:
    """The whole call with every signal read; and a list of every event."""

    def every_signal() -> float:
        rec = lm.simulate(PAPER, torque_motor=torque, dt=DT, state=(0, 0, 0))
        return sum(float(rec[name][-1]) for name in rec)

    rec = lm.simulate(PAPER, torque_motor=torque, dt=DT, state=(0, 0, 0))
    return every_signal, lambda: list(rec.events)


def whole_lines(kind: str, runs: int) -> list[str]:
    """The whole call beside its kernel, in turn, and the time to list its events."""
    torque = long_torque(kind)
    kernel = kernel_run(torque, np.zeros(3), run_open_loop_two_mass)
    call, events = whole_call(torque)
    spent = np.median(seconds_in_turn([kernel, call, events], 2 * runs), axis=0)
    each = 1e9 / torque.size
    listed = spent[2] * 1e9 / max(1, len(events()))
    text = f"{spent[1] * each:.3g}, {spent[1] / spent[0]:.2f} times its kernel's {spent[0] * each:.3g}"
    return [
        f"| {kind} | `simulate`, whole call, every signal read: {text} | | | | |",
        f"| {kind} | listing all {len(events())} events: {listed:.0f} ns each | | | | |",
    ]


def fast_rows(kind: str, runs: int, code: ctypes.CDLL) -> tuple[list[tuple], list[str]]:
    """The exact method in numba and in C: rows of the table, and lines about their events."""
    torque, rest = long_torque(kind), np.zeros(3)
    quiet = np.full(torque.size, 3.0)
    ours, ours_quiet = (kernel_run(u, rest, run_open_loop_two_mass) for u in (torque, quiet))
    plain, plain_quiet = (c_run(code, u, rest)[0] for u in (torque, quiet))
    times = seconds_in_turn([ours, plain, ours_quiet, plain_quiet], 4 * runs) / torque.size
    spent, least = np.median(times, axis=0), times.min(axis=0)

    def c_states(u: np.ndarray, x: np.ndarray) -> np.ndarray:
        work, states = c_run(code, np.ascontiguousarray(u), x)
        work()
        return states

    rows = [
        ("lostmotion, exact", spent[0], exact_states, 40),
        ("plain C (-O3 -march=native), exact", spent[1], c_states, 40),
    ]
    lines = [f"| {kind} | events per second of simulated time: {ours() / (torque.size * DT):.0f} | | | | |"]
    for name, events, i in (("lostmotion", ours(), 0), ("plain C", plain(), 1)):
        each = (least[i] - least[i + 2]) * torque.size / events
        text = f"{least[i] * 1e9:.3g}: {least[i + 2] * 1e9:.3g} and {each * 1e9:.3g} for an event"
        lines.append(f"| {kind} | {name}, least of {4 * runs} runs: {text} | | | | |")
    return rows, lines


def two_mass_rows(data: dict[str, np.ndarray], kind: str, runs: int, code: ctypes.CDLL) -> list[str]:
    torque, n = long_torque(kind), 100_000
    rest = np.zeros(3)
    window = (data[f"{kind}_torque"][0], data[f"{kind}_start"][0])
    rows, notes = fast_rows(kind, runs, code)
    rows.append(
        (
            "numba RK4, 10 µs, smoothed friction",
            seconds(lambda: rk4(torque, rest, 10, DT, 1e-3), 5) / n,
            lambda u, x: rk4(u, x, 10, DT, 1e-3),
            40,
        )
    )
    for method in ("RK45", "LSODA"):
        short = (window[0][:200], window[1])
        spent = seconds(lambda short=short, method=method: scipy_events(*short, method), 1)
        rows.append((f"scipy {method}, events", spent / 200, lambda u, x, m=method: scipy_events(u, x, m), 1))
    if find_spec("control"):
        spent = seconds(lambda: python_control(*window), 1)
        rows.append(("python-control, smoothed friction", spent / window[0].size, python_control, 1))
    lines = []
    first = rows[0][1]
    for name, each, solve, windows in rows:
        errors = window_errors(solve, data, kind, windows)
        errors_shown = f"{np.median(errors):.1e} | {errors.max():.1e}"
        lines.append(f"| {kind} | {name} | {each * 1e9:.4g} | {each / first:.3g} | {errors_shown} |")
    return lines + notes


def six_masses() -> lm.Drivetrain:
    shafts = tuple(lm.Shaft(5000.0 + 1500.0 * i, 0.3, 0.006 if i in (1, 4) else 0.0) for i in range(5))
    frictions = tuple(lm.Friction(1.0 if i in (2, 5) else 0.0, 0.01) for i in range(6))
    return lm.Drivetrain((0.02, 0.01, 0.01, 0.01, 0.01, 0.05), shafts, frictions)


def main() -> None:
    parser = parser_of(__doc__)
    parser.add_argument(
        "--reference", type=Path, default=HERE.parent / "tests" / "simulation" / "reference_windows.npz"
    )
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--whole", action="store_true", help="only the whole call beside its kernel")
    arguments = parser.parse_args()
    with np.load(arguments.reference) as file:
        data = dict(file)
    print("| workload | method | ns per 100 µs sample | times lostmotion | median error | largest error |")
    print("|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        code = plain_c(Path(folder))
        for kind in ("contact", "stiction"):
            if not arguments.whole:
                print("\n".join(two_mass_rows(data, kind, arguments.runs, code)), flush=True)
            print("\n".join(whole_lines(kind, arguments.runs)), flush=True)
    chain = kernel_run(long_torque("contact", 20_000), np.zeros(11), run_open_loop, six_masses())
    print(
        f"| contact | six masses, two backlashes | {seconds(chain, arguments.runs) / 20_000 * 1e9:.4g} | | | |"
    )


if __name__ == "__main__":
    main()
