"""Frequency response of the linear two-mass drivetrain, for any of its signals."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InvalidInput

Complexes = NDArray[np.complex128]

#: Outputs over the motor torque that the two-mass drivetrain has.
OUTPUTS = ("angle_motor", "angle_load", "speed_motor", "speed_load", "twist", "torque_shaft")
_NEEDED = ("inertia_motor", "inertia_load", "stiffness", "damping")


@checks_arguments
def two_mass_response(parameters: Mapping[str, float], output: str, s: Complexes) -> Complexes:
    """Output over motor torque with the gap closed, at complex frequencies s (1/s), of the same shape.

    Parameters
    ----------
    parameters : mapping
        ``inertia_motor``, ``inertia_load``, ``stiffness``, ``damping``; optional ``viscous`` (load), ``viscous_motor``
        and ``delay`` (s).
    output : str
        One of ``OUTPUTS``.
    """
    if output not in OUTPUTS:
        raise InvalidInput(
            "two_mass_response: output", repr(output), f"one of {OUTPUTS}", "Choose another output."
        )
    missing = [name for name in _NEEDED if name not in parameters]
    if missing:
        raise InvalidInput(
            "two_mass_response.parameters", f"no {', '.join(missing)}", f"all of {_NEEDED}", "Add it."
        )
    s = np.asarray(s, dtype=complex)
    if not np.all(np.isfinite(s)) or np.any(s == 0.0):
        raise InvalidInput("two_mass_response.s", "0, NaN or infinity", "other frequencies", "Leave it out.")
    shaft = parameters["stiffness"] + parameters["damping"] * s
    load = parameters["inertia_load"] * s**2 + parameters.get("viscous", 0.0) * s
    motor = parameters["inertia_motor"] * s**2 + parameters.get("viscous_motor", 0.0) * s
    # Angles over torque: (load + shaft)/D and shaft/D, D expanded so that nothing cancels at low frequency.
    denominator = motor * load + (motor + load) * shaft
    numerator = {
        "angle_motor": load + shaft,
        "angle_load": shaft,
        "speed_motor": s * (load + shaft),
        "speed_load": s * shaft,
        "twist": load,
        "torque_shaft": shaft * load,
    }[output]
    return np.asarray(numerator / denominator * np.exp(-s * parameters.get("delay", 0.0)), dtype=complex)
