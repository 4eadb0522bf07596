"""Observer 1 on a drive of the zoo: its load speed with the identified and with the true equivalent two masses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

import lostmotion as lm
from lostmotion.compare.experiment import SETTLING
from lostmotion.errors import InvalidInput
from lostmotion.identification import Identification
from lostmotion.metrics import rmse, signal_range
from lostmotion.rig.zoo.units import Units

#: The observer is judged where these are identified; of a drive with a gap, the backlash too.
NEEDED = ("inertia_motor", "inertia_load", "stiffness")
#: RMSE over the load speed's range that is fine (option: the target).
FINE = 0.005


def true_values(drive: lm.rig.Drive) -> dict[str, float]:
    """The true equivalents as a drivetrain of two masses takes them."""
    # Of a measured torque there is no lag; a friction line that falls has no place in a drivetrain.
    truth = drive.truth.parameters
    return {name: max(value or 0.0, 0.0) for name, value in truth.items() if name != "inertia_total"}


def observer_errors(drive: lm.rig.Drive, found: Identification) -> dict[str, float | None] | None:
    """RMSE of the load speed over its range, by the identified and by the true equivalent two masses.

    None where what the observer needs is not identified, or the drive has no equivalent two masses. A single None
    stands for an observer that cannot be made.
    """
    truth = drive.truth.parameters
    needed = NEEDED + (("backlash",) if float(drive.dimensions["gap"]) > 0.0 else ())
    if any(found.sources[name] != "identified" or truth[name] is None for name in needed):
        return None
    true = lm.Drivetrain.two_mass(**true_values(drive))  # type: ignore[arg-type]
    return {"identified": _error(drive, found.drivetrain), "true": _error(drive, true)}


def _error(drive: lm.rig.Drive, model: lm.Drivetrain) -> float | None:
    """In the virtual rig's units, for which the observer's covariances are; None if it cannot be made."""
    limit = drive.nameplate.actuator.torque_limit
    units = Units.of(model.inertia_total, model.pole_frequency, limit)
    recording, dt = drive.recording, drive.recording.dt / units.time
    shown = lm.Recording(
        time=dt * np.arange(len(recording)),
        signals={
            "torque_motor": recording["torque_motor"] / units.torque,
            "speed_motor": recording["speed_motor"] / units.speed,
        },
    )
    counts = bool(recording.meta["speed_from_counts"])
    try:
        observer = lm.observers.kalman(units.chain(model, limit), dt=dt, speed_from_counts=counts)
    except InvalidInput:
        return None
    judged = slice(round(SETTLING / dt), None)
    true = drive.truth.signals["speed_load"][judged]
    return rmse(units.speed * observer.run(shown)["speed_load_estimated"][judged], true) / signal_range(true)


def observer_numbers(entries: Sequence[dict[str, Any]]) -> dict[str, dict[str, float]]:
    """Figures of all drives of which Observer 1 was judged, and of those without the load torque that it lacks."""
    without = [entry for entry in entries if entry["dimensions"]["load_torque"] == "none"]
    return {"all": _numbers(entries), "without load torque": _numbers(without)}


def _numbers(entries: Sequence[dict[str, Any]]) -> dict[str, float]:
    """An observer that cannot be made has an infinite error."""
    judged = [entry["observer"] for entry in entries if entry.get("observer")]
    judged = [errors for errors in judged if errors["true"] is not None]
    true = np.array([errors["true"] for errors in judged])
    identified = np.array([np.inf if e["identified"] is None else e["identified"] for e in judged])
    return {
        "drives": len(judged),
        "fine_identified": _share(identified <= FINE),
        "error_90_identified": _most(identified),
        "fine_true": _share(true <= FINE),
        "error_90_true": _most(true),
        "ratio_90": _most(identified / true),
    }


def observer_table(numbers: dict[str, dict[str, float]]) -> list[str]:
    """The same as Markdown."""
    fine = f"≤ {100 * FINE:g} %, %"
    lines = [
        "Observer 1: RMSE of the load speed over its range, with the identified and with the true equivalent.",
        "",
        f"| | drives | identified: {fine} | 90 % below, % | true: {fine} | 90 % below, % | 90 % of ratios below |",
        "|---" * 7 + "|",
    ]
    for name, n in numbers.items():
        cells = (
            100.0 * n[key] for key in ("fine_identified", "error_90_identified", "fine_true", "error_90_true")
        )
        shown = " | ".join(f"{cell:.3g}" for cell in cells)
        lines.append(f"| {name} | {n['drives']} | {shown} | {n['ratio_90']:.3g} |")
    return lines


def _share(holds: NDArray[np.bool_]) -> float:
    return float(np.mean(holds)) if holds.size else np.nan


def _most(values: NDArray[np.float64]) -> float:
    """What 90 % are below, as one of them: an infinite one must not make the mean of two infinite."""
    return float(np.quantile(values, 0.9, method="higher")) if values.size else np.nan
