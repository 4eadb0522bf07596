"""Design of a test: the torque to apply, the expected signals, and the expected intervals of the parameters."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

import numpy as np

from ..argument_checks import checks_arguments
from ..drivetrain import PARAMETER_UNITS, Drivetrain
from ..errors import InvalidInput, Problem
from ..identification import Identification, identify
from ..identification.prediction_error.initial_values import DAMPING_RATIO
from ..identification.prediction_error.innovations import NAMES
from ..io import write_csv
from ..recording import Recording
from ..rig.excitation import BAND, KINDS, Limits, shape
from .rehearsal import largest, rehearsal_rigs

#: Encoders have up to about 32 bit (option, with room).
MOST_BITS = 40

#: Below this part of the full amplitude the limits leave too little for a test (option).
SMALL = 0.05


@dataclass(frozen=True, eq=False)
class ExcitationDesign:
    """A test that keeps its limits, and its expected results.

    Parameters
    ----------
    kind : str
    seed : int
    recording : Recording
        ``torque_motor`` (Nm) to be applied, held over each sample.
    scale : float
        Amplitude as a fraction of the one at the torque limit.
    limits, peaks : mapping of {"torque", "speed", "angle"} → Nm, rad/s, rad
        Given limits, and the largest values on any of the plants of the rehearsal.
    predicted : Recording
        Expected sensor signals for the plant with the nameplate's values (origin "simulated").
    half_widths : mapping of name → float
        Expected half width of the 95 % interval relative to the nameplate's value; without values that will not be
        identified or are zero on the nameplate.
    intervals : mapping of name → (low, high)
        The same around the nameplate's values, SI.
    not_excited : tuple of str
        Values that most rehearsals did not identify.
    problems : tuple of Problem
    """

    kind: str
    seed: int
    recording: Recording
    scale: float
    limits: Mapping[str, float]
    peaks: Mapping[str, float]
    predicted: Recording
    half_widths: Mapping[str, float]
    intervals: Mapping[str, tuple[float, float]]
    not_excited: tuple[str, ...]
    problems: tuple[Problem, ...]

    def __post_init__(self) -> None:
        for name in ("limits", "peaks", "half_widths", "intervals"):
            object.__setattr__(self, name, MappingProxyType(dict(getattr(self, name))))

    def save_csv(self, path: str | Path) -> None:
        """Write ``time [s],torque_motor [Nm]``, one row for each sample, for a drive to play."""
        write_csv(path, self.recording)


@checks_arguments
def design_excitation(
    nameplate: Drivetrain,
    *,
    kind: str = "levels",
    duration: float = 10.0,
    dt: float = 1e-4,
    torque_limit: float | None = None,
    speed_limit: float,
    angle_limit: float = np.inf,
    encoder_bits: int = 20,
    seed: int = 1,
    band: tuple[float, float] | None = None,
    spread: Mapping[str, tuple[float, float]] | None = None,
    plants: int = 3,
) -> ExcitationDesign:
    """Torque of the largest amplitude that keeps the limits, rehearsed on finer plants around the nameplate.

    The plants have four inertias, Stribeck friction and another contact law than the model (``rig.finer_rig``): one
    with the nameplate's values, one with the least inertia and friction, the others varied. The limits are kept on all
    of them. Each is recorded through the encoder and identified; the median of the half widths is the prediction. Where
    the nameplate has no damping, a damping ratio of 0.02 is assumed.

    Parameters
    ----------
    nameplate : Drivetrain
        Two masses, rough values of the drivetrain to be tested.
    kind : {"levels", "step", "chirp", "multisine", "prbs", "noise"}
        "levels": two speeds in each direction, open loop, plus noise (identifies all parameters); the others
        are around zero torque.
    duration, dt : float, s
    torque_limit : float, Nm, optional
        Default: the nameplate's torque limit.
    speed_limit : float, rad/s
        For motor and load.
    angle_limit : float, rad
        Largest angle from the start of motor and load.
    encoder_bits : int
        Motor encoder, 2**bits counts per turn (default: that of the virtual rig); the speed is a count difference.
    seed : int
    band : (low, high), Hz, optional
        Default: ``rig.excitation.BAND`` times the torsional frequency.
    spread : mapping of name → (low, high), optional
        Ranges of the varied plants, SI. Default: ``rehearsal.SPREAD``.
    plants : int
        Plants of the rehearsal, at least 2.

    Returns
    -------
    ExcitationDesign

    Raises
    ------
    InvalidInput
        For an unknown kind, limits or times that are not positive, an encoder of no or too many bits, or a nameplate
        that is not of two masses.
    """
    torque_limit = nameplate.actuator.torque_limit if torque_limit is None else torque_limit
    limits = Limits(torque_limit, speed_limit, angle_limit)
    _check(nameplate, kind, limits, plants)
    _check_sampling(duration, dt, encoder_bits)
    _check_motion(nameplate, limits, duration, dt, encoder_bits)
    if nameplate.damping == 0.0:
        nameplate = nameplate.with_parameters(
            damping=DAMPING_RATIO * nameplate.stiffness / (np.pi * nameplate.pole_frequency)
        )
    rigs = rehearsal_rigs(nameplate, spread or {}, plants, encoder_bits, seed)
    pole = nameplate.pole_frequency
    band = (BAND[0] * pole, min(BAND[1] * pole, 0.4 / dt)) if band is None else band
    torque_at = shape(kind, nameplate, limits, band, duration, dt, seed)
    scale, runs = largest(torque_at, rigs, limits, dt)
    found = [identify(run.only("torque_motor", "speed_motor"), start=nameplate) for run, _ in runs]
    values = nameplate.parameters()
    half_widths, not_excited = _expected(found, values)
    peaks = {name: max(p[name] for _, p in runs) for name in ("torque", "speed", "angle")}
    torque = runs[0][0].only("torque_motor")
    return ExcitationDesign(
        kind=kind,
        seed=seed,
        recording=replace(torque, origin={"torque_motor": "reference"}, meta={"kind": kind, "seed": seed}),
        scale=scale,
        limits={"torque": limits.torque, "speed": limits.speed, "angle": limits.angle},
        peaks=peaks,
        predicted=runs[0][0],
        half_widths=half_widths,
        intervals={n: (values[n] * (1.0 - h), values[n] * (1.0 + h)) for n, h in half_widths.items()},
        not_excited=not_excited,
        problems=_problems(nameplate, scale, not_excited, found),
    )


def _check_motion(
    nameplate: Drivetrain, limits: Limits, duration: float, dt: float, encoder_bits: int
) -> None:
    """Whether the largest torque, all the time in one direction, shows in the encoder at all."""
    fastest = limits.torque / nameplate.inertia_total * duration
    smallest = 2.0 * np.pi / 2**encoder_bits / dt
    if fastest < smallest:
        raise InvalidInput(
            "design_excitation.nameplate",
            f"{nameplate.inertia_total:.3g} kg m² in all, which {limits.torque:g} Nm bring to {fastest:.2g} rad/s in "
            f"{duration:g} s",
            f"a drive that reaches {smallest:.2g} rad/s, one count of the encoder in a sample",
            "Check the units of inertia (kg m²) and torque (Nm); else test longer.",
        )


def _check(nameplate: Drivetrain, kind: str, limits: Limits, plants: int) -> None:
    if kind not in KINDS:
        raise InvalidInput("design_excitation.kind", repr(kind), f"one of {KINDS}", "Check the name.")
    if len(nameplate.inertias) != 2:
        raise InvalidInput(
            "design_excitation.nameplate", f"{len(nameplate.inertias)} inertias", "two masses",
            "Use Drivetrain.two_mass.",
        )  # fmt: skip
    for name, value in vars(limits).items():
        if not value > 0.0 or (name != "angle" and not np.isfinite(value)):
            raise InvalidInput(
                f"design_excitation.{name}_limit",
                f"{value:g}",
                "a positive number in SI units",
                "Give the limit.",
            )
    if plants < 2:
        raise InvalidInput("design_excitation.plants", f"{plants}", "at least 2", "Rehearse on more plants.")


def _check_sampling(duration: float, dt: float, encoder_bits: int) -> None:
    for name, value in (("duration", duration), ("dt", dt)):
        if not (np.isfinite(value) and value > 0.0):
            raise InvalidInput(f"design_excitation.{name}", f"{value} s", "a positive number", "Give it.")
    if not 1 <= encoder_bits <= MOST_BITS:
        raise InvalidInput(
            "design_excitation.encoder_bits", f"{encoder_bits}", f"1 to {MOST_BITS}", "See the encoder's data sheet."
        )  # fmt: skip


def _expected(
    found: list[Identification], values: Mapping[str, float]
) -> tuple[dict[str, float], tuple[str, ...]]:
    """Median half widths relative to the nameplate, and values that half of the rehearsals or more did not identify."""
    half_widths: dict[str, float] = {}
    for name in NAMES:
        if values[name] == 0.0:
            continue  # relative to zero
        intervals = [f.intervals[name] for f in found if name in f.intervals]
        if 2 * len(intervals) > len(found):
            half_widths[name] = float(np.median([(b - a) / 2.0 for a, b in intervals])) / values[name]
    missing = tuple(name for name in NAMES if name not in half_widths and values[name] > 0.0)
    return half_widths, missing


def _problems(
    nameplate: Drivetrain, scale: float, not_excited: tuple[str, ...], found: list[Identification]
) -> tuple[Problem, ...]:
    problems = [
        Problem(
            "warning", name, "an excitation that will not identify it", "excitation",
            "Take kind='levels', more torque, wider limits or a longer test; or fix it from the nameplate.",
        )
        for name in not_excited
    ]  # fmt: skip
    if scale < SMALL:
        problems.append(
            Problem(
                "warning", "design_excitation", f"{100.0 * scale:.2g} % of the torque limit within speed and angle",
                f"at least {100.0 * SMALL:g} %", "Raise the speed or the angle limit, or shorten the test.",
            )
        )  # fmt: skip
    for name in ("backlash", "coulomb"):
        if getattr(nameplate, name) == 0.0:
            problems.append(
                Problem(
                    "warning", name, f"0 {PARAMETER_UNITS[name]} on the nameplate", "a rough value",
                    "The rehearsal is without it: give a guess, the motion depends on it.",
                )
            )  # fmt: skip
    warned = {(p.where, p.remedy): p for f in found for p in f.problems if p.where not in NAMES}
    return (*problems, *warned.values())
