"""How a drive of the zoo is moved: in open loop or under speed control, as commissioning and operation do it."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ... import signals
from ...controllers import pi
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...recording import Recording
from ...simulation import simulate
from ..excitation import BAND, LEVELS, NOISE_SHARE, Limits, shape
from .draws import DELAY, DURATION, LEAST_PERIODS, LOAD_TORQUE, MOST_ROWS, SAMPLES_PER_PERIOD, Draw
from .plants import Plant

Array = NDArray[np.float64]

#: Half of the drives play an excitation that is designed for their nameplate (option).
KINDS = {"designed": 0.5, "prbs": 0.17, "profile": 0.17, "operation": 0.16}
#: Option.
LOADS = {"none": 0.5, "constant": 0.25, "slow": 0.25}
#: The plant runs at 10 kHz or faster, as a current loop does, with at most so many steps in a row of the recording.
#: (Option.)
PLANT_STEP, MOST_STEPS = 1e-4, 10
#: A drive stops above this share of its rated speed (option); an excitation is then made smaller, at most so often.
OVERSPEED, ATTEMPTS = 1.5, 5
#: Amplitude of the binary torque over rated torque; period of a slow load torque, s; both log-uniform (option).
PRBS_AMPLITUDE, SLOW_PERIOD = (0.1, 0.5), (2.0, 20.0)
#: Crossover of the speed control over the first zero, and what delay, lag and sampling leave of it (option: the usual
#: tuning; motor-side inertia alone counts above the torsional mode).
CROSSOVER, PHASE = 0.3, 0.4


@dataclass(frozen=True, eq=False)
class Motion:
    """The exact signals of a recording and how they came about.

    Parameters
    ----------
    signals : Recording
        At the plant's step.
    command : (n,) array, Nm
        Set-point of each row, without the delay with which it acts.
    steps, delay : int
        Plant steps in a row, and of the delay.
    kind, load : str
    closed : bool
        Under speed control.
    """

    signals: Recording
    command: Array
    steps: int
    delay: int
    kind: str
    load: str
    closed: bool

    @property
    def dt(self) -> float:
        """Sample time of the recording, s."""
        return self.signals.dt * self.steps


def motion(draw: Draw, plant: Plant, nameplate: Drivetrain) -> Motion:
    """Moves the drive of a seed."""
    dt, rows = raster(draw, plant.pole)
    steps = max(1, min(MOST_STEPS, round(dt / PLANT_STEP)))
    delay = round(draw.uniform("delay", *DELAY) / (dt / steps))
    kind, load = draw.choice("excitation", KINDS), draw.choice("load torque", LOADS)
    task = _Task(plant, dt, rows, steps, delay, _load_torque(draw, load, plant, dt / steps, rows * steps))
    reference, dither = _wanted(draw, kind, plant, nameplate, dt, rows)
    runs: list[Callable[[float], Recording | None]] = [
        lambda size: task.closed_loop(size * reference, size * dither)
    ]
    if kind in ("designed", "prbs") and load == "none":
        torque = _open_loop_torque(draw, kind, plant, nameplate, dt, rows, dither)
        runs.insert(0, lambda size: task.open_loop(size * torque))
    for number, run in enumerate(runs):
        for attempt in range(ATTEMPTS):
            recording = run(0.7**attempt)
            if recording is not None:
                command = recording["torque_motor"][delay::steps][: rows - MOST_STEPS]
                return Motion(recording, command, steps, delay, kind, load, number == len(runs) - 1)
    raise InvalidInput(
        "rig.drive",
        f"seed {draw.seed}, which overspeeds",
        "a drive that keeps its speed",
        "Take another seed: one in thousands has no speed control that holds it.",
    )


def raster(draw: Draw, pole: float) -> tuple[float, int]:
    """Sample time (s) and rows."""
    dt = 1.0 / (pole * draw.log_uniform("samples per period", SAMPLES_PER_PERIOD))
    duration = max(draw.log_uniform("duration", DURATION), LEAST_PERIODS / pole)
    return dt, max(round(LEAST_PERIODS / (pole * dt)), min(round(duration / dt), MOST_ROWS)) + MOST_STEPS


def _load_torque(draw: Draw, kind: str, plant: Plant, dt: float, length: int) -> Array | None:
    if kind == "none":
        return None
    level = draw.log_uniform("load torque size", LOAD_TORQUE) * plant.rating.torque
    sign = draw.stream("load torque sign").choice([-1.0, 1.0])
    if kind == "constant":
        return np.full(length, sign * level)
    phase = 2.0 * np.pi * np.arange(length) * dt / draw.log_uniform("slow period", SLOW_PERIOD)
    return np.asarray(level * np.sin(phase + draw.uniform("slow phase", 0.0, 2.0 * np.pi)))


def _wanted(
    draw: Draw, kind: str, plant: Plant, nameplate: Drivetrain, dt: float, rows: int
) -> tuple[Array, Array]:
    """Speed reference (rad/s) and torque dither (Nm) for the speed control."""
    rng, speed, torque = draw.stream("motion"), plant.rating.speed, plant.rating.torque
    if kind == "prbs":
        return np.zeros(rows), _prbs(draw, torque, nameplate, dt, rows)
    if kind == "designed":
        levels = speed * np.tile(LEVELS, 2)
        band = _band(nameplate, dt, rows)
        dither = signals.noise(*band, NOISE_SHARE * torque, rows * dt, dt, seed=draw.seed)
    else:
        count = max(3, round(rows * dt / rng.uniform(0.5, 5.0)))
        levels = speed * rng.uniform(-0.9, 0.9, count)
        # Ordinary operation stands still at times, and its set-points are rounded off.
        levels[rng.random(count) < (0.3 if kind == "operation" else 0.0)] = 0.0
        dither = np.zeros(rows)
    at = np.linspace(0.0, rows, levels.size, endpoint=False)
    target = levels[np.searchsorted(at, np.arange(rows), side="right") - 1]
    gentle = rng.uniform(1.5, 4.0) if kind == "operation" else 1.2
    ramp = max(1, min(rows // levels.size, round(gentle * plant.rating.acceleration_time / dt)))
    padded = np.r_[np.zeros(ramp), target]
    sums = np.cumsum(padded)
    return (sums[ramp:] - sums[:-ramp]) / ramp, dither


def _band(nameplate: Drivetrain, dt: float, rows: int) -> tuple[float, float]:
    pole = nameplate.pole_frequency
    low = min(max(BAND[0] * pole, 1.0 / (rows * dt)), 0.05 / dt)
    return low, max(2.0 * low, min(BAND[1] * pole, 0.4 / dt))


def _prbs(draw: Draw, torque: float, nameplate: Drivetrain, dt: float, rows: int) -> Array:
    amplitude = draw.log_uniform("prbs amplitude", PRBS_AMPLITUDE) * torque
    return signals.prbs(amplitude, 0.5 / (BAND[1] * nameplate.pole_frequency), rows * dt, dt, seed=draw.seed)


def _open_loop_torque(
    draw: Draw, kind: str, plant: Plant, nameplate: Drivetrain, dt: float, rows: int, dither: Array
) -> Array:
    if kind == "prbs":
        return dither
    limits = Limits(plant.rating.torque, plant.rating.speed, math.inf)
    return shape("levels", nameplate, limits, _band(nameplate, dt, rows), rows * dt, dt, draw.seed)(1.0)


@dataclass(frozen=True, eq=False)
class _Task:
    """A plant on its raster: rows of the recording with plant steps in each, a delay in steps, and a load torque."""

    plant: Plant
    dt: float
    rows: int
    steps: int
    delay: int
    load: Array | None

    def open_loop(self, torque: Array) -> Recording | None:
        limited = np.clip(torque, -self.plant.rating.torque, self.plant.rating.torque)
        acting = np.concatenate([np.zeros(self.delay), np.repeat(limited, self.steps)])
        return self._run(torque_motor=acting[: self.rows * self.steps])

    def closed_loop(self, reference: Array, dither: Array) -> Recording | None:
        """PI speed control that sees the exact speed: a drive filters its own, the recording shows what is logged."""
        drivetrain, rated = self.plant.drivetrain, self.plant.rating
        total, motor = drivetrain.inertia_total, drivetrain.inertias[0]
        dead = (self.delay / self.steps + 1.5) * self.dt + drivetrain.actuator.lag
        crossover = min(
            CROSSOVER * 2.0 * np.pi * self.plant.pole * math.sqrt(motor / total), PHASE * motor / total / dead
        )
        for _ in range(ATTEMPTS):
            kp = crossover * total
            # The controller's own proportional path makes a torque of the dither.
            law = pi(kp=kp, ki=0.25 * crossover * kp, dt=self.dt, torque_limit=rated.torque)
            run = self._run(law=law, delay=self.delay, speed_reference=reference + dither / kp)
            if run is not None:
                return run
            crossover *= 0.5
        return None

    def _run(self, **given: object) -> Recording | None:
        """The run, or None if the drive would stop for overspeed."""
        if self.load is not None:
            given["torque_load"] = self.load
        if "speed_reference" in given:
            given["speed_reference"] = np.repeat(np.asarray(given["speed_reference"]), self.steps)
        run = simulate(self.plant.drivetrain, dt=self.dt / self.steps, **given)  # type: ignore[arg-type]
        fastest = float(np.max(np.abs(run["speed_motor"])))
        return run if fastest <= OVERSPEED * self.plant.rating.speed else None
