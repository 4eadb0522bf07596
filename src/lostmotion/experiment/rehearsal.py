"""The rehearsal of a test on finer plants around the nameplate, and the largest amplitude within the limits there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from .. import rig
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..recording import Recording
from ..rig.excitation import Array, Limits
from ..simulation import Sensor

#: Bisections of the search for the largest amplitude (numerics: to 1 % of it).
HALVINGS = 7

#: Spread of the rehearsal's plants around the nameplate, as a fraction (as the virtual rigs; others ±10 %), and the
#: parameters that are at their low end on the lightest plant (option).
SPREAD = {"inertia_motor": 0.1, "inertia_load": 0.1, "backlash": 0.2, "coulomb": 0.2, "viscous": 0.2}
LIGHT = ("inertia_motor", "inertia_load", "coulomb", "viscous")


def rehearsal_rigs(
    nameplate: Drivetrain,
    spread: Mapping[str, tuple[float, float]],
    plants: int,
    encoder_bits: int,
    seed: int,
) -> list[rig.Rig]:
    """The nameplate's own values first, then the lightest plant, which is the fastest, then varied ones."""
    values = nameplate.parameters()
    exact = {name: (value, value) for name, value in values.items()}
    ranges = {n: ((1.0 - s) * values[n], (1.0 + s) * values[n]) for n, s in SPREAD.items()} | dict(spread)
    light = ranges | {name: (ranges[name][0],) * 2 for name in LIGHT}
    rigs = [rig.finer_rig(nameplate, exact, seed)]
    rigs += [rig.finer_rig(nameplate, light if i == 1 else ranges, 1000 * seed + i) for i in range(1, plants)]
    encoder = Sensor("angle_motor", 2.0 * np.pi / 2**encoder_bits, difference=True)
    return [replace(r, sensors={**r.sensors, "speed_motor": encoder}) for r in rigs]


def largest(
    torque_at: Callable[[float], Array], rigs: list[rig.Rig], limits: Limits, dt: float
) -> tuple[float, list[tuple[Recording, dict[str, float]]]]:
    """Largest scale that keeps the limits on every plant, and the recordings with their peaks."""
    low, high, best = 0.0, 1.0, None
    for number in range(HALVINGS + 1):
        # Full scale first, then bisection. The peaks need not rise with the scale: the kept one has been tried.
        scale = 1.0 if number == 0 else 0.5 * (low + high)
        runs = played(torque_at(scale), rigs, limits, dt)
        if runs is None:
            high = scale
            continue
        low, best = scale, runs
        if number == 0:
            break
    if best is None:
        raise InvalidInput(
            "design_excitation",
            f"limits {limits}",
            "limits that allow a motion",
            "Raise the speed or the angle limit; or give a narrower spread, above all of the friction.",
        )
    return low, best


def played(
    torque: Array, rigs: list[rig.Rig], limits: Limits, dt: float
) -> list[tuple[Recording, dict[str, float]]] | None:
    """Recording and peaks on each plant; None as soon as one exceeds the limits."""
    runs = []
    for plant in rigs:
        recording, truth = rig.record(plant, torque_motor=torque, dt=dt)
        exact = truth.signals
        peaks = {
            "torque": float(np.max(np.abs(exact["torque_motor"]))),
            "speed": max(float(np.max(np.abs(exact[f"speed_{end}"]))) for end in ("motor", "load")),
            "angle": max(float(np.max(np.abs(exact[f"angle_{end}"]))) for end in ("motor", "load")),
        }
        if any(peaks[name] > (1.0 + 1e-12) * limit for name, limit in vars(limits).items()):
            return None
        runs.append((recording, peaks))
    return runs
