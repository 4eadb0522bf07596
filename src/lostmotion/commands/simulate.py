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
from .recordings import check_writable, drivetrain_of, save_picture


def simulate_file(
    drivetrain: Path,
    out: Path,
    torque: Path | None = None,
    duration: float = 10.0,
    dt: float = 1e-4,
    seed: int = 1,
) -> Recording:
    """Simulate and write OUT, which ends in .csv, and a picture beside it that ends in .png instead.

    Without a torque: ``signals.excitation`` for the drivetrain's inertia and friction. With one, its sample time is
    the simulation's.
    """
    check_ending(out)
    check_writable(out, out.with_suffix(".png"), source=drivetrain)
    plant = drivetrain_of(drivetrain)
    given, dt = torque_of(plant, torque, duration, dt, seed)
    recording = simulate(plant, torque_motor=given, dt=dt)
    write_csv(out, recording)
    figure = plot.recording_overview(recording, title=f"{drivetrain.name} (simulated)")
    save_picture(figure, out.with_suffix(".png"))
    return recording


def check_ending(out: Path) -> None:
    if out.suffix != ".csv":
        raise InvalidInput(
            str(out), f"the ending {out.suffix!r}", "'.csv'", "The picture's name follows from it."
        )


def torque_of(
    plant: Drivetrain, torque: Path | None, duration: float, dt: float, seed: int
) -> tuple[NDArray[np.float64], float]:
    """The torque on the motor, Nm, and its sample time, s: from a file, or an excitation for this drivetrain."""
    if torque is not None:
        played = read_recording(torque)
        return played["torque_motor"], played.dt
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
