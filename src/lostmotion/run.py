"""The main job: from recordings to an identified drivetrain, validated observers and controllers, C code, a report."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol

from . import __version__
from .argument_checks import checks_arguments
from .io import Configuration, output_folder, read_configuration, save_drivetrain, save_json, save_recording
from .plot import source_of
from .report import write_report
from .stages.code import write_code
from .stages.design import Design, design
from .stages.figures import figures, stability_figure
from .stages.material import Material, from_configuration, from_rig
from .stages.parameters import Found, find_parameters
from .stages.proof import prover
from .stages.single_tests import single_tests
from .stages.validation import Validation, validate


class Progress(Protocol):
    """What shows the progress: a stage begins, gets on (0 … 1), ends."""

    def __call__(self, stage: str, fraction: float, text: str = "") -> None: ...


def silent(stage: str, fraction: float, text: str = "") -> None:
    """No progress shown."""


@checks_arguments
def run(
    configuration: str | Path | Configuration | None = None,
    *,
    out: str | Path = "lostmotion-out",
    seed: int | None = None,
    force: bool = False,
    progress: Progress = silent,
) -> dict[str, Any]:
    """Do the main job and write its output folder, whole or not at all.

    Parameters
    ----------
    configuration : path of a TOML, Configuration, or None
        None: the built-in virtual rig.
    out : path
        Output folder; that of an earlier run is replaced.
    seed : int, optional
        Seed of the virtual rig and of everything random; default: the configuration's, else 1.
    force : bool
        Write although foreign files, or changed ones, lie in the folder; they are kept.
    progress : callable
        Called with the stage's name, the share of it that is done, and what it does.

    Returns
    -------
    dict
        What stands in ``results.json``.

    Raises
    ------
    InputProblems
        All errors of the TOML and its recordings together.
    InvalidInput
        If the output folder cannot be used.
    """
    timing: dict[str, float] = {}
    with output_folder(out, force=force) as folder, prover() as proof:
        with _stage("read", timing, progress):
            material, truth = _read(configuration, seed)
        with _stage("identify", timing, progress):
            found = find_parameters(material, lambda fraction, text: progress("identify", fraction, text))
            found = found.with_tests(single_tests(material))
        with _stage("design", timing, progress):
            laws = design(material, found)
        proof.begin(laws, found.drivetrain, folder)
        with _stage("validate", timing, progress):
            validation = validate(material, found, laws)
        with _stage("export", timing, progress):
            code, code_problems = write_code(laws, folder, found.drivetrain)
        with _stage("draw", timing, progress):
            true_parameters = None if truth is None else _true_values(truth)
            drawn = figures(material, found, laws, validation, true_parameters)
            for figure in drawn:
                figure.draw()
        with _stage("prove", timing, progress):
            stability = proof.result()
        results = _results(material, found, laws, validation, code)
        results["stability"] = stability
        results["problems"] += [p.as_dict() for p in code_problems]
        if truth is not None:
            results["truth"] = {"parameters": true_parameters}
        with _stage("report", timing, progress):
            _write_data(folder, material, found, validation, truth)
            results["timing_s"] = timing
            write_report(
                folder / "report.html",
                {**results, **_report_only(material)},
                [*drawn, *stability_figure(stability)],
                command=_command(configuration, material.seed),
            )
        save_json(folder / "results.json", "results", results)
    return results


@contextmanager
def _stage(name: str, timing: dict[str, float], progress: Progress) -> Iterator[None]:
    progress(name, 0.0)
    start = time.perf_counter()
    yield
    timing[name] = time.perf_counter() - start
    progress(name, 1.0)


def _read(configuration: str | Path | Configuration | None, seed: int | None) -> tuple[Material, Any]:
    if configuration is None:
        return from_rig(1 if seed is None else seed)
    if not isinstance(configuration, Configuration):
        configuration = read_configuration(configuration)
    return from_configuration(configuration, seed), None


def _results(
    material: Material, found: Found, laws: Design, validation: Validation, code: Mapping[str, Any]
) -> dict[str, Any]:
    problems = (*material.problems, *found.problems, *laws.problems, *validation.problems)
    fits = dict(found.fits)
    if found.skipped:
        fits["prediction error"] = {"skipped": found.skipped}
    return {
        "seed": material.seed,
        "version": __version__,
        "inputs": dict(material.inputs),
        "parameters": dict(found.table),
        "fits": fits,
        "design": dict(laws.taken),
        "observers": dict(validation.observers),
        "controllers": dict(validation.controllers),
        "export": dict(code),
        "problems": [p.as_dict() for p in problems],
    }


def _report_only(material: Material) -> dict[str, Any]:
    recordings = {
        name: {
            "samples": len(r),
            "duration": float(r.time[-1] - r.time[0]),
            "sample_time": r.dt,
            "use": material.uses[name],
            "origin": "virtual rig (simulated)" if material.virtual else source_of(r),
            "signals": list(r.names),
            "file": Path(str(r.meta["file"])).name if "file" in r.meta else None,
        }
        for name, r in material.recordings.items()
    }
    return {"recordings": recordings}


def _write_data(folder: Path, material: Material, found: Found, validation: Validation, truth: Any) -> None:
    if found.drivetrain is not None:
        save_drivetrain(found.drivetrain, folder / "drivetrain.toml")
    (folder / "recordings").mkdir()
    named = {**material.recordings, **validation.estimates}
    named |= {f"control_{name}": response for name, response in validation.responses.items()}
    for name, recording in named.items():
        save_recording(recording, folder / "recordings" / f"{name}.npz")
    if truth is not None:
        save_json(folder / "truth.json", "truth", {"parameters": _true_values(truth)})


def _true_values(truth: Any) -> dict[str, Any]:
    """What the table of parameters may be held against."""
    return {**truth.parameters, "inertia_total": truth.drivetrain.inertia_total}


def _command(configuration: str | Path | Configuration | None, seed: int) -> str:
    if configuration is None:
        return f"lostmotion run --seed {seed}"
    path = configuration.path if isinstance(configuration, Configuration) else configuration
    return f"lostmotion run {path} --seed {seed}"
