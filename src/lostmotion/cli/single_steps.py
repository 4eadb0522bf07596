"""Single steps of the main job as commands."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .compiling import compile_kernels
from .messages import announce, finished, interruptible, say
from .options import (
    KINDS,
    METHODS,
    TESTS,
    ForceOption,
    SeedOption,
    acting,
    completing,
    finite_positive,
    known_method,
    known_test,
    positive,
    signals,
    spread_below_one,
)


def identify(
    file: Annotated[
        Path | None, typer.Argument(help="TOML with recordings; without: the virtual rig.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write, .json and .png.")] = Path(
        "identified"
    ),
    method: Annotated[
        str | None,
        typer.Option(help="One test alone: " + ", ".join(TESTS), autocompletion=completing(TESTS)),
    ] = None,
    seed: SeedOption = None,
    force: ForceOption = False,
) -> None:
    """Identify the drivetrain, or what one test tells, and nothing more; with --method, FILE may be an .npz."""
    from ..commands.identify import identify_file
    from ..terminal import StageLines, parameters

    compile_kernels("simulation", "identification")
    with interruptible(), StageLines() as lines:
        result = identify_file(
            file,
            out,
            seed,
            lambda fraction, text: lines("identify", fraction, text),
            force,
            known_test(method),
        )
    parameters(result["parameters"])
    finished(result["problems"], out, ".json", ".png")


def frf(
    file: Annotated[Path | None, typer.Argument(help="TOML or .npz; without: the virtual rig.")] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write, .json and .png.")] = Path("frf"),
    signal_in: Annotated[
        str, typer.Option("--input", help="Input signal.", autocompletion=signals)
    ] = "torque_motor",
    signal_out: Annotated[
        str, typer.Option("--output", help="Output signal.", autocompletion=signals)
    ] = "speed_motor",
    method: Annotated[str, typer.Option(help="H1, H2 or Hv.", autocompletion=completing(METHODS))] = "H1",
    reference: Annotated[str | None, typer.Option(help="Reference signal of a closed loop.")] = None,
    low: Annotated[float, typer.Option(help="Lowest frequency, Hz.")] = 1.0,
    high: Annotated[float, typer.Option(help="Highest frequency, Hz.")] = 200.0,
    seed: SeedOption = None,
    force: ForceOption = False,
) -> None:
    """Frequency response with coherence, and the two-mass drivetrain that fits it."""
    from ..commands.frf import frequency_response_file

    if file is None:
        compile_kernels("simulation")
    with interruptible():
        result = frequency_response_file(
            file, out, seed, signal_in, signal_out, known_method(method), reference, (low, high), force
        )
    fit = result["two_mass_fit"]
    if fit is not None and fit["values"]["pole"] is not None:
        say(f"  zero {fit['values']['zero']:.2f} Hz, pole {fit['values']['pole']:.2f} Hz")
        say("  If the gap opens during the test, both are too low: see docs/frequency-response.md.")
    finished(result["problems"], out, ".json", ".png")


def excite(
    file: Annotated[
        Path | None,
        typer.Argument(help="TOML of the main job, or drivetrain.toml; without: the virtual rig's."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write: .csv, .json, .png.")] = Path(
        "designed_torque"
    ),
    kind: Annotated[
        str,
        typer.Option(help="levels, step, chirp, multisine, prbs or noise.", autocompletion=completing(KINDS)),
    ] = "levels",
    duration: Annotated[float, typer.Option(callback=finite_positive, help="Length of the test, s.")] = 10.0,
    dt: Annotated[float, typer.Option(callback=finite_positive, help="Sample time of the drive, s.")] = 1e-4,
    torque_limit: Annotated[
        float | None,
        typer.Option(
            callback=positive, help="Largest torque, Nm; default: that of the TOML, on the virtual rig 40."
        ),
    ] = None,
    speed_limit: Annotated[
        float, typer.Option(callback=positive, help="Largest speed of motor and load, rad/s.")
    ] = 50.0,
    angle_limit: Annotated[
        float, typer.Option(callback=positive, help="Largest angle of motor and load from the start, rad.")
    ] = float("inf"),
    encoder_bits: Annotated[int, typer.Option(min=1, max=40, help="Motor encoder, bit per turn.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the signal.")] = 1,
    force: ForceOption = False,
) -> None:
    """Design the torque of a test within limits, and predict how well it identifies each parameter."""
    from ..commands.excite import excitation_file

    compile_kernels("simulation", "identification")
    with interruptible():
        result = excitation_file(
            file, out, kind=kind, duration=duration, dt=dt, torque_limit=torque_limit, speed_limit=speed_limit,
            angle_limit=angle_limit, encoder_bits=encoder_bits, seed=seed, force=force, announce=announce,
        )  # fmt: skip
    for name, unit in (("torque", "Nm"), ("speed", "rad/s"), ("angle", "rad")):
        peak, limit = result["peaks"][name], result["limits"][name]
        say(f"  {name:<15} up to {peak:.3g} of {limit:.3g} {unit}")
    for name, half in result["half_widths"].items():
        say(f"  {name:<15} ± {100.0 * half:.2g} % expected")
    for name in result["not_excited"]:
        say(f"  {name:<15} will not be identified")
    finished(result["problems"], out, ".csv", ".json", ".png")


def simulate(
    context: typer.Context,
    drivetrain: Annotated[
        Path, typer.Argument(help="drivetrain.toml, as a run writes it, or a TOML of the main job.")
    ],
    out: Annotated[Path, typer.Option(help="Name of the files to write: .csv, .png.")] = Path("simulated"),
    torque: Annotated[Path | None, typer.Option(help="CSV with time and torque_motor.")] = None,
    duration: Annotated[
        float,
        typer.Option(callback=finite_positive, help="Without a torque: length of the excitation, s."),
    ] = 10.0,
    dt: Annotated[
        float, typer.Option(callback=finite_positive, help="Without a torque: sample time, s.")
    ] = 1e-4,
    seed: Annotated[
        int, typer.Option(min=0, help="Seed of the variants and, without --torque, of the excitation.")
    ] = 1,
    variants: Annotated[
        int | None, typer.Option(min=1, help="Simulate so many variants instead; the CSV has a row for each.")
    ] = None,
    spread: Annotated[
        float,
        typer.Option(
            callback=spread_below_one, help="With variants: how far each number may be off, 0.2 for 20 %."
        ),
    ] = 0.2,
    force: ForceOption = False,
) -> None:
    """Simulate a drivetrain exactly, from event to event; or many variants of it (an interrupted run continues)."""
    acting(context, "--torque", torque is not None, "duration", "dt", without=True)
    acting(context, "--variants", variants is not None, "spread")
    compile_kernels("simulation")
    if variants is not None:
        _simulate_variants(drivetrain, out, variants, spread, torque, duration, dt, seed, force)
        return
    from ..commands.simulate import simulate_file

    with interruptible():
        recording = simulate_file(drivetrain, out, torque, duration, dt, seed, force, announce)
    say(f"  {len(recording)} samples, {len(recording.events)} events")
    finished([], out, ".csv", ".png")


def _simulate_variants(
    drivetrain: Path,
    out: Path,
    count: int,
    spread: float,
    torque: Path | None,
    duration: float,
    dt: float,
    seed: int,
    force: bool,
) -> None:
    from ..commands.simulate_variants import chunk_folder, simulate_variants
    from ..terminal import Countdown

    with interruptible("finished chunks", chunk_folder(out), "*.npz"), Countdown("variants") as bar:
        made = simulate_variants(
            drivetrain, out, count, spread, torque, duration, dt, seed, bar, force, announce
        )
    for index, message in made.failures.items():
        say(f"variant {index} failed: {message}", fg="yellow", err=True)
    say(f"  {int(made.done.sum())} of {count} variants")
    finished([], out, ".csv", *([".png"] if made.done.any() else []))
