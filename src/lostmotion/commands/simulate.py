"""lostmotion simulate: a drivetrain from its file under a torque from a CSV, as CSV and picture."""

from __future__ import annotations

from pathlib import Path

from .. import plot, signals
from ..errors import InvalidInput
from ..io import load_drivetrain, read_recording, write_csv
from ..recording import Recording
from ..simulation import simulate
from .recordings import check_writable, save_picture


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
    if out.suffix != ".csv":
        raise InvalidInput(
            str(out), f"the ending {out.suffix!r}", "'.csv'", "The picture's name follows from it."
        )
    check_writable(out, out.with_suffix(".png"))
    plant = load_drivetrain(drivetrain)
    if torque is None:
        friction = plant.frictions[-1]
        given = signals.excitation(
            duration,
            dt,
            seed=seed,
            inertia=plant.inertia_total,
            coulomb=friction.coulomb_plus,
            viscous=friction.viscous,
        )
    else:
        played = read_recording(torque)
        given, dt = played["torque_motor"], played.dt
    recording = simulate(plant, torque_motor=given, dt=dt)
    write_csv(out, recording)
    figure = plot.recording_overview(recording, title=f"{drivetrain.name} (simulated)")
    save_picture(figure, out.with_suffix(".png"))
    return recording
