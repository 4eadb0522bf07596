"""Stage 1, read and check: the recordings, the nameplate and the settings, from the user's TOML or the virtual rig."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from .. import rig
from ..controllers import pi
from ..errors import Problem
from ..io import Configuration, check_recording, load_recordings
from ..io.recordings.checks import IDENTIFIABLE_ROWS, IDENTIFIABLE_TIME
from ..recording import Recording
from .speed_step import PAPER_STEP

#: Start values for the virtual rig (option): what datasheets and a rough estimate give, 25 to 70 % off.
RIG_NAMEPLATE: Mapping[str, float] = {
    "inertia_motor": 0.015,
    "inertia_load": 0.14,
    "stiffness": 5000.0,
    "damping": 0.2,
    "backlash": 0.02,
    "coulomb": 1.2,
    "viscous": 0.02,
}
#: Gains of the paper's PI controller, Nm s/rad and Nm/rad, to compare with on the virtual rig: Fietzek & Rinderknecht,
#: Table II.
PAPER_GAINS = (10.0, 200.0)
#: With one recording only, this last part of it is kept for the validation (option).
VALIDATION_PART = 0.3


@dataclass(frozen=True)
class Settings:
    """What the user asks for; None: from the recording and the identified drivetrain, see ``stages.design``.

    Sample time (s), torque limit (Nm; inf: none), poles (1/s), gains of the PI controller (Nm s/rad and Nm/rad);
    parameters that keep their nameplate value, whether an unknown torque acts on the load, further signals: as in
    ``identify``.
    """

    sample_time: float | None = None
    torque_limit: float | None = None
    poles: tuple[complex, ...] | None = None
    kp: float | None = None
    ki: float | None = None
    fixed: tuple[str, ...] = ()
    load_torque: bool = False
    measured: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Material:
    """Input of the later stages. It does not contain the virtual rig's truth.

    Parameters
    ----------
    nameplate : mapping of parameter → value, SI
    settings : Settings
    seed : int
    virtual : bool
        Whether the recordings come from the virtual rig.
    identify, validate : Recording or None
    recordings : mapping of name → Recording
        All recordings, as read.
    uses : mapping of name → {"identify", "validate"} or a test
    options : mapping of name → mapping
        Of each test.
    problems : tuple of Problem
        Warnings.
    inputs : mapping of file → sha256
    """

    nameplate: Mapping[str, float]
    settings: Settings
    seed: int
    virtual: bool
    identify: Recording | None
    validate: Recording | None
    recordings: Mapping[str, Recording]
    uses: Mapping[str, str]
    options: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    problems: tuple[Problem, ...] = ()
    inputs: Mapping[str, str] = field(default_factory=dict)


def from_rig(seed: int, dt: float = 1e-4) -> tuple[Material, rig.Truth]:
    """An excitation of 10 s and a set-point step under PI control on the virtual rig, and separately the truth."""
    kp, ki = PAPER_GAINS
    settings = Settings(sample_time=dt, torque_limit=rig.TORQUE_LIMIT, kp=kp, ki=ki)
    excited, truth = rig.record(seed, dt=dt)
    controller = pi(dt=dt, kp=kp, ki=ki, torque_limit=rig.TORQUE_LIMIT)
    reference = PAPER_STEP.without_return().reference(dt)
    step, _ = rig.record(seed, law=controller, speed_reference=reference, dt=dt, noise_seed=1)
    material = Material(
        nameplate=RIG_NAMEPLATE,
        settings=settings,
        seed=seed,
        virtual=True,
        identify=excited,
        validate=step,
        recordings={"excitation": excited, "step": step},
        uses={"excitation": "identify", "step": "validate"},
        problems=(*check_recording(excited), *check_recording(step)),
    )
    return material, truth


def from_recording(recording: Recording, seed: int) -> Material:
    """One recording, without a nameplate."""
    return Material(
        nameplate={},
        settings=Settings(),
        seed=seed,
        virtual=False,
        identify=recording,
        validate=None,
        recordings={"recording": recording},
        uses={"recording": "identify"},
        problems=tuple(recording.meta.get("problems", ())),
    )


def from_configuration(configuration: Configuration, seed: int | None = None, split: bool = True) -> Material:
    """The user's recordings; raises ``InputProblems`` with all errors of all files.

    With one recording only, its last part is kept for the validation if `split`, and if enough is left.
    """
    loaded = load_recordings(configuration)
    law = configuration.law
    settings = Settings(
        law.sample_time, law.torque_limit, law.poles, law.kp, law.ki,
        configuration.identify.fixed, configuration.identify.load_torque, configuration.identify.measured,
    )  # fmt: skip
    problems = [p for _, recording in loaded for p in recording.meta.get("problems", ())]
    first = {use: next((r for u, r in loaded if u == use), None) for use in ("identify", "validate")}
    identify, validate = first["identify"], first["validate"]
    if split and identify is not None and validate is None and _long_enough(identify):
        cut = identify.time[-1] - VALIDATION_PART * (identify.time[-1] - identify.time[0])
        identify, validate = identify.window(stop=cut), identify.window(start=cut)
    return Material(
        nameplate=configuration.nameplate,
        settings=settings,
        seed=configuration.run.seed if seed is None else seed,
        virtual=False,
        identify=identify,
        validate=validate,
        recordings={f"recording_{i + 1}": recording for i, (_, recording) in enumerate(loaded)},
        uses={f"recording_{i + 1}": use for i, (use, _) in enumerate(loaded)},
        options={f"recording_{i + 1}": source.options for i, source in enumerate(configuration.recordings)},
        problems=tuple(problems),
        inputs=_hashes(configuration),
    )


def _long_enough(recording: Recording) -> bool:
    """Whether what is left without the last part is enough to identify from."""
    left = 1.0 - VALIDATION_PART
    rows, time = len(recording), recording.time[-1] - recording.time[0]
    return bool(left * rows >= IDENTIFIABLE_ROWS + 1 and left * time >= IDENTIFIABLE_TIME)


def _hashes(configuration: Configuration) -> dict[str, str]:
    """SHA-256 of the TOML and of every recording, by its path relative to the TOML."""
    home = configuration.path.parent
    files = {configuration.path.name: configuration.path}
    for file in (file for source in configuration.recordings for file in source.files):
        inside = file.is_relative_to(home)
        files[file.relative_to(home).as_posix() if inside else str(file)] = file
    return {name: hashlib.sha256(file.read_bytes()).hexdigest() for name, file in files.items()}
