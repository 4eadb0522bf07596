"""What generated code says of itself: version, date, limits of its outputs, and the drivetrain it was made for."""

from __future__ import annotations

import os
from datetime import UTC, datetime
from typing import Any

import numpy as np

from ..drivetrain import PARAMETER_UNITS, Drivetrain
from ..errors import InvalidInput
from ..plain_data import shown
from ..recording import unit_of
from ..systems import DiscreteSystem, Stepper
from ..version import VERSION
from .compiler import C_FLAGS

#: The environment variable that sets the date (s since 1970), so that the same law gives the same bytes on any day:
#: reproducible-builds.org/specs/source-date-epoch.
EPOCH = "SOURCE_DATE_EPOCH"


def spelling(law: DiscreteSystem | Stepper, name: str, real: str) -> dict[str, Any]:
    """For the templates: how names, numbers and signals of any law are written in C."""
    return {
        "name": name,
        "guard": f"{name.upper()}_H",
        "real": real,
        "flags": " ".join(C_FLAGS),
        "law_name": law.name.replace("*/", "* /"),
        "dt": repr(law.dt),
        "inputs": [(n, unit_of(n)) for n in law.inputs],
        "outputs": [(n, unit_of(n)) for n in law.outputs],
    }


def facts(law: DiscreteSystem | Stepper, drivetrain: Drivetrain | None) -> dict[str, Any]:
    """For the templates: version, date, limits (name, low, high, unit) and parameters (name, value, unit)."""
    return {
        "version": VERSION,
        "date": _date(),
        "limits": [
            (name, repr(low), repr(high), unit_of(name)) for name, (low, high) in output_limits(law).items()
        ],
        "parameters": [] if drivetrain is None else _parameters(drivetrain),
    }


def output_limits(law: DiscreteSystem | Stepper) -> dict[str, tuple[float, float]]:
    """Least and largest value of every output that is bound: by curves, where it is a sum of saturations alone, or by a
    stepper's kind."""
    if isinstance(law, Stepper):
        from ..kernels.steppers import LIMITS

        place = LIMITS.get(law.estimator)
        limit = 0.0 if place is None else float(law.parameters[place])
        return {} if place is None else {name: (-limit, limit) for name in law.outputs}
    flat = [curve.slope_left == curve.slope_right == 0.0 for curve in law.curves]
    found = {}
    for i, name in enumerate(law.outputs):
        used = np.flatnonzero(law.J[i])
        if np.any(law.C[i]) or np.any(law.D[i]) or not used.size or not all(flat[j] for j in used):
            continue
        values = [[float(law.J[i, j]) * w for _, w in law.curves[j].points] for j in used]
        found[name] = (sum(map(min, values)), sum(map(max, values)))
    return found


def _parameters(drivetrain: Drivetrain) -> list[tuple[str, str, str]]:
    """Numbers of the drivetrain with their units: of two masses by name, of a chain by number."""
    if len(drivetrain.inertias) == 2:
        return [(name, repr(value), PARAMETER_UNITS[name]) for name, value in drivetrain.parameters().items()]
    found = [(f"inertia_{i + 1}", repr(j), "kg m2") for i, j in enumerate(drivetrain.inertias)]
    for i, shaft in enumerate(drivetrain.shafts):
        for name in ("stiffness", "damping", "backlash"):
            found.append((f"{name}_{i + 1}", repr(getattr(shaft, name)), PARAMETER_UNITS[name]))
    for i, friction in enumerate(drivetrain.frictions):
        found.append((f"coulomb_{i + 1}", repr(friction.coulomb), "Nm"))
        found.append((f"viscous_{i + 1}", repr(friction.viscous), "Nm s/rad"))
    return [*found, ("lag", repr(drivetrain.lag), "s")]


def _date() -> str:
    said = os.environ.get(EPOCH)
    try:
        moment = datetime.now(UTC) if not said else datetime.fromtimestamp(int(said), UTC)
    except (ValueError, OverflowError, OSError):
        raise InvalidInput(
            EPOCH, shown(said), "whole seconds since 1970", "Unset it for the date of today."
        ) from None
    return moment.date().isoformat()
