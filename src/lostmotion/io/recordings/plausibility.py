"""What nameplate and law say against what was recorded: a number in another unit is off by far more than a guess."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from ...errors import Problem
from ...recording import Recording
from .torque_and_speed import inertia_shown

#: How far the inertia that a recording shows may be off the nameplate's (option: a factor of two each by noise and by
#: the nameplate, and some more; rpm for rad/s is a factor of nine).
FAR_OFF = 5.0
#: Largest wind-up at the recorded torque and largest backlash, rad, and largest lag, s (options: no drive's; arc
#: minutes, degrees and ms as rad and s are above).
LARGEST_WIND_UP, LARGEST_BACKLASH, LARGEST_LAG = 0.5, 0.4, 0.05
#: Fewest samples in a period of the torsional mode (option: 15 are needed, and a nameplate is three off).
FEWEST_SAMPLES = 4.0
#: Largest torque limit over the largest recorded torque, either way (option: mNm as Nm is a thousand times).
LARGEST_LIMIT = 50.0
#: Largest sample time of the law over that of the recording, either way (option: ms as s is a thousand times).
LARGEST_RASTER = 20.0
#: Largest torque of kp at the recorded speed over the limit (option: a stiff servo reaches its limit at a hundredth of
#: its speed; the unit is the rest).
LARGEST_GAIN = 1000.0


def check_nameplate(recording: Recording, nameplate: Mapping[str, float]) -> tuple[Problem, ...]:
    """Warnings where values of the nameplate (SI; some may be missing) cannot be those of the recorded drive."""
    known = {name: value for name, value in nameplate.items() if value > 0.0}
    found = [
        _too_large(known, "backlash", LARGEST_BACKLASH, "rad"),
        _too_large(known, "lag", LARGEST_LAG, "s"),
    ]
    motor, load, stiffness = (known.get(name) for name in ("inertia_motor", "inertia_load", "stiffness"))
    if motor and load:
        found += _inertia(recording, motor + load)
    if motor and load and stiffness:
        pole = math.sqrt(stiffness * (1.0 / motor + 1.0 / load)) / (2.0 * math.pi)
        found += [_too_fast(pole, recording.dt), _overdamped(known.get("damping", 0.0), stiffness, pole)]
    if "torque_motor" in recording:
        torque = float(np.max(np.abs(recording["torque_motor"])))
        if stiffness:
            found.append(_too_soft(torque / stiffness))
        found.append(_too_rough(known.get("coulomb", 0.0), torque))
    return tuple(problem for problem in found if problem is not None)


def check_law(
    recording: Recording,
    torque_limit: float | None,
    poles: Sequence[complex] | None,
    sample_time: float | None = None,
    kp: float | None = None,
) -> tuple[Problem, ...]:
    """Warnings where torque limit (Nm), poles (1/s), sample time (s) or kp (Nm s/rad) are not meant for this drive."""
    found = []
    torque, speed = (
        float(np.max(np.abs(recording[name]))) if name in recording else 0.0
        for name in ("torque_motor", "speed_motor")
    )
    if torque_limit is not None and torque > 0.0 and _far(torque_limit, torque, LARGEST_LIMIT):
        got, expected = f"{torque_limit:g} Nm", f"near the {torque:.3g} Nm that were recorded at most"
        remedy = "Check the unit: it is in Nm. If it is right, check unit and scale in the torque's channel."
        found.append(Problem.warning("law.torque_limit", got, expected, remedy))
    if sample_time is not None and _far(sample_time, recording.dt, LARGEST_RASTER):
        got, expected = f"{sample_time:g} s", f"near the {recording.dt:.4g} s of the recording"
        found.append(Problem.warning("law.sample_time", got, expected, 'Check the unit: "1 ms", or 0.001.'))
    if poles is not None:
        found += _poles([abs(pole) for pole in poles], recording)
    limit = torque_limit or torque
    if kp is not None and 0.0 < LARGEST_GAIN * limit < kp * speed:
        got = f"{kp:g} Nm s/rad: {kp * speed:.3g} Nm at the recorded {speed:.3g} rad/s"
        expected = f"within a thousand times the torque limit, {limit:.3g} Nm"
        remedy = "Check the unit, Nm s/rad, or leave kp and ki out: the default suits the drive."
        found.append(Problem.warning("law.kp", got, expected, remedy))
    return tuple(found)


def _far(one: float, other: float, factor: float) -> bool:
    return not 1.0 / factor <= one / other <= factor


def _poles(sizes: Sequence[float], recording: Recording) -> list[Problem]:
    """Poles faster than the raster, or slower than the whole recording; 1/s."""
    fastest, slowest, duration = max(sizes), min(sizes), float(recording.time[-1] - recording.time[0])
    if fastest * recording.dt > 1.0:
        expected = f"slower than 1/sample_time = {1.0 / recording.dt:.4g} 1/s"
        remedy = "Slower poles, or leave them out: the default suits the drive."
        return [Problem.warning("law.poles", f"{fastest:.4g} 1/s", expected, remedy)]
    if slowest * duration < 1.0:
        expected = f"faster than the recording is long: {1.0 / duration:.3g} 1/s"
        remedy = "Faster poles, or leave them out: the default suits the drive."
        return [Problem.warning("law.poles", f"{slowest:.4g} 1/s", expected, remedy)]
    return []


def _inertia(recording: Recording, nameplate: float) -> list[Problem]:
    """The motor accelerates as no drive of the nameplate's inertia (kg m2, of all) would."""
    shown = inertia_shown(recording)
    # A negative one is a wrong sign, which has its own check.
    if shown is None or shown < 0.0 or 1.0 / FAR_OFF < shown / nameplate < FAR_OFF:
        return []
    where = str(recording.meta.get("file", "recording"))
    got, expected = (
        f"an acceleration as of {shown:.2g} kg m2",
        f"about {nameplate:.2g} kg m2, as on the nameplate",
    )
    remedy = "Check unit and scale in the channels of torque and speed, and the inertias under [nameplate]."
    return [Problem.warning(f"{where}, torque_motor and speed_motor", got, expected, remedy)]


def _too_large(known: Mapping[str, float], name: str, most: float, unit: str) -> Problem | None:
    if known.get(name, 0.0) <= most:
        return None
    remedy = f"Check the unit: a number alone is in {unit}."
    return Problem.warning(f"nameplate.{name}", f"{known[name]:g} {unit}", f"at most {most:g} {unit}", remedy)


def _too_fast(pole: float, dt: float) -> Problem | None:
    """Torsional frequency by the nameplate, Hz."""
    if pole * dt <= 1.0 / FEWEST_SAMPLES:
        return None
    got = f"a torsional mode of {pole:.3g} Hz, {1.0 / (pole * dt):.2g} samples in a period"
    remedy = "Check the units of inertias and stiffness, or record at a higher rate."
    return Problem.warning("nameplate", got, f"at least {FEWEST_SAMPLES:g}, better 15", remedy)


def _overdamped(damping: float, stiffness: float, pole: float) -> Problem | None:
    ratio = damping * math.pi * pole / stiffness
    if ratio <= 1.0:
        return None
    remedy = "Check the unit: Nm s/rad. Leave it out if it is not known."
    got = f"{damping:g} Nm s/rad, a damping ratio of {ratio:.3g}"
    return Problem.warning("nameplate.damping", got, "a shaft that can swing: a ratio below 1", remedy)


def _too_soft(wind_up: float) -> Problem | None:
    """At the largest recorded torque, rad."""
    if wind_up <= LARGEST_WIND_UP:
        return None
    got = f"a shaft that winds by {wind_up:.3g} rad under the recorded torque"
    remedy = "Check the unit: Nm/rad. A value in Nm/deg is 57 times too small."
    return Problem.warning("nameplate.stiffness", got, f"at most {LARGEST_WIND_UP:g} rad", remedy)


def _too_rough(coulomb: float, torque: float) -> Problem | None:
    """Both in Nm: friction, and largest recorded torque."""
    if not coulomb > torque > 0.0:
        return None
    got, expected = f"{coulomb:g} Nm", f"less than the {torque:.3g} Nm under which the motor was recorded"
    return Problem.warning("nameplate.coulomb", got, expected, "Check the unit: Nm.")
