"""C99 code of a discrete law: header, source, a test that replays vectors, and a README."""

from __future__ import annotations

import os
import re
import tempfile
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from ..argument_checks import checks_arguments
from ..curves import PiecewiseLinear
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..io.storage.whole_files import make_folder, write_bytes
from ..io.storage.written_files import replacing
from ..plain_data import seed_of
from ..systems import DiscreteSystem, Stepper
from .compiler import C_FLAGS, NO_COMPILER, find_compiler, run
from .facts import facts, spelling
from .stepper_context import stepper_context

#: Largest difference, relative to the largest output, up to which a check passes in single precision (option:
#: a thousand roundings of 6e-8). In double precision not a bit may differ.
FLOAT_TOLERANCE = 1e-4

_FILES = {"law.h.jinja": ".h", "law_test.c.jinja": "_test.c"}

# C99 keywords that are valid Python identifiers.
_KEYWORDS = frozenset(
    """auto break case char const continue default do double else enum extern float for goto if inline int
    long
    register restrict return short signed sizeof static struct switch typedef union unsigned void volatile
    while""".split()  # noqa: SIM905
)


@dataclass(frozen=True)
class ExportCheck:
    """What compiling and running the exported code gave.

    ``max_difference`` is the largest absolute difference from the test vectors, None if there was nothing to
    compare; ``passed`` says whether it is small enough (zero in double precision); ``message`` says what went
    wrong, or why the check was skipped; ``compiler`` is None where there is none.
    """

    max_difference: float | None
    compiler: str | None
    passed: bool
    message: str = ""

    @property
    def skipped(self) -> bool:
        return self.compiler is None


@checks_arguments
def c(
    law: DiscreteSystem | Stepper,
    folder: str | os.PathLike[str],
    name: str = "law",
    real: Literal["double", "float"] = "double",
    *,
    vectors: int = 400,
    seed: int = 1,
    drivetrain: Drivetrain | None = None,
    force: bool = False,
) -> tuple[Path, ...]:
    """Write a law as C99: no heap, no library, one typedef for the number type.

    Parameters
    ----------
    law : DiscreteSystem, or Stepper that is ``exportable``
        Its input and output names must be C identifiers.
    folder : path
        Made if it is missing; files of the same names are replaced if this function has written them.
    name : str
        C identifier: the files are NAME.h, NAME.c, NAME_test.c and README.md, the functions NAME_init and
        NAME_step.
    real : {"double", "float"}
        Number type of the typedef NAME_real; of a Stepper double.
    vectors : int
        Samples in the test: random inputs, with drop-outs (NaN, infinity, absurd values) among them.
    seed : int
        Seed of the test inputs.
    drivetrain : Drivetrain, optional
        What the law was made for: its parameters go into README and header.
    force : bool
        Replace files that this function has not written, or that were changed since.

    Returns
    -------
    tuple of Path
        The files written.

    Raises
    ------
    InvalidInput
        If a name is no C identifier, ``real`` is unknown, vectors < 2, a Stepper is not exportable, a file would
        replace one that was not written here or was changed since, or cannot be written.

    Notes
    -----
    README and header bear the date; the environment variable SOURCE_DATE_EPOCH sets it.
    """
    _check(law, name, real, vectors)
    folder = Path(folder)
    source, made = (
        ("stepper.c.jinja", stepper_context(law, name, real))
        if isinstance(law, Stepper)
        else ("law.c.jinja", _context(law, name, real))
    )
    context = made | facts(law, drivetrain)
    inputs, outputs, faults = _vectors(law, vectors, seed_of("export.c: seed", seed))
    context["vector_inputs"] = [[_vector(v) for v in row] for row in inputs]
    context["vector_outputs"] = [[_vector(v) for v in row] for row in outputs]
    context["vector_faults"] = faults.tolist()
    targets = {template: f"{name}{ending}" for template, ending in {**_FILES, source: ".c"}.items()}
    files = {folder / file_name: template for template, file_name in targets.items()}
    files[folder / "README.md"] = "README.md.jinja"
    with replacing(*files, force=force):
        make_folder(folder)
        for path, template in files.items():
            write_bytes(path, _environment().get_template(template).render(context).encode("utf-8"))
    return tuple(files)


def compile_and_check(folder: str | os.PathLike[str], name: str = "law") -> ExportCheck:
    """Compile the exported law with the system's C compiler, replay its vectors, and report the difference.

    A missing compiler, a failed compilation and a difference are results, not exceptions; compiled files go
    to a temporary folder. The environment variable CC is respected, else cc, gcc and clang are tried.
    """
    compiler = find_compiler()
    if compiler is None:
        return ExportCheck(None, None, False, NO_COMPILER)
    folder = Path(folder).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        program = Path(scratch) / "law_test"
        sources = [str(folder / f"{name}.c"), str(folder / f"{name}_test.c")]
        built = run([compiler, *C_FLAGS, "-o", str(program), *sources])
        if built.returncode != 0:
            return ExportCheck(None, compiler, False, f"does not compile: {built.stderr.strip()}")
        ran = run([str(program)])
    found = re.search(r"max_difference (\S+) of (\S+) real_size (\d+) faults_differ (\d+)", ran.stdout)
    if ran.returncode != 0 or not found:
        return ExportCheck(None, compiler, False, f"the test stopped: {ran.stdout}{ran.stderr}")
    difference, largest = float(found[1]), float(found[2])
    allowed = 0.0 if int(found[3]) >= 8 else FLOAT_TOLERANCE * largest
    passed = difference <= allowed and int(found[4]) == 0
    return ExportCheck(
        difference, compiler, passed, "" if passed else f"outputs differ: {ran.stdout.strip()}"
    )


def _check(law: DiscreteSystem | Stepper, name: str, real: str, vectors: int) -> None:
    for identifier in (name, *law.inputs, *law.outputs):
        if not re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", identifier) or identifier in _KEYWORDS:
            raise InvalidInput("export.c", repr(identifier), "a C identifier", "Rename it with renamed().")
    if real not in ("double", "float"):
        raise InvalidInput("export.c: real", repr(real), "double or float", "Choose one.")
    if isinstance(law, Stepper) and not law.exportable:
        raise InvalidInput(
            "export.c", f"the Stepper {law.name}", "a DiscreteSystem, or a Stepper that is exportable",
            "Take a law of that form, for instance the observer kalman.",
        )  # fmt: skip
    if isinstance(law, Stepper) and real != "double":
        raise InvalidInput("export.c: real", repr(real), "double for an exportable Stepper", "Take double.")
    if vectors < 2:
        raise InvalidInput("export.c: vectors", repr(vectors), "at least 2", "Take the default.")


def _vectors(
    law: DiscreteSystem | Stepper, n: int, seed: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.int64]]:
    """Random inputs in runs of ten samples, some frozen, one value in forty bad, and what the Python law makes of them.

    The values are exact in single precision, so that the float code is compared on the very same inputs.
    """
    rng = np.random.default_rng(seed)
    inputs = np.repeat(rng.normal(size=(-(-n // 10), len(law.inputs))), 10, axis=0)[:n]
    moving = np.repeat(rng.random((-(-n // 10), len(law.inputs))) < 0.8, 10, axis=0)[:n]
    inputs = (inputs + 0.1 * rng.normal(size=inputs.shape) * moving).astype(np.float32).astype(np.float64)
    bad = rng.random(inputs.shape) < 1.0 / 40.0
    inputs[bad] = rng.choice([np.nan, np.inf, -np.inf, 2e30], size=inputs.shape)[bad]
    return inputs, *_run(law, inputs)


def _run(
    law: DiscreteSystem | Stepper, inputs: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Outputs and fault masks."""
    if isinstance(law, Stepper):
        from ..kernels.estimators.runner import run_stepper

        return run_stepper(law.functions.step, law.parameters.copy(), law.init(), inputs, len(law.outputs))
    from ..kernels.law.step import law_run

    return law_run(law.tables(), law.init(), inputs)


def _vector(value: float) -> str:
    if np.isnan(value):
        return "NAN"
    if np.isinf(value):
        return "INFINITY" if value > 0 else "-INFINITY"
    return repr(float(value))


def _context(law: DiscreteSystem, name: str, real: str) -> dict[str, Any]:
    from ..kernels.law import input_check as rule

    symbols = [
        *(f"x{i}" for i in range(len(law.states))),
        *(f"u{i}" for i in range(len(law.inputs))),
        *(f"w{i}" for i in range(len(law.curves))),
    ]

    def terms(matrix: NDArray[np.float64]) -> list[list[tuple[str, str]]]:
        return [[(repr(float(row[j])), symbols[j]) for j in np.flatnonzero(row)] for row in matrix]

    rows = {
        "z_rows": terms(np.hstack([law.F, law.G, law.H])),
        "y_rows": terms(np.hstack([law.C, law.D, law.J])),
        "x_rows": terms(np.hstack([law.A, law.B, law.E])),
        "p_rows": terms(np.hstack([law.P, law.Q, law.R])),
    }
    used = {symbol for block in rows.values() for row in block for _, symbol in row}
    return {
        **rows,
        "unused": [symbol for symbol in symbols if symbol not in used],
        **spelling(law, name, real),
        "states": law.states,
        "initial_state": [repr(float(v)) for v in law.initial_state],
        "curves": [_segments(curve) for curve in law.curves],
        "early_curves": law.early_curves,
        "checks": _checks(law),
        "remembering": sum(not check.missing_only for check in law.checks),
        "only_double": False,
        "checked": [law.inputs.index(check.input) for check in law.checks],
        "rule": {
            name: repr(value)
            for name, value in vars(rule).items()
            if name.isupper() and isinstance(value, float)
        },
    }


def _segments(curve: PiecewiseLinear) -> list[tuple[str | None, str, str, str]]:
    """Of each segment: its upper end (None: the last one has none), the value, slope and place of its anchor."""
    anchors = (curve.points[0], *curve.points)
    ends = [*(repr(z) for z, _ in curve.points), None]
    return [
        (end, repr(w), repr(slope), repr(z))
        for end, (z, w), slope in zip(ends, anchors, curve.slopes, strict=True)
    ]


def _checks(law: DiscreteSystem) -> list[dict[str, Any]]:
    """The input checks; those that remember something are numbered."""
    remembering = [check.input for check in law.checks if not check.missing_only]
    return [
        {
            "number": None if check.missing_only else remembering.index(check.input),
            "input": law.inputs.index(check.input),
            "limit": repr(check.limit),
            "hold": repr(float(check.hold)),
            "forget": repr(check.forget),
            "keep": int(check.keep),
            "alone": int(check.alone),
            "missing_only": check.missing_only,
            "needed": sum(1 << int(u) for u in np.flatnonzero(law.Q[i])),
            "start": [repr(number) for number in check.start()],
        }
        for i, check in enumerate(law.checks)
    ]


def _environment() -> Any:
    from jinja2 import Environment, FunctionLoader, StrictUndefined

    folder = resources.files(__package__) / "templates"
    return Environment(
        loader=FunctionLoader(lambda file_name: (folder / file_name).read_text(encoding="utf-8")),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
