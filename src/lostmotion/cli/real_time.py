"""The law against the clock as a command."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

import typer

from .compiling import compile_kernels
from .messages import announce, finished, interruptible, say
from .options import CODES, ForceOption, completing, finite_positive, known_code

#: What is shown of each time, and its key in the summary.
_LEVELS = (("median", "median"), ("99 %", "p99"), ("99.9 %", "p999"), ("largest", "largest"))


def loop(
    law: Annotated[Path, typer.Argument(help="law.json, as a run writes it: from set-point and sensors to torque.")],
    drivetrain: Annotated[
        Path | None,
        typer.Argument(help="drivetrain.toml of the rig's plant; without: the virtual rig of the seed."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write, .json and .png.")] = Path("loop"),
    seconds: Annotated[float, typer.Option(callback=finite_positive, help="Length of the run, s.")] = 2.0,
    speed: Annotated[
        float, typer.Option(callback=finite_positive, help="The set-point steps from −SPEED to SPEED, rad/s.")
    ] = 2.0,
    paced: Annotated[
        bool, typer.Option("--paced", help="By the clock, a sample at each tick; default: in lock-step.")
    ] = False,
    code: Annotated[
        str | None,
        typer.Option(
            callback=known_code, autocompletion=completing(CODES),
            help="What the law's process runs: c, as exported, or python; default: c where there is a compiler.",
        ),
    ] = None,
    port: Annotated[int, typer.Option(min=0, max=65535, help="UDP port of the rig; 0: a free one.")] = 0,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the rig.")] = 1,
    force: ForceOption = False,
) -> None:  # fmt: skip
    """Run law and rig as two processes over UDP; report the times of this machine, and equality with the simulation."""
    from ..commands.loop import loop_file
    from ..terminal import StageLines

    compile_kernels("simulation")
    with interruptible(), StageLines(every=0.25) as lines:
        result = loop_file(
            law, drivetrain, out, seconds=seconds, speed=speed, paced=paced, code=code, port=port, seed=seed,  # type: ignore[arg-type]
            force=force, progress=lambda fraction: lines("loop", fraction), announce=announce,
        )  # fmt: skip
        lines("loop", 1.0)
    say(f"  the law's process ran {'the exported C' if result.code == 'c' else 'the Python law'}")
    if result.equal is not None:
        say(f"  {'equal to' if result.equal else 'DIFFERENT from'} the simulation, bit for bit")
    _times(result.run.timing.summary())
    finished([], out, ".json", ".png")


def _times(summary: dict[str, Any]) -> None:
    from ..display.numbers import quantity

    say("  times of this machine, in this run:")
    for name, title in (("wake_up", "wake-up after the tick"), ("round_trip", "round trip")):
        if name in summary:
            parts = [f"{label} {quantity(summary[name][key], 's')}" for label, key in _LEVELS]
            say(f"    {title:<23} {', '.join(parts)}")
    if summary["paced"]:
        period = quantity(summary["period"], "s")
        say(
            f"    {summary['missed']} of {summary['samples']} deadlines of {period} missed, outputs held there"
        )
    elif summary["resent"]:
        say(f"    {summary['resent']} requests sent again")
