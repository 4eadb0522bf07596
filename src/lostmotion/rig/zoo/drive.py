"""rig.drive: one random drive with what its user has, a nameplate and a recording, and the truth beside it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...recording import Recording
from ...simulation import Sensor, measure
from ..equivalent import eigenfrequencies
from ..record import Truth
from .draws import BACKLASH, ENCODER_BITS, SPEED_NOISE, TORQUE_NOISE, Draw
from .motion import Motion, motion
from .plants import Plant, plant
from .truth import ABSENT_IF_RIGID, chain_sums, equivalent

Array = NDArray[np.float64]

#: What a nameplate leaves at zero with this probability (option).
NOT_TOLD = {"damping": 0.5, "backlash": 1.0 / 3.0, "coulomb": 1.0 / 3.0, "viscous": 0.5, "lag": 0.5}
#: A gap on the nameplate of a drive that has none; a speed without counts; a measured torque; its noise (option).
FALSE_GAP, ANALOG, MEASURED_TORQUE, NOISY_TORQUE = 0.5, 0.25, 1.0 / 3.0, 0.7


@dataclass(frozen=True, eq=False)
class Drive:
    """A drive of the zoo.

    Parameters
    ----------
    seed : int
    nameplate : Drivetrain
        Two masses, every value off by up to three either way, or zero where the nameplate lacks it; the torque limit
        is the rated torque.
    recording : Recording
        torque_motor (Nm) and speed_motor (rad/s) as the drive logs them.
    truth : Truth
        Judged parameters (None: no equivalent, not judged, see ``truth.equivalent``), the chain, the exact signals at
        the rows of the recording.
    absent : tuple of str
        Parameters that the drive does not have: nothing may be identified there.
    dimensions : mapping of name → float or str
        What the drive is like, for tables.
    sensor : Sensor
        Of the motor speed.
    motion : Motion
    """

    seed: int
    nameplate: Drivetrain
    recording: Recording
    truth: Truth
    absent: tuple[str, ...]
    dimensions: Mapping[str, float | str]
    sensor: Sensor
    motion: Motion

    def __post_init__(self) -> None:
        object.__setattr__(self, "dimensions", MappingProxyType(dict(self.dimensions)))


@checks_arguments
def drive(seed: int) -> Drive:
    """The drive of a seed; see ``draws`` for the ranges, and for which seeds are for what."""
    draw = Draw(seed)
    made = plant(draw)
    nameplate = _nameplate(draw, made)
    moved = motion(draw, made, nameplate)
    sensor, accuracy = motor_sensor(draw, made, moved.dt)
    torque, origin = _logged_torque(draw, made, moved)
    recording = _recording(draw, moved, torque, sensor)
    rows = slice(0, len(recording) * moved.steps, moved.steps)
    exact = Recording(
        time=recording.time,
        signals={name: values[rows] for name, values in moved.signals.signals.items()},
        origin=moved.signals.origin,
    )
    parameters = equivalent(made.drivetrain, exact, moved.delay * moved.signals.dt)
    if origin == "measured":
        parameters["lag"] = None
    rigid = len(made.drivetrain.inertias) == 1
    return Drive(
        seed=seed,
        nameplate=nameplate,
        recording=recording,
        truth=Truth(parameters, made.drivetrain, exact),
        absent=ABSENT_IF_RIGID if rigid else (),
        dimensions={**_dimensions(made, moved, nameplate), **accuracy, "torque": origin},
        sensor=sensor,
        motion=moved,
    )


def _nameplate(draw: Draw, made: Plant) -> Drivetrain:
    chain, rated = made.drivetrain, made.rating
    rigid = len(chain.inertias) == 1
    # A user who does not know that the drive is rigid takes some two masses.
    values = _believed(draw, made) if rigid else chain_sums(chain)
    values |= {
        "coulomb": sum(0.5 * (f.coulomb_plus + f.coulomb_minus) for f in chain.frictions),
        "viscous": sum(f.viscous for f in chain.frictions),
        "lag": chain.actuator.lag,
    }
    if not values["backlash"] and draw.happens("false gap", FALSE_GAP):
        windup = rated.torque / float(values["stiffness"] or 1.0)
        values["backlash"] = draw.log_uniform("false gap size", BACKLASH) * windup
    told = {
        name: 0.0 if draw.happens(f"not told {name}", NOT_TOLD.get(name, 0.0)) else draw.near(name, float(value or 0.0))
        for name, value in values.items()
    }  # fmt: skip
    return Drivetrain.two_mass(torque_limit=rated.torque, **told)  # type: ignore[arg-type]


def _believed(draw: Draw, made: Plant) -> dict[str, float | None]:
    """Two masses that a user may take a rigid drive for."""
    share, total = draw.uniform("believed share", 0.1, 0.9), made.drivetrain.inertia_total
    motor, load = share * total, (1.0 - share) * total
    stiffness = (2.0 * np.pi * made.pole) ** 2 * motor * load / total
    damping = 0.02 * stiffness / (np.pi * made.pole)
    return {
        "inertia_motor": motor, "inertia_load": load, "stiffness": stiffness, "damping": damping, "backlash": 0.0
    }  # fmt: skip


def motor_sensor(draw: Draw, made: Plant, dt: float) -> tuple[Sensor, dict[str, float]]:
    """Sensor of the motor speed; its bits (0: no counts), and its noise over rated speed."""
    rated = made.rating.speed
    if draw.happens("analog", ANALOG):
        noise = draw.log_uniform("speed noise", SPEED_NOISE)
        return Sensor("speed_motor", noise=noise * rated), {"bits": 0.0, "speed_noise": noise}
    bits = int(draw.stream("bits").integers(ENCODER_BITS[0], ENCODER_BITS[1] + 1))
    count = 2.0 * np.pi / 2**bits
    noise = count / dt / np.sqrt(6.0) / rated
    return Sensor("angle_motor", resolution=count, difference=True), {
        "bits": float(bits),
        "speed_noise": noise,
    }


def _logged_torque(draw: Draw, made: Plant, moved: Motion) -> tuple[Array, str]:
    """Torque as the drive logs it, Nm: commanded, or measured with noise."""
    if not draw.happens("measured torque", MEASURED_TORQUE):
        return moved.command, "commanded"
    rows = moved.command.size
    torque = actual_torque(moved, made.drivetrain.actuator.lag)[:: moved.steps][:rows]
    if draw.happens("noisy torque", NOISY_TORQUE):
        noise = draw.log_uniform("torque noise", TORQUE_NOISE) * made.rating.torque
        torque = torque + noise * draw.stream("torque noise samples").standard_normal(rows)
    return torque, "measured"


def _recording(draw: Draw, moved: Motion, torque: Array, sensor: Sensor) -> Recording:
    rows = torque.size
    start = draw.uniform("encoder angle", 0.0, 1.0) * sensor.resolution
    source = moved.signals[sensor.source][:: moved.steps][:rows] + start
    speed = measure({"speed_motor": sensor}, {sensor.source: source}, moved.dt, draw.seed)["speed_motor"]
    return Recording(
        time=moved.dt * np.arange(rows, dtype=float),
        signals={"torque_motor": torque, "speed_motor": speed},
        meta={"source": "zoo of drives", "seed": draw.seed, "speed_from_counts": sensor.difference},
    )


def actual_torque(moved: Motion, lag: float) -> Array:
    """Torque of the motor at each of the plant's steps, after delay and lag, Nm."""
    from scipy.signal import lfilter

    acting = moved.signals["torque_motor"]
    if lag > 0.0:
        left = np.exp(-moved.signals.dt / lag)
        # The lag's state at the beginning of each step: it has not yet seen that step's set-point.
        acting = lfilter([0.0, 1.0 - left], [1.0, -left], acting)
    return np.asarray(acting)


def _dimensions(made: Plant, moved: Motion, nameplate: Drivetrain) -> dict[str, float | str]:
    chain, rated = made.drivetrain, made.rating
    gaps = sorted(((s.backlash, s.contact) for s in chain.shafts if s.has_backlash), reverse=True)
    frictions = {"motor": chain.frictions[0], "load": chain.frictions[-1]}
    rubbing = {place: f for place, f in frictions.items() if f.sticks}
    modes = eigenfrequencies(chain)
    return {
        "masses": float(len(chain.inertias)),
        "inertia": chain.inertia_total,
        **_two_mass_dimensions(chain, made.pole),
        "pole": made.pole,
        "pole_dt": made.pole * moved.dt,
        "second_mode": float(modes[2] / modes[1]) if len(modes) > 2 else np.inf,
        "gap": gaps[0][0] / made.windup if gaps else 0.0,
        "gaps": float(len(gaps)),
        "law": gaps[0][1] if gaps else "none",
        "friction": sum(f.coulomb_plus + f.coulomb_minus for f in set(rubbing.values()))
        / (2.0 * rated.torque),
        "friction_at": "+".join(rubbing) if len(chain.inertias) > 1 else "rigid",
        "asymmetry": max(abs(np.log(f.coulomb_plus / f.coulomb_minus)) for f in rubbing.values()),
        "rated_torque": rated.torque,
        "rated_speed": rated.speed,
        "acceleration_time": rated.acceleration_time,
        "windup": made.windup,
        "lag": chain.actuator.lag + moved.delay * moved.signals.dt,
        "duration": moved.command.size * moved.dt,
        "rows": float(moved.command.size),
        "excitation": moved.kind,
        "load_torque": moved.load,
        "closed_loop": float(moved.closed),
        "nameplate_pole": nameplate.pole_frequency / made.pole,
    }


def _two_mass_dimensions(chain: Drivetrain, pole: float) -> dict[str, float]:
    """Inertia ratio and damping ratio of the first mode; zero where the drive is rigid."""
    if len(chain.inertias) == 1:
        return {"ratio": 0.0, "damping_ratio": 0.0}
    sums = {name: float(value or 0.0) for name, value in chain_sums(chain).items()}
    return {
        "ratio": sums["inertia_load"] / sums["inertia_motor"],
        "damping_ratio": sums["damping"] * np.pi * pole / sums["stiffness"],
    }
