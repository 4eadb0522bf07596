"""Torque over time for each kind of excitation, as a function of its scale."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from .. import signals
from ..drivetrain import Drivetrain

Array = NDArray[np.float64]
Kind = Literal["levels", "step", "chirp", "multisine", "prbs", "noise"]
KINDS: tuple[str, ...] = get_args(Kind)


@dataclass(frozen=True)
class Limits:
    """Largest torque (Nm), speed (rad/s) and angle from the start (rad) of motor and load."""

    torque: float
    speed: float
    angle: float


#: Band of the torque as fractions of the torsional frequency (option: 2 to 140 Hz for 100 Hz, around zero and pole).
BAND = (0.02, 1.4)

#: Noise on the speed levels: this share of the torque limit, but no more than so many times the Coulomb torque
#: (option: more noise than needed to reverse the shaft torque makes friction less certain).
NOISE_SHARE, NOISE_FRICTION = 0.1, 2.0

#: Speed levels as fractions of the speed limit: two in each direction, far apart. The highest leaves room for the
#: noise and for friction that differs from the nameplate (option).
LEVELS = (0.15, 0.75, -0.75, -0.15)

#: Share of torque that a change of level may take, and its shortest time, s (option).
RAMP_SHARE, SHORTEST_RAMP = 0.5, 0.4


def shape(
    kind: str,
    nameplate: Drivetrain,
    limits: Limits,
    band: tuple[float, float],
    duration: float,
    dt: float,
    seed: int,
) -> Callable[[float], Array]:
    """Scale in (0, 1] → motor torque (n,), Nm; at scale 1 the peak (or the speed level) is at its limit."""
    if kind == "levels":
        return lambda scale: signals.excitation(
            duration,
            dt,
            seed=seed,
            band=band,
            limit=limits.torque,
            **_levels(scale, nameplate, limits, duration),
        )
    unit = {
        "step": lambda: _steps(nameplate, limits, duration, dt),
        "chirp": lambda: signals.chirp(*band, 1.0, duration, dt),
        "multisine": lambda: signals.multisine(*band, 1.0, duration, dt, seed=seed),
        "prbs": lambda: signals.prbs(1.0, 0.5 / band[1], duration, dt, seed=seed),
        "noise": lambda: signals.noise(*band, 1.0, duration, dt, seed=seed),
    }[kind]()
    unit = limits.torque / np.max(np.abs(unit)) * unit
    return lambda scale: scale * unit


def _levels(scale: float, nameplate: Drivetrain, limits: Limits, duration: float) -> dict[str, Any]:
    """Speeds, ramps and noise of ``signals.excitation`` within the limits."""
    inertia, coulomb = nameplate.inertia_total, nameplate.coulomb + nameplate.coulomb_motor
    viscous = nameplate.viscous + nameplate.viscous_motor
    fastest = max(LEVELS) * scale * limits.speed
    ramp = max(SHORTEST_RAMP, 2.0 * inertia * fastest / (RAMP_SHARE * limits.torque))
    # Both levels of one direction turn the drive by about the mean level times their time: within the angle.
    mean = 0.5 * (LEVELS[0] + LEVELS[1]) * scale * limits.speed
    angle = 0.8 * limits.angle
    rounds = max(2, int(np.ceil(mean * 0.5 * duration / angle))) if np.isfinite(angle) else 2
    rounds = max(1, min(rounds, int(duration / (2.0 * ramp * len(LEVELS)))))
    noise = NOISE_SHARE * limits.torque
    if coulomb > 0.0:
        noise = min(noise, NOISE_FRICTION * coulomb)
    levels = [level * scale * limits.speed for level in LEVELS] * rounds
    return {
        "inertia": inertia, "coulomb": coulomb, "viscous": viscous, "levels": levels, "ramp": ramp,
        "noise_rms": scale * noise,
    }  # fmt: skip


def _steps(nameplate: Drivetrain, limits: Limits, duration: float, dt: float) -> Array:
    """Full torque forwards and backwards; the first step lasts half as long, so that the speed swings around zero."""
    hold = max(20.0 * dt, nameplate.inertia_total * limits.speed / limits.torque)
    times = np.arange(0.5 * hold, duration, hold)
    values = np.where(np.arange(times.size + 1) % 2 == 0, 1.0, -1.0)
    return signals.steps(list(times), list(values), duration, dt)
