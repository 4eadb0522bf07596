"""lostmotion simulate: a drivetrain from its file under a torque from a CSV, as CSV and picture."""

from __future__ import annotations

from pathlib import Path

from .. import plot, signals
from ..io import load_drivetrain, read_recording, write_csv
from ..recording import Recording
from ..simulation import simulate


def simulate_file(
    drivetrain: Path,
    out: Path,
    torque: Path | None = None,
    duration: float = 10.0,
    dt: float = 1e-4,
    seed: int = 1,
) -> Recording:
    """Simulate and write OUT (CSV) and the picture OUT.png beside it.

    Without a torque: ``signals.excitation`` for the drivetrain's inertia and friction. With one, its sample time is
    the simulation's.
    """
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
    out.parent.mkdir(parents=True, exist_ok=True)
    write_csv(out, recording)
    figure = plot.recording_overview(recording, title=f"{drivetrain.name} (simulated)")
    figure.savefig(out.with_suffix(".png"), dpi=110, facecolor="white")
    return recording
