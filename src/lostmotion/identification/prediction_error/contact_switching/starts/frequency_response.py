"""What the frequency response of a recording tells the search: zero, pole, and the lag of the torque."""

from __future__ import annotations

import numpy as np

from .....drivetrain import Drivetrain
from .....errors import InvalidInput
from .....recording import Recording
from ....frequency.response import frequency_response
from ....frequency.two_mass_fit import two_mass_fit
from ..filter import ContactFilter
from .longest_segment import longest_segment
from .slow_motion import NAMEPLATE

#: What a mode tells: all of it or nothing.
OF_THE_MODE = ("inertia_motor", "inertia_load", "stiffness", "damping")


def linear_drive(flt: ContactFilter, start: Drivetrain) -> dict[str, float]:
    """The linear two masses that the longest segment shows: ``delay`` (s; lag and delay together) and, where it shows a
    torsional mode, inertias (kg m²), stiffness (Nm/rad) and damping (Nm s/rad). Empty where torque and speed do not
    belong together. ``start``: the nameplate.

    A gap makes the spring softer than it is; a start needs no more.
    """
    torque, speed = longest_segment(flt)
    recording = Recording(
        time=np.arange(torque.size, dtype=np.float64) * flt.dt,
        signals={"torque_motor": torque, "speed_motor": speed},
        meta={"speed_from_counts": flt.counted},
    )
    try:
        found = two_mass_fit(frequency_response(recording, output="speed_motor")).values
    except InvalidInput:
        return {}
    mode = {name: found[name] for name in OF_THE_MODE}
    known = {name: value for name, value in mode.items() if value is not None}
    shows = len(known) == len(mode) and _is_this_drive(known, start)
    delay = found["delay"]
    return (known if shows else {}) | ({} if delay is None else {"delay": delay})


def _is_this_drive(mode: dict[str, float], start: Drivetrain) -> bool:
    """Whether a mode's inertias are about the nameplate's together: friction may look like a mode."""
    with np.errstate(all="ignore"):
        off = np.log((mode["inertia_motor"] + mode["inertia_load"]) / start.inertia_total)
    return bool(min(mode.values()) > 0.0 and abs(off) < np.log(NAMEPLATE))
