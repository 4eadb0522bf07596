"""A friction fit applied to another recording: how well it explains that one's torque."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...recording import Recording
from .inverse_dynamics import DECIMATION, regressors
from .result import FrictionFit, torque_to_use


@checks_arguments
def evaluate(
    found: FrictionFit,
    recording: Recording,
    *,
    angle: str = "angle_motor",
    torque: str | None = None,
    decimation: int = DECIMATION,
) -> FrictionFit:
    """Torque of another recording by the values of a fit, and the relative error of it::

        relative_error = ‖torque − fitted‖ / ‖torque‖

    Torque, speed and acceleration are filtered as in ``rigid_drive``: the error is that which the literature on the
    EMPS quotes. Values and intervals stay those of the fit; only what was identified or given counts.

    Parameters
    ----------
    found : FrictionFit
        Of ``rigid_drive``, ``output_error_fit`` or ``torque_step``, with an inertia.
    recording : Recording
        One that the fit has not seen.
    angle, torque, decimation
        As in ``rigid_drive``.

    Returns
    -------
    FrictionFit
        The same values, with the arrays and the relative error of this recording.

    Raises
    ------
    InvalidInput
        If the fit has no inertia, or a signal is missing.

    Source: Janot, Gautier & Brunot, nonlinearbenchmark.org (EMPS), whose filtering differs.
    """
    if found.values.get("inertia") is None:
        raise InvalidInput("evaluate: found", "no inertia", "an identified or given one", "See its problems.")
    used, problems = torque_to_use(recording, torque)
    by_direction = any(name.endswith(("_plus", "_minus")) for name in found.values)
    names, x, y, time = regressors(recording, angle, used, by_direction, decimation)
    fitted = np.array([float(found.values.get(name) or 0.0) for name in names]) @ x
    return replace(
        found,
        problems=problems,
        signal=used,
        time=time,
        torque=y,
        measured=y,
        fitted=fitted,
        relative_error=float(np.linalg.norm(y - fitted) / np.linalg.norm(y)),
    )
