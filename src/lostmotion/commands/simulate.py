"""lostmotion simulate: a drivetrain from its file under a torque from a CSV, as CSV and picture."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from .. import plot, signals
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io import read_recording, write_csv
from ..recording import Recording
from ..simulation import simulate
from .cost import Announce, Cost, silent
from .outputs import outputs, save_picture
from .recordings import read_drive

#: Bytes of memory and seconds that a sample takes, with its row of the CSV: a constant, and for each inertia
#: (calibrated with 500 000 samples on an Intel Xeon: 53 and 140 bytes, 3 and 6 µs of processor time for one and two
#: inertias; here twice that and more, for a busy machine; contact states, of which long chains have thousands, come on
#: top).
MEMORY, SECONDS = (100.0, 100.0), (6e-6, 3e-6)


def simulate_file(
    drivetrain: Path,
    out: Path,
    torque: Path | None = None,
    duration: float = 10.0,
    dt: float = 1e-4,
    seed: int = 1,
    force: bool = False,
    announce: Announce = silent,
) -> Recording:
    """Simulate; write a CSV and a picture.

    Without a torque: ``signals.excitation`` for the drivetrain's inertia and friction. With one, its sample time is
    the simulation's. ``announce`` is called with what a long one will cost.
    """
    drive = read_drive(drivetrain)
    plant = drive.drivetrain
    read = drive.reads if torque is None else (*drive.reads, torque)
    with outputs(out, ".csv", ".png", sources=read, force=force) as (table, picture):
        count = len(plant.inertias)
        memory, seconds = (constant + each * count for constant, each in (MEMORY, SECONDS))
        given, dt = torque_of(plant, torque, duration, dt, seed, Cost(1.0, memory, seconds), announce)
        recording = simulate(plant, torque_motor=given, dt=dt)
        write_csv(table, recording)
        save_picture(plot.recording_overview(recording, title=f"{drivetrain.name} (simulated)"), picture)
    return recording


def torque_of(
    plant: Drivetrain,
    torque: Path | None,
    duration: float,
    dt: float,
    seed: int,
    each: Cost,
    announce: Announce,
) -> tuple[NDArray[np.float64], float]:
    """The torque on the motor, Nm, and its sample time, s: from a file, or an excitation for this drivetrain.

    ``each`` is the cost for each sample of the torque; that of all is checked before anything is made.
    """
    if torque is not None:
        played = read_recording(torque)
        if "torque_motor" not in played:
            raise InvalidInput(str(torque), f"columns {list(played)}", "a column torque_motor, Nm", "Add it.")
        Cost(each.samples * len(played), each.memory, each.seconds).check(str(torque), announce)
        return played["torque_motor"], played.dt
    check_times(duration, dt)
    samples = each.samples * duration / dt
    Cost(samples, each.memory, each.seconds).check(f"{duration:g} s at {dt:g} s", announce)
    friction = plant.frictions[-1]
    given = signals.excitation(
        duration,
        dt,
        seed=seed,
        inertia=plant.inertia_total,
        coulomb=friction.coulomb_plus,
        viscous=friction.viscous,
    )
    return given, dt


def check_times(duration: float, dt: float) -> None:
    """Raises ``InvalidInput`` where they are no positive numbers."""
    for name, value in (("duration", duration), ("dt", dt)):
        if not (np.isfinite(value) and value > 0.0):
            raise InvalidInput(name, f"{value} s", "a positive number", "Check it.")
