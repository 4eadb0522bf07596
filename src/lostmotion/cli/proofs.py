"""Proofs as commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .messages import finished, interruptible, say
from .options import ForceOption, acting, finite_positive, percent_below_100


def certify(
    context: typer.Context,
    drivetrain: Annotated[
        Path, typer.Argument(help="drivetrain.toml, as a run writes it, or a TOML of the main job.")
    ],
    law: Annotated[
        Path | None, typer.Option(help="law.json; default: the one beside it, or the nameplate's own law.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write: .json, _verify.py.")] = Path(
        "certificate"
    ),
    delay: Annotated[int, typer.Option(min=0, help="Computing delay, samples of the law.")] = 1,
    torque_load: Annotated[
        tuple[float, float] | None,
        typer.Option(
            help="Smallest and largest constant load torque in the direction of motion, Nm; default: none, or if "
            "nothing is proved then, one that resists it."
        ),
    ] = None,
    fastest: Annotated[
        float, typer.Option(callback=finite_positive, help="Largest load speed, rad/s.")
    ] = 1000.0,
    box: Annotated[
        float | None,
        typer.Option(
            callback=percent_below_100,
            help="Prove it for every drivetrain within ± so many percent of load inertia, stiffness, Coulomb friction "
            "and backlash. Ctrl-C keeps what is proved, the same command goes on.",
        ),
    ] = None,
    box_speed: Annotated[
        float, typer.Option(callback=finite_positive, help="Smallest load speed of a box, rad/s.")
    ] = 1.0,
    observer: Annotated[
        list[str] | None,
        typer.Option(
            help="Sensor (speed_motor, torque_shaft, …; repeat for more): prove how wrong its observer can be, "
            "instead of the loop."
        ),
    ] = None,
    simulate: Annotated[
        int,
        typer.Option(
            min=0,
            help="Simulate so many variants within ±10 percent beside the proof, and search for the worst start.",
        ),
    ] = 0,
    force: ForceOption = False,
) -> None:
    """Prove from which load speed on the loop is stable, with the whole gap, and write a certificate to check it."""
    of_a_loop = ("law", "delay", "torque_load", "fastest", "box", "box_speed", "simulate")
    acting(context, "--observer", bool(observer), *of_a_loop, without=True)
    acting(context, "--box", box is not None, "box_speed")
    acting(context, "--box", box is not None, "simulate", without=True)
    if observer:
        certify_an_observer(drivetrain, out, observer, force)
        return
    if box is not None:
        certify_a_box(drivetrain, law, out, delay, torque_load, fastest, box, box_speed, force)
        return
    from ..certificates.robustness.contact_margins import MARGIN_COLUMNS, margin_remark, margin_table
    from ..commands.certify import certify_file
    from ..display.tables import text
    from ..terminal import StageLines

    with interruptible(), StageLines() as lines:
        result = certify_file(
            drivetrain, out, law, delay, torque_load, fastest,
            lambda fraction, text: lines("certify", fraction, text), force, simulate,
        )  # fmt: skip
        lines("certify", 1.0)
    say(f"  {result['headline']}")
    if result["proved"]:
        say(f"  set-point there: {result['reference']:g} rad/s")
        say("  valid while " + ";\n              ".join(result["conditions"]))
    if result["margins"]:
        say(text([MARGIN_COLUMNS, *margin_table(result["margins"])]))
        if remark := margin_remark(result["margins"]):
            say(f"  {remark}")
    for sentence in result["simulated"]:
        say(f"  {sentence}")
    finished([], out, ".json", "_verify.py")


def certify_an_observer(drivetrain: Path, out: Path, measured: list[str], force: bool) -> None:
    """How wrong an observer can be."""
    from ..certificates import observer_headline
    from ..commands.certify_observer import certify_observer

    with interruptible():
        proof = certify_observer(drivetrain, out, measured, force)
    say(f"  {observer_headline(proof)}")
    finished([], out, ".json", "_verify.py")


def certify_a_box(
    drivetrain: Path,
    law: Path | None,
    out: Path,
    delay: int,
    torque_load: tuple[float, float] | None,
    fastest: float,
    percent: float,
    speed: float,
    force: bool,
) -> None:
    """The same for every drivetrain of a box."""
    from ..commands.certify_box import certify_box
    from ..interruption import INTERRUPTED
    from ..terminal import StageLines

    with interruptible(), StageLines() as lines:
        result = certify_box(
            drivetrain, out, percent, law, delay, torque_load, fastest, speed,
            progress=lambda fraction, text: lines("certify", fraction, text), force=force,
        )  # fmt: skip
        lines("certify", 1.0)
    say(f"  {result['headline']}")
    if result["proved"]:
        say("  valid while " + ";\n              ".join(result["conditions"]))
    if result["simulated"]:
        say(f"  {result['simulated']}")
    finished([], out, ".json", "_verify.py")
    if result["not_proved"] == "interrupted":
        say("Interrupted; the same command goes on from the cells that are proved.", fg="yellow", err=True)
        raise typer.Exit(INTERRUPTED)
