"""What several commands ask for alike, and the checks of options that typer does not know."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from typing import Annotated, Any

import typer

#: Values of ``frf --method`` and ``excite --kind``; those of ``rig.excitation.KINDS``, which is slow to load.
METHODS = ("H1", "H2", "Hv")
#: Values of ``identify --method``: ``io.configuration.methods.METHODS``, which takes longer to import.
TESTS = (
    "torque_step", "rigid_drive", "friction_ladder", "breakaway", "locked_backlash", "lost_motion", "shaft_stiffness",
    "ring_down",
)  # fmt: skip
KINDS = ("levels", "step", "chirp", "multisine", "prbs", "noise")
#: Values of ``loop --code``.
CODES = ("c", "python")


def completing(names: Iterable[str]) -> Callable[[str], list[str]]:
    """What the shell offers for the beginning of a value."""
    return lambda incomplete: [name for name in names if name.startswith(incomplete)]


def signals(incomplete: str) -> list[str]:
    from ..recording import SIGNAL_UNITS

    return completing(SIGNAL_UNITS)(incomplete)


def positive(value: float | None) -> float | None:
    """An option that must be above zero; NaN is not."""
    if value is not None and not value > 0.0:
        raise typer.BadParameter(f"{value} is not above 0.")
    return value


def finite_positive(value: float) -> float:
    if not 0.0 < value < math.inf:
        raise typer.BadParameter(f"{value} is not a finite number above 0.")
    return value


def percent_below_100(value: float | None) -> float | None:
    if value is not None and not 0.0 < value < 100.0:
        raise typer.BadParameter(f"{value} is not in the range 0<x<100; 10 is ±10 %.")
    return value


def spread_below_one(value: float) -> float:
    if not 0.0 <= value < 1.0:
        raise typer.BadParameter(f"{value} is not in the range 0<=x<1; 0.2 is 20 %.")
    return value


def acting(context: typer.Context, given: str, asked: bool, *options: str, without: bool = False) -> None:
    """Refuse options that do nothing: they act only together with ``given`` (``without``: only where it is not)."""
    idle = [
        name
        for name in options
        if (source := context.get_parameter_source(name)) is not None and source.name == "COMMANDLINE"
    ]
    if idle and asked == without:
        names = ", ".join("--" + name.replace("_", "-") for name in idle)
        raise typer.BadParameter(
            f"does nothing {'beside' if without else 'without'} {given}", param_hint=names
        )


ForceOption = Annotated[
    bool,
    typer.Option(
        "--force", help="Replace files that lostmotion has not written, or that were changed since."
    ),
]
SeedOption = Annotated[int | None, typer.Option(min=0, help="Seed; default: the TOML's, else 1.")]


def known_method(name: str) -> Any:
    if name not in METHODS:
        raise typer.BadParameter(f"{name!r} is none of {', '.join(METHODS)}", param_hint="--method")
    return name


def known_test(name: str | None) -> str | None:
    if name is not None and name not in TESTS:
        raise typer.BadParameter(f"{name!r} is none of {', '.join(TESTS)}", param_hint="--method")
    return name


def known_code(name: str | None) -> str | None:
    if name is not None and name not in CODES:
        raise typer.BadParameter(f"{name!r} is none of {', '.join(CODES)}")
    return name
