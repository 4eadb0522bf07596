"""The paper's experiments on the virtual rig: what figures, tables and claims share, each done once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import signals
from ..controllers import pi, pole_placement
from ..drivetrain import Drivetrain
from ..identification import (
    FrequencyResponse,
    Identification,
    frequency_response,
    identify,
    locked_backlash,
    torque_step,
)
from ..identification.backlash.locked_load import LockedBacklash
from ..identification.friction.result import FrictionFit
from ..observers import kalman
from ..recording import Recording
from ..rig import Rig, Truth, nominal_rig, record
from ..simulation import Sensor, measure, simulate
from ..structure import TorsionalModel, modes, paper_powertrain, two_mass_from_frequencies, zeros
from ..systems import DiscreteSystem, connect
from . import published

Floats = NDArray[np.float64]
Progress = Callable[[float, str], None]


def nothing_shown(share: float, text: str) -> None:
    """No progress shown."""


#: Torque step of Fig. 5: Nm, from when to when, length and sample time, s (section II: some 10 to 15 Nm, 10 s, 0 to 100
#: rad/s; a step held for all of 10 s would reach 339 rad/s with Table I, so it ends and the rig coasts: a reading).
STEP_TORQUE, STEP_FROM, STEP_TO, STEP_LENGTH, STEP_DT = 12.0, 0.5, 1.7, 10.0, 1e-3
#: Half width of the averages in the fit of it, s (option: the rig turns for five seconds, so half the default).
STEP_AVERAGING = 0.05
#: Locked wheel: amplitude and period of the torque, length, s (option: small, and slow against the 100 Hz eigenmode).
LOCKED_TORQUE, LOCKED_PERIOD, LOCKED_LENGTH = 15.0, 4.0, 12.0
#: Random torque of Fig. 8 and 9: RMS, Nm, and band, Hz (option: the limit is seldom reached; zero and pole lie well
#: inside), seed, and lengths, s: quick and full (numerics: half a minute leaves the coherences too uncertain).
NOISE_RMS, NOISE_BAND, NOISE_SEED, NOISE_SECONDS = 16.0, (1.0, 300.0), 1, (60.0, 240.0)
#: Segments of the estimate, s, and the frequencies kept, Hz (option: 0.5 Hz apart).
SEGMENT, KEPT = 2.0, (2.0, 250.0)
#: Outputs whose frequency responses the paper compares (section II).
OUTPUTS = ("angle_motor", "speed_motor", "torque_shaft")
#: Start of the identification, times Table I (option: a nameplate that is 30 % wrong in everything).
NAMEPLATE_OFF = 1.3
#: Length of the speed steps, s, and seed of their noise (option).
LENGTH, STEP_NOISE = 1.5, 2
#: Names of the responses: the three of figures 8 and 9, and that of a shaft which only pushes.
RIG, NONLINEAR, LINEAR = "measurement (virtual rig)", "nonlinear model", "linear model"
PUSHING = "nonlinear model, viscoelastic contact"


@dataclass(frozen=True, eq=False)
class Run:
    """A run on the rig as its sensors show it, and the truth."""

    recording: Recording
    truth: Truth


@dataclass(frozen=True, eq=False)
class Identified:
    """What was identified in one recording of the rig, and the rig's true two-mass parameters."""

    found: Identification
    truth: Mapping[str, float | None]


@dataclass(frozen=True, eq=False)
class Experiments:
    """All that is recorded and identified once.

    Parameters
    ----------
    structure : TorsionalModel
        The finite elements.
    rig : Rig
    reduced, model : Drivetrain
        From the finite elements by the paper's four equations; with friction and backlash from the tests: what the
        paper calls linear and nonlinear two-mass oscillator.
    friction_run, friction : Run, FrictionFit
        The torque step.
    locked : LockedBacklash
    responses : mapping of name → output → FrequencyResponse
        Of the rig and the models to the same random torque.
    pi_step, placed_step : Run
        The step of the set-point under PI, and under Observer 1 with pole placement.
    """

    structure: TorsionalModel
    rig: Rig
    reduced: Drivetrain
    model: Drivetrain
    friction_run: Run
    friction: FrictionFit
    locked: LockedBacklash
    responses: Mapping[str, Mapping[str, FrequencyResponse]]
    pi_step: Run
    placed_step: Run


def perform(quick: bool, progress: Progress = nothing_shown) -> Experiments:
    """Do all of them on the nominal rig."""
    structure, rig = paper_powertrain(), nominal_rig()
    progress(0.0, "torque step, locked wheel")
    friction_run = friction_test(rig)
    friction, locked = friction_of(friction_run, structure.inertia_total), locked_wheel(rig)
    reduced = reduce(structure)
    model = with_tests(reduced, friction, locked)
    progress(0.2, "random torque")
    responses = random_responses(rig, model, NOISE_SECONDS[not quick])
    progress(0.7, "steps of the set-point")
    return Experiments(
        structure=structure, rig=rig, reduced=reduced, model=model, friction_run=friction_run, friction=friction,
        locked=locked, responses=responses, pi_step=speed_step(rig, pi_law()),
        placed_step=speed_step(rig, placed_law(model)),
    )  # fmt: skip


def reduce(structure: TorsionalModel) -> Drivetrain:
    """The linear two masses from first zero, second pole, damping ratio and total inertia (section II.2)."""
    return two_mass_from_frequencies(
        zero=float(zeros(structure)[0]),
        pole=float(modes(structure).frequency[1]),
        damping_ratio=structure.damping_ratio,
        inertia_total=structure.inertia_total,
    )


def friction_test(rig: Rig) -> Run:
    """The torque step of Fig. 5, then coasting."""
    t = np.arange(round(STEP_LENGTH / STEP_DT)) * STEP_DT
    torque = np.where((t >= STEP_FROM) & (t < STEP_TO), STEP_TORQUE, 0.0)
    return Run(*record(rig, torque_motor=torque, dt=STEP_DT))


def friction_of(run: Run, inertia: float) -> FrictionFit:
    """Coulomb and viscous friction from the torque step, the total inertia (kg m²) known."""
    return torque_step(run.recording, inertia=inertia, averaging=STEP_AVERAGING)


def locked_wheel(rig: Rig) -> LockedBacklash:
    """Brakes closed, a small oscillating torque, the angle of the motor's own encoder."""
    t = np.arange(round(LOCKED_LENGTH / STEP_DT)) * STEP_DT
    torque = LOCKED_TORQUE * 2.0 / np.pi * np.arcsin(np.sin(2.0 * np.pi * t / LOCKED_PERIOD))
    run = simulate(replace(rig.drivetrain, locked="load"), dt=STEP_DT, torque_motor=torque)
    encoder = Sensor("angle_motor", rig.sensors["speed_motor"].resolution)
    shown = measure({"angle_motor": encoder}, run.signals, STEP_DT, 0)
    return locked_backlash(Recording(t.astype(float), {"torque_motor": torque, **shown}))


def with_tests(reduced: Drivetrain, friction: FrictionFit, locked: LockedBacklash) -> Drivetrain:
    """The nonlinear model: the reduced structure with friction and backlash as tested, the paper's contact law."""
    return reduced.with_parameters(
        backlash=locked.values["backlash"],
        coulomb=friction.values["coulomb"],
        viscous=friction.values["viscous"],
        contact="dead_zone",
    )


def identify_rig(rig: Rig, progress: Progress = nothing_shown) -> Identified:
    """What ``identify`` finds in one recording of motor torque and motor speed, from a wrong nameplate."""
    recording, truth = record(rig)
    wrong = {name: NAMEPLATE_OFF * value for name, value in published.TABLE_I.items()}
    start = published.paper_drivetrain(**wrong).with_contact("viscoelastic")
    found = identify(recording, start=start, progress=progress)
    return Identified(found, {**truth.parameters, "inertia_total": rig.drivetrain.inertia_total})


def random_responses(rig: Rig, model: Drivetrain, seconds: float) -> dict[str, dict[str, FrequencyResponse]]:
    """Frequency responses of rig and models to the same random torque."""
    dt = published.DT
    noise = signals.noise(*NOISE_BAND, NOISE_RMS, seconds, dt, seed=NOISE_SEED)
    torque = np.clip(noise, -published.TORQUE_LIMIT, published.TORQUE_LIMIT)
    linear = model.with_parameters(backlash=0.0, coulomb=0.0)
    shown = {
        RIG: record(rig, torque_motor=torque, dt=dt)[0],
        NONLINEAR: simulate(model, dt=dt, torque_motor=torque),
        LINEAR: simulate(linear, dt=dt, torque_motor=torque),
        PUSHING: simulate(model.with_contact("viscoelastic"), dt=dt, torque_motor=torque),
    }
    return {name: {output: response(run, output) for output in OUTPUTS} for name, run in shown.items()}


def response(recording: Recording, output: str = "angle_motor") -> FrequencyResponse:
    """Output over motor torque as ``tfestimate`` estimates it (H1)."""
    return frequency_response(recording, "torque_motor", output, segment=SEGMENT, band=KEPT)


def pi_law(
    measured: str = "speed_motor", kp: float = published.PI_KP, ki: float = published.PI_KI
) -> DiscreteSystem:
    """The converter's PI speed controller, Table II as read; ``measured``: the speed that it controls."""
    law = pi(dt=published.DT, kp=kp, ki=ki, torque_limit=published.TORQUE_LIMIT)
    return law.renamed({"speed_motor": measured})


def observer(model: Drivetrain, **options: Any) -> DiscreteSystem:
    """Observer 1, or with ``measured`` Observer 2, with the covariances of equation (8)."""
    given = {"process_covariance": published.PROCESS_COVARIANCE, **options}
    return kalman(model, dt=published.DT, speed_from_counts=True, **given)


def observer_2(model: Drivetrain, torque_covariance: float = published.R_2["torque_shaft"]) -> DiscreteSystem:
    """Observer 2; ``torque_covariance`` is the torque sensor's entry of R₂."""
    return observer(
        model,
        measured=("torque_shaft", "speed_motor"),
        measurement_covariance={**published.R_2, "torque_shaft": torque_covariance},
    )


def placed_parts(
    model: Drivetrain,
    pole: float = published.POLE_PLACED,
    torque_limit: float = published.TORQUE_LIMIT,
    prefilter: bool = True,
    compensation: bool = True,
) -> list[DiscreteSystem]:
    """Observer 1, and pole placement with its prefilter V and the friction compensation DC, as in Fig. 14."""
    control = pole_placement(
        model, poles=(pole,) * 3, dt=published.DT, torque_limit=torque_limit,
        friction_compensation="estimated" if compensation else "none",
    )  # fmt: skip
    return [observer(model), control if prefilter else _without_prefilter(control)]


def placed_law(model: Drivetrain, **options: Any) -> DiscreteSystem:
    """The parts of ``placed_parts``, which takes the same options, as one law."""
    return connect(
        placed_parts(model, **options), inputs=("speed_reference", "speed_motor"), outputs=("torque_motor",)
    )


def _without_prefilter(control: DiscreteSystem) -> DiscreteSystem:
    """The set-point enters with 1 Nm s/rad instead of V."""
    place = control.inputs.index("speed_reference")
    changed = {}
    for name in ("D", "G"):
        matrix = getattr(control, name).copy()
        matrix[:, place] = np.sign(matrix[:, place])
        changed[name] = matrix
    return replace(control, **changed)


def speed_step(
    rig: Rig, law: DiscreteSystem, reference: Floats | None = None, noise_seed: int = STEP_NOISE
) -> Run:
    """The step of the set-point from −2 to 2 rad/s at 1 s, or another reference, with a law in the rig's loop."""
    if reference is None:
        reference = signals.steps(
            (published.STEP_TIME,), (published.LOW, published.HIGH), LENGTH, published.DT
        )
    return Run(*record(rig, law=law, speed_reference=reference, dt=published.DT, noise_seed=noise_seed))


def with_torque_noise(rig: Rig, noise: float) -> Rig:
    """The rig with another torque sensor: standard deviation of one sample, Nm."""
    return replace(rig, sensors={**rig.sensors, "torque_shaft": Sensor("torque_shaft", noise=noise)})


def without_torque_limit(rig: Rig) -> Rig:
    """The rig with a motor that knows no limit."""
    actuator = replace(rig.drivetrain.actuator, torque_limit=np.inf)
    return replace(rig, drivetrain=replace(rig.drivetrain, actuator=actuator))
