"""lostmotion loop: a law and the virtual rig as two processes, in lock-step or paced by the clock."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from .. import plot, rig, signals
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..export.compiler import find_compiler
from ..io import load_law, save_json
from ..realtime import LoopRun, run_loop
from ..recording import Recording
from ..rig.record import CHANNELS
from ..systems import DiscreteSystem, Stepper
from .cost import Announce, Cost, silent
from .outputs import outputs, save_picture
from .recordings import read_drive

Law = DiscreteSystem | Stepper
Code = Literal["c", "python"]

#: Memory (bytes) and time (s) of a sample in lock-step (calibrated on 2 000 and 50 000 samples of Observer 1 with pole
#: placement, C and Python, on two busy x86-64 cores).
MEMORY, SECONDS = 400.0, 7e-5


@dataclass(frozen=True, eq=False)
class LoopResult:
    """The run, what the law's process ran, and whether it equals the simulation bit for bit (None: not compared)."""

    run: LoopRun
    code: Code
    equal: bool | None


def loop_file(
    law: Path,
    drivetrain: Path | None,
    out: Path,
    *,
    seconds: float = 2.0,
    speed: float = 2.0,
    paced: bool = False,
    code: Code | None = None,
    port: int = 0,
    seed: int = 1,
    force: bool = False,
    progress: Callable[[float], None] | None = None,
    announce: Announce = silent,
) -> LoopResult:
    """Run the loop over a step of the set-point from −speed to speed (rad/s) in its middle; write OUT.json and OUT.png.

    With a drivetrain of two masses the rig is a finer plant of the same parameters (``rig.finer_rig``), with more the
    drivetrain itself with the rig's sensors; without one it is the virtual rig of the seed. The law's process runs the
    exported C by default, where there is a compiler and the law can be exported.
    """
    system, drive = load_law(law), None if drivetrain is None else read_drive(drivetrain)
    plant = rig.varied_rig(seed) if drive is None else rig_around(drive.drivetrain, seed)
    if code is None:
        code = "c" if isinstance(system, DiscreteSystem) and find_compiler() else "python"
    read = (law,) if drive is None else (law, *drive.reads)
    with outputs(out, ".json", ".png", sources=read, force=force) as (table, picture):
        samples = round(seconds / system.dt)
        Cost(float(samples), MEMORY, system.dt if paced else SECONDS).check(f"{seconds:g} s", announce)
        given = set_points(system, samples, speed)
        run = run_loop(system, plant, paced=paced, code=code, port=port, progress=progress, **given)
        equal = None
        if not paced:
            simulated, _ = rig.record(plant, law=system, dt=system.dt, **given)
            equal = same_bits(run.recording, simulated)
        timing = run.timing
        content = {"law": system.name, "code": code, **timing.summary(), "equals_simulation": equal}
        save_json(table, "loop timing", content)
        title = f"{system.name}, {'paced' if paced else 'lock-step'}: times of this machine"
        figure = plot.loop_timing(timing.round_trip, timing.wake_up, period=system.dt, title=title)
        save_picture(figure, picture)
    return LoopResult(run, code, equal)


def rig_around(plant: Drivetrain, seed: int) -> rig.Rig:
    """The rig that a drivetrain's law is tried on."""
    if len(plant.inertias) < 2:
        raise InvalidInput("loop: drivetrain", "one inertia", "two or more, with a load", "Give another one.")
    if len(plant.inertias) > 2:
        return rig.Rig(plant, rig.nominal_rig().sensors, seed)
    exact = {name: (value, value) for name, value in plant.parameters().items()}
    return rig.finer_rig(plant, exact, seed)


def set_points(law: Law, samples: int, speed: float) -> dict[str, Any]:
    """The step for the law's set-point, (n,) rad/s; raises ``InvalidInput`` where the law reads what no rig gives."""
    missing = sorted(set(law.inputs) - {"speed_reference", "torque_motor", *CHANNELS})
    if missing or "speed_reference" not in law.inputs or "torque_motor" not in law.outputs:
        raise InvalidInput(
            f"loop: {law.name}", f"inputs {law.inputs}, outputs {law.outputs}",
            f"speed_reference and any of {CHANNELS} as inputs, torque_motor as output",
            "Connect observer and controller to one law, and save that.",
        )  # fmt: skip
    if samples < 2:
        raise InvalidInput("loop: seconds", f"{samples} samples", "2 or more", "Lengthen the run.")
    half = samples // 2 * law.dt
    return {"speed_reference": signals.steps((half,), (-speed, speed), samples * law.dt, law.dt)}


def same_bits(one: Recording, other: Recording) -> bool:
    """Whether all signals are equal, zeros of equal sign and NaN included."""
    names: Any = one.signals.keys()
    return names == other.signals.keys() and all(one[n].tobytes() == other[n].tobytes() for n in names)
