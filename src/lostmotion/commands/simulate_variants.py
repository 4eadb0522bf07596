"""lostmotion simulate --variants: a batch of variants as a CSV of summaries and a picture; resumable."""

from __future__ import annotations

import contextlib
import csv
import io
import re
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from .. import plot
from ..display.numbers import quantity
from ..drivetrain import Drivetrain
from ..io.storage.whole_files import write_bytes
from ..memory import check_memory
from ..recording import unit_of
from ..rig import eigenfrequencies
from ..simulation import BatchResult, simulate, simulate_batch, variants
from .cost import Announce, Cost, silent
from .outputs import outputs, save_picture, stem
from .recordings import read_drive
from .simulate import MEMORY as MEMORY_OF_ONE
from .simulate import torque_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

#: Shown as bands, and summed up.
_SIGNALS = ("speed_motor", "speed_load", "twist", "torque_shaft")
#: Bytes of memory that a variant takes, and seconds of one core for each of its samples and inertias (numerics: 200
#: samples of each of four signals, three times; calibrated on two cores of an Intel Xeon, docs/benchmarks/batch.md).
MEMORY, SECONDS = 20e3, 2e-8
#: Names that ``simulation.batch.store`` gives to chunks.
_CHUNK = re.compile(r"variants-\d{6,}(\.summary)?\.npz", re.ASCII)
#: Periods of the first torsional mode that are drawn: with 200 times ten of them in a period (numerics); of a rigid
#: drive the first seconds (option).
PERIODS, RIGID_SHOWN = 20, 1.0
#: Quantiles that are shown (option).
_LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)


def chunk_folder(out: Path) -> Path:
    """Where finished chunks stand until all are done."""
    return Path(f"{stem(out)}.chunks")


def simulate_variants(
    drivetrain: Path,
    out: Path,
    count: int,
    spread: float = 0.2,
    torque: Path | None = None,
    duration: float = 10.0,
    dt: float = 1e-4,
    seed: int = 1,
    progress: Callable[[int, int, float], None] | None = None,
    force: bool = False,
    announce: Announce = silent,
) -> BatchResult:
    """Simulate `count` variants; write a CSV, a row for each, and a picture of the signals' quantiles.

    Torque as for ``simulate_file``. Finished chunks stand in ``chunk_folder(out)`` until all are done, so that the same
    call goes on where an interrupted one stopped.
    """
    drive = read_drive(drivetrain)
    plant = drive.drivetrain
    read = drive.reads if torque is None else (*drive.reads, torque)
    with outputs(out, ".csv", ".png", sources=read, force=force) as (table, picture):
        check_memory("variants", f"{count} variants", count * MEMORY, "Take fewer.")
        given, dt = torque_of(plant, torque, duration, dt, seed, _cost(plant, count), announce)
        plants = variants(plant, count, spread=spread, seed=seed)
        signals = _SIGNALS if len(plant.inertias) > 1 else _SIGNALS[:1]
        made = simulate_batch(
            plants,
            dt=dt,
            signals=signals,
            quantiles=signals,
            torque_motor=given,
            folder=chunk_folder(out),
            progress=progress,
        )
        write_bytes(table, _table(plants, made).encode("utf-8"))
        if made.done.any():
            title = f"{drivetrain.name}: {count} variants, ± {100.0 * spread:g} %"
            save_picture(_picture(plant, plants, given[: _drawn(plant, dt)], dt, signals, title), picture)
    _clear(chunk_folder(out))
    return made


def _cost(plant: Drivetrain, count: int) -> Cost:
    """Of each sample of the torque: all variants take their time, one after the other their memory."""
    constant, each = MEMORY_OF_ONE
    memory = constant + each * len(plant.inertias)
    return Cost(1.0, memory, count * SECONDS * len(plant.inertias))


def _drawn(plant: Drivetrain, dt: float) -> int:
    """Samples that are drawn: so many periods of the torsional mode that the few times of the quantiles resolve it."""
    if len(plant.inertias) == 1:
        return round(RIGID_SHOWN / dt)
    return max(100, round(PERIODS / (float(eigenfrequencies(plant)[1]) * dt)))


def _picture(
    plant: Drivetrain,
    plants: Sequence[Drivetrain],
    torque: Array,
    dt: float,
    signals: Sequence[str],
    title: str,
) -> Figure:
    """The beginning of the run: over the whole of it a raster of 200 times would show what is not there."""
    made = simulate_batch(plants, dt=dt, signals=signals, quantiles=signals, torque_motor=torque)
    alone = simulate(plant, torque_motor=torque, dt=dt)
    step = -(-len(alone) // made.quantile_time.size)
    return plot.quantile_bands(
        made.quantile_time,
        {name: made.quantiles(name, _LEVELS) for name in signals},
        single={name: alone[name][::step] for name in signals},
        title=f"{title}: the first {quantity(alone.time[-1] + dt, 's', 2)}",
    )


def _clear(folder: Path) -> None:
    """Remove the chunks, and the folder if it holds nothing else."""
    for chunk in folder.glob("variants-*.npz"):
        if _CHUNK.fullmatch(chunk.name):
            chunk.unlink(missing_ok=True)
    with contextlib.suppress(OSError):
        folder.rmdir()


def _table(plants: Sequence[Drivetrain], made: BatchResult) -> str:
    """One row for each variant: its numbers, final state, peaks, RMS, counts of events, or why it failed."""
    parameters = [_parameters(plant) for plant in plants]
    n = len(plants[0].inertias)
    twists = ["twist"] if n == 2 else [f"twist_{i + 1}" for i in range(n - 1)]
    speeds = ["speed_motor", *(f"speed_{i + 1}" for i in range(1, n - 1)), *(["speed_load"] if n > 1 else [])]
    columns = {f"final_{name}{_unit(name)}": made.final_state[:, i] for i, name in enumerate(twists + speeds)}
    columns |= {f"peak_{name}{_unit(name)}": values for name, values in made.peak.items()}
    columns |= {f"rms_{name}{_unit(name)}": values for name, values in made.rms.items()}
    columns |= {f"{kind}s": values for kind, values in made.events.items()}
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["variant", *parameters[0], *columns, "failure"])
    for i, numbers in enumerate(parameters):
        values = [column[i] for column in columns.values()]
        cells = [f"{value:.9g}" if np.isfinite(value) else "" for value in (*numbers.values(), *values)]
        writer.writerow([i, *cells, made.failures.get(i, "")])
    return text.getvalue()


def _parameters(plant: Drivetrain) -> dict[str, float]:
    """The numbers that differ, by column."""
    units = {"inertia": "kg m2", "stiffness": "Nm/rad", "damping": "Nm s/rad", "backlash": "rad"}
    units |= {"coulomb": "Nm", "viscous": "Nm s/rad", "breakaway": "Nm"}
    rows = {"inertia": plant.inertias, "coulomb": tuple(f.coulomb_plus for f in plant.frictions)}
    rows["viscous"] = tuple(f.viscous for f in plant.frictions)
    # Where none is given, motion starts just above rest at the positive speed's level.
    rows["breakaway"] = tuple(
        f.level_at_rest[0] if f.breakaway is None else f.breakaway for f in plant.frictions
    )
    for name in ("stiffness", "damping", "backlash"):
        rows[name] = tuple(getattr(shaft, name) for shaft in plant.shafts)
    numbered = {
        f"{name}_{i + 1} [{units[name]}]": v for name, values in rows.items() for i, v in enumerate(values)
    }
    return numbered | {"lag [s]": plant.actuator.lag}


def _unit(name: str) -> str:
    return f" [{unit_of(name)}]"
