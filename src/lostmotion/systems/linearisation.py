"""A law with every curve replaced by a straight line: the linear system that margins are computed of."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from ..argument_checks import checks_arguments
from ..errors import InvalidInput
from .discrete_system import DiscreteSystem


@checks_arguments
def linearised(system: DiscreteSystem, slopes: Sequence[float]) -> DiscreteSystem:
    """The system with wᵢ = slopeᵢ·zᵢ in the place of its curves.

    ::

        w = (I − S H)⁻¹ S (F x + G u)        S = diag(slopes)

    Parameters
    ----------
    system : DiscreteSystem
        Without checks (``without_checks()``): a rejected sample is no linear matter.
    slopes : sequence of float
        One for each curve: its slope at the operating point, or its describing function.

    Raises
    ------
    InvalidInput
        If there is not one finite slope for each curve, or the system has checks.
    """
    values = np.asarray(slopes, dtype=float)
    if values.shape != (len(system.curves),) or not np.all(np.isfinite(values)):
        raise InvalidInput(
            "linearised.slopes",
            repr(slopes),
            f"{len(system.curves)} finite numbers",
            "Give one for each curve.",
        )
    if system.checks:
        raise InvalidInput(
            "linearised.system", "a law with checked inputs", "one without", "Use system.without_checks()."
        )
    S = np.diag(values)
    by_curves = np.linalg.solve(np.eye(values.size) - S @ system.H, S)
    by_state, by_input = by_curves @ system.F, by_curves @ system.G
    return replace(
        system,
        A=system.A + system.E @ by_state,
        B=system.B + system.E @ by_input,
        C=system.C + system.J @ by_state,
        D=system.D + system.J @ by_input,
        curves=(), E=np.empty(0), F=np.empty(0), G=np.empty(0), H=np.empty(0), J=np.empty(0),
        P=np.empty(0), Q=np.empty(0), R=np.empty(0),
    )  # fmt: skip
