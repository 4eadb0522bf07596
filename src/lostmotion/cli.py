"""The command line: each command is a few lines around a function of the package."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from . import __version__
from .errors import InputProblems, LostMotionError, Problem

EXIT_CODES = (
    "Exit codes: 0 done (warnings included), 1 errors in the input or the output's place, 2 wrong usage, "
    "130 interrupted."
)
RUN_EXIT_CODES = f"{EXIT_CODES} With any but 0 nothing was written: an earlier output stays whole."
INPUT_ERROR, INTERRUPTED = 1, 130

app = typer.Typer(
    help="From a recording to an identified drivetrain with backlash, observer, controller, evidence and C code.",
    epilog=EXIT_CODES,
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


compare_app = typer.Typer(help="Leaderboards.", no_args_is_help=True)
app.add_typer(compare_app, name="compare")


def _positive(value: float | None) -> float | None:
    """An option that must be above zero; NaN is not."""
    if value is not None and not value > 0.0:
        raise typer.BadParameter(f"{value} is not above 0.")
    return value


def _finite_positive(value: float) -> float:
    if not 0.0 < value < math.inf:
        raise typer.BadParameter(f"{value} is not a finite number above 0.")
    return value


def _spread(value: float) -> float:
    if not 0.0 <= value < 1.0:
        raise typer.BadParameter(f"{value} is not in the range 0<=x<1; 0.2 is 20 %.")
    return value


SeedOption = Annotated[int | None, typer.Option(min=0, help="Seed; default: the TOML's, else 1.")]


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"lostmotion {__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and stop."),
    ] = False,
) -> None:
    pass


@app.command(epilog=RUN_EXIT_CODES)
def run(
    file: Annotated[
        Path | None, typer.Argument(help="TOML with your recordings; without: the virtual rig.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Output folder.")] = Path("lostmotion-out"),
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of rig and noise; default: the TOML's, else 1.")
    ] = None,
    force: Annotated[
        bool,
        typer.Option(
            "--force", help="Write although foreign or changed files lie in the folder; they are kept."
        ),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show errors only.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print results.json.")] = False,
) -> None:
    """The main job: read, identify, design, validate, export, report."""
    from .run import run as do_run
    from .run import silent
    from .terminal import StageLines, summary

    with _interruptible(), StageLines(shown=not (quiet or as_json)) as lines:
        results = do_run(file, out=out, seed=seed, force=force, progress=lines if lines.shown else silent)
    if as_json:
        typer.echo(json.dumps(results, indent=1, allow_nan=False))
    elif not quiet:
        summary(results, out)


@app.command(epilog=EXIT_CODES)
def check(
    file: Annotated[Path, typer.Argument(help="TOML to check, with all its recordings.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print the problems as JSON.")] = False,
) -> None:
    """Read a TOML and its recordings and show every problem; nothing is written."""
    from .io import load_recordings, read_configuration

    problems: list[Problem] = []
    try:
        loaded = load_recordings(read_configuration(file))
        problems += [p for _, recording in loaded for p in recording.meta.get("problems", ())]
    except InputProblems as error:
        problems += error.problems
    failed = any(p.severity == "error" for p in problems)
    if as_json:
        typer.echo(json.dumps([p.as_dict() for p in problems], indent=1))
    else:
        _show(problems)
        if not failed:
            typer.echo(f"{file}: readable, {len(problems)} warning{'' if len(problems) == 1 else 's'}.")
    raise typer.Exit(INPUT_ERROR if failed else 0)


@app.command(epilog=EXIT_CODES)
def init(
    file: Annotated[Path, typer.Argument(help="TOML to write.")] = Path("my_rig.toml"),
    force: Annotated[bool, typer.Option("--force", help="Replace an existing file.")] = False,
) -> None:
    """Write a commented TOML to fill in."""
    from .errors import InvalidInput
    from .io import template

    if file.exists() and not force:
        raise InvalidInput(str(file), "an existing file", "a new name", "Choose another name, or --force.")
    try:
        file.write_text(template(), encoding="utf-8")
    except OSError as error:
        raise InvalidInput(
            str(file), error.strerror or "an error", "a place to write", "Choose another."
        ) from None
    typer.echo(f"{file} written: fill it in, then: lostmotion check {file}")


@app.command(epilog=EXIT_CODES)
def identify(
    file: Annotated[
        Path | None, typer.Argument(help="TOML with recordings; without: the virtual rig.")
    ] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write, .json and .png.")] = Path(
        "identified"
    ),
    seed: SeedOption = None,
) -> None:
    """Identify the drivetrain alone."""
    from .commands.identify import identify_file
    from .terminal import StageLines, parameters

    with _interruptible(), StageLines() as lines:
        result = identify_file(file, out, seed, lambda fraction, text: lines("identify", fraction, text))
    parameters(result["parameters"])
    _finished(result["problems"], out, ".json", ".png")


@app.command(epilog=EXIT_CODES)
def frf(
    file: Annotated[Path | None, typer.Argument(help="TOML or .npz; without: the virtual rig.")] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write, .json and .png.")] = Path("frf"),
    signal_in: Annotated[str, typer.Option("--input", help="Input signal.")] = "torque_motor",
    signal_out: Annotated[str, typer.Option("--output", help="Output signal.")] = "speed_motor",
    method: Annotated[str, typer.Option(help="H1, H2 or Hv.")] = "H1",
    reference: Annotated[str | None, typer.Option(help="Reference signal of a closed loop.")] = None,
    low: Annotated[float, typer.Option(help="Lowest frequency, Hz.")] = 1.0,
    high: Annotated[float, typer.Option(help="Highest frequency, Hz.")] = 200.0,
    seed: SeedOption = None,
) -> None:
    """Frequency response with coherence and the two masses that fit it."""
    from .commands.frf import frequency_response_file

    with _interruptible():
        result = frequency_response_file(
            file, out, seed, signal_in, signal_out, _method(method), reference, (low, high)
        )
    fit = result["two_mass_fit"]
    if fit is not None:
        typer.echo(f"  zero {fit['values']['zero']:.2f} Hz, pole {fit['values']['pole']:.2f} Hz")
        typer.echo(
            "  A gap that opens during the test lowers both: docs/frequency-response.md says by how much."
        )
    _finished(result["problems"], out, ".json", ".png")


@app.command(epilog=EXIT_CODES)
def excite(
    file: Annotated[
        Path | None,
        typer.Argument(help="TOML of the main job, or drivetrain.toml; without: the virtual rig's."),
    ] = None,
    out: Annotated[Path, typer.Option(help="Name of the files to write: .csv, .json, .png.")] = Path(
        "designed_torque"
    ),
    kind: Annotated[str, typer.Option(help="levels, step, chirp, multisine, prbs or noise.")] = "levels",
    duration: Annotated[float, typer.Option(callback=_finite_positive, help="s")] = 10.0,
    dt: Annotated[float, typer.Option(callback=_finite_positive, help="Sample time of the drive, s.")] = 1e-4,
    torque_limit: Annotated[
        float | None,
        typer.Option(callback=_positive, help="Nm; default: the torque_limit of the TOML, else 40."),
    ] = None,
    speed_limit: Annotated[float, typer.Option(callback=_positive, help="rad/s")] = 50.0,
    angle_limit: Annotated[float, typer.Option(callback=_positive, help="rad")] = float("inf"),
    encoder_bits: Annotated[int, typer.Option(min=1, max=40, help="Motor encoder, bit per turn.")] = 20,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the signal.")] = 1,
) -> None:
    """Design the torque of a test within limits, and say beforehand how well it will tell each parameter."""
    from .commands.excite import excitation_file

    with _interruptible():
        result = excitation_file(
            file, out, kind=kind, duration=duration, dt=dt, torque_limit=torque_limit, speed_limit=speed_limit,
            angle_limit=angle_limit, encoder_bits=encoder_bits, seed=seed,
        )  # fmt: skip
    for name, unit in (("torque", "Nm"), ("speed", "rad/s"), ("angle", "rad")):
        peak, limit = result["peaks"][name], result["limits"][name]
        typer.echo(f"  {name:<15} up to {peak:.3g} of {limit:.3g} {unit}")
    for name, half in result["half_widths"].items():
        typer.echo(f"  {name:<15} ± {100.0 * half:.2g} % expected")
    for name in result["not_excited"]:
        typer.echo(f"  {name:<15} will not be told")
    _finished(result["problems"], out, ".csv", ".json", ".png")


@app.command(epilog=EXIT_CODES)
def simulate(
    drivetrain: Annotated[
        Path, typer.Argument(help="drivetrain.toml, as a run writes it, or a TOML of the main job.")
    ],
    out: Annotated[Path, typer.Option(help="CSV to write; a picture, .png, goes beside it.")] = Path(
        "simulated.csv"
    ),
    torque: Annotated[Path | None, typer.Option(help="CSV with time and torque_motor.")] = None,
    duration: Annotated[
        float,
        typer.Option(callback=_finite_positive, help="Without a torque: length of the excitation, s."),
    ] = 10.0,
    dt: Annotated[
        float, typer.Option(callback=_finite_positive, help="Without a torque: sample time, s.")
    ] = 1e-4,
    seed: Annotated[
        int, typer.Option(min=0, help="Of the variants, and without a torque of the excitation.")
    ] = 1,
    variants: Annotated[
        int | None, typer.Option(min=1, help="Simulate so many variants instead; the CSV has a row for each.")
    ] = None,
    spread: Annotated[
        float,
        typer.Option(callback=_spread, help="With variants: how far each number may be off, 0.2 for 20 %."),
    ] = 0.2,
) -> None:
    """Simulate a drivetrain exactly, from event to event; or variants of it, going on after an interruption."""
    if variants is not None:
        _simulate_variants(drivetrain, out, variants, spread, torque, duration, dt, seed)
        return
    from .commands.simulate import simulate_file

    with _interruptible():
        recording = simulate_file(drivetrain, out, torque, duration, dt, seed)
    typer.echo(f"  {len(recording)} samples, {len(recording.events)} events")
    _finished([], out.with_suffix(""), out.suffix, ".png")


def _list_names(wanted: bool) -> None:
    if wanted:
        from .compare import CASES, CONTESTANTS

        for what, entries in (("Cases", CASES), ("Observers", CONTESTANTS)):
            typer.echo("\n  ".join([f"{what}:", *(entry.name for entry in entries)]))
        raise typer.Exit


@compare_app.command(epilog=EXIT_CODES)
def observers(
    out: Annotated[
        Path | None,
        typer.Option(
            help="Folder of the leaderboard; finished parts are kept. "
            "Default: leaderboard, with --quick leaderboard-quick, with --case or --observer leaderboard-part."
        ),
    ] = None,
    quick: Annotated[
        bool,
        typer.Option(
            "--quick",
            help="Two seeds, fewer cases, short recordings: two minutes of processor time at first.",
        ),
    ] = False,
    seeds: Annotated[int | None, typer.Option(min=1, help="Number of rigs; default 20, quick 2.")] = None,
    case: Annotated[
        list[str] | None, typer.Option(help="A case by its name (see --list); repeat it for more.")
    ] = None,
    observer: Annotated[
        list[str] | None, typer.Option(help="An observer by its name (see --list); repeat it for more.")
    ] = None,
    force: Annotated[
        bool, typer.Option("--force", help="Replace a larger table in the folder; its scores are kept.")
    ] = False,
    names: Annotated[
        bool,
        typer.Option(
            "--list", is_eager=True, callback=_list_names, help="List cases and observers, and stop."
        ),
    ] = False,
) -> None:
    """All observers over the same recordings of the virtual rig, as a leaderboard."""
    from .terminal import StageLines

    part = bool(case or observer)
    out = out or Path("leaderboard-part" if part else "leaderboard-quick" if quick else "leaderboard")
    with _interruptible("finished parts", out / "scores", "*.json"), StageLines(every=0.1) as lines:
        from .compare import compare_observers

        lines("compare", 0.0)
        board = compare_observers(
            out, quick=quick, seeds=seeds, cases=case or None, observers=observer or None, force=force,
            progress=lambda fraction, text: lines("compare", fraction, text),
        )  # fmt: skip
        lines("compare", 1.0)
    typer.echo(board.to_markdown())
    _finished([], out, *(f"/leaderboard.{ending}" for ending in ("md", "json", "csv", "svg")))


def _simulate_variants(
    drivetrain: Path,
    out: Path,
    count: int,
    spread: float,
    torque: Path | None,
    duration: float,
    dt: float,
    seed: int,
) -> None:
    from .commands.simulate_variants import chunk_folder, simulate_variants
    from .terminal import Countdown

    with _interruptible("finished chunks", chunk_folder(out), "*.npz"), Countdown("variants") as bar:
        made = simulate_variants(drivetrain, out, count, spread, torque, duration, dt, seed, bar)
    for index, message in made.failures.items():
        typer.secho(f"variant {index} failed: {message}", fg="yellow", err=True)
    typer.echo(f"  {int(made.done.sum())} of {count} variants")
    _finished([], out.with_suffix(""), out.suffix, *([".png"] if made.done.any() else []))


def _method(name: str) -> Any:
    if name not in ("H1", "H2", "Hv"):
        raise typer.BadParameter(f"{name!r} is none of H1, H2, Hv", param_hint="--method")
    return name


def _finished(problems: list[dict[str, str]], out: Path, *endings: str) -> None:
    """Warnings on standard error, then the files written."""
    _show([Problem(**p) for p in problems])  # type: ignore[arg-type]
    typer.echo("  written: " + ", ".join(f"{out}{ending}" for ending in endings))


@contextmanager
def _interruptible(parts: str = "", folder: Path | None = None, files: str = "*") -> Iterator[None]:
    """Ctrl-C becomes a message and an exit code (typer itself would end without a word).

    ``parts`` are what the command goes on from: ``files`` in the folder, where there are any by then.
    """
    try:
        yield
    except KeyboardInterrupt:
        kept = "an earlier output is as it was"
        if folder is not None and any(folder.rglob(files)):
            kept = f"{parts} stand in {folder}, the same command goes on"
        typer.secho(f"Interrupted; {kept}.", fg="yellow", err=True)
        raise typer.Exit(INTERRUPTED) from None


def _show(problems: list[Problem]) -> None:
    for p in problems:
        typer.secho(f"{p.severity}: {p.where}", fg="red" if p.severity == "error" else "yellow", err=True)
        typer.echo(f"    got       {p.got}\n    expected  {p.expected}\n    remedy    {p.remedy}", err=True)


def main() -> None:
    """Entry point: every error of the package becomes a message and an exit code."""
    try:
        app()
    except InputProblems as error:
        _show(list(error.problems))
        sys.exit(INPUT_ERROR)
    except LostMotionError as error:
        problem = getattr(error, "problem", None)
        if isinstance(problem, Problem):
            _show([problem])
        else:
            typer.secho(f"error: {error}", fg="red", err=True)
        sys.exit(INPUT_ERROR)
