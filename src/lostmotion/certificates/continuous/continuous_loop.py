"""Plant and a law in continuous time as one Lur'e system: a flow alone, without jumps.

::

    ξ = (plant, law)        ξ̇ = A ξ + E w + L·torque_load + R·speed_reference        z = Z ξ,  w = curve(z)

docs/proofs.md, equation 23.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ..lure import MEASURABLE, REFERENCE, LureLoop
from ..plant import plant_of
from ..rational import identity, rational, zeros
from ..static_curves import normalised_curve
from .continuous_law import ContinuousLaw

#: Unit of time in which the solver sees the rates, s (numerics: about that of the closed shaft's eigenmode).
TIME_UNIT = Fraction(1, 1024)


def continuous_loop(drivetrain: Drivetrain, law: ContinuousLaw) -> LureLoop:
    """The loop; all its states are those of the plant in the sense of ``LureLoop``, so are its curves.

    Raises
    ------
    InvalidInput
        For a drivetrain without a Lur'e form, or with a torque limit, and for inputs that the plant does not have.
    """
    if np.isfinite(drivetrain.actuator.torque_limit):
        raise InvalidInput(
            "certify: drivetrain", "a torque limit", "none for a continuous law", "Leave it out."
        )
    unknown = sorted(set(law.inputs) - {REFERENCE, *MEASURABLE})
    if unknown:
        raise InvalidInput(
            "certify: law",
            f"inputs {', '.join(unknown)}",
            f"{REFERENCE} and any of {', '.join(MEASURABLE)}",
            "Drop them.",
        )
    plant = plant_of(drivetrain)
    n, p, k, q = len(plant.states), len(plant.curves), len(law.states), len(law.curves)
    parts = [normalised_curve(curve) for curve in law.curves]
    exact = {key: rational(getattr(law, key)) for key in ("A", "B", "E", "F", "C", "D", "J")}
    measured, reference = zeros(len(law.inputs), n + p), zeros(len(law.inputs), 1)
    for i, name in enumerate(law.inputs):
        if name == REFERENCE:
            reference[i, 0] = Fraction(1)
        else:
            measured[i] = plant.measured[name]
    # A curve is a·z + b·σ(z).
    linear = np.array([[a] for a, _, _ in parts], dtype=object).reshape(q, 1) * exact["F"]
    height = np.diag(np.array([b for _, b, _ in parts], dtype=object)) if q else zeros(0, 0)
    flow, by_curve, by_reference = zeros(n + k, n + k), zeros(n + k, p + q), zeros(n + k, 1)
    flow[:n, :n], by_curve[:n, :p] = plant.A, plant.E
    rows = (slice(0, n), plant.B, exact["C"], exact["D"], exact["J"]), (
        slice(n, n + k), identity(k), exact["A"], exact["B"], exact["E"],
    )  # fmt: skip
    for place, into, state, given, curve in rows:
        flow[place, :n] += into @ given @ measured[:, :n]
        by_curve[place, :p] += into @ given @ measured[:, n:]
        flow[place, n:] += into @ (state + curve @ linear)
        by_curve[place, p:] += into @ curve @ height
        by_reference[place] += into @ given @ reference
    arguments = zeros(p + q, n + k)
    arguments[:p, :n], arguments[p:, n:] = plant.Z, exact["F"]
    size, none = n + k, zeros(n + k, 0)
    return LureLoop(
        dt=TIME_UNIT, states=(*plant.states, *(f"law: {name}" for name in law.states)), plant_size=size,
        A=flow, E=by_curve, L=np.vstack([plant.L, zeros(k, 1)]), Z=arguments, R=by_reference,
        S=identity(size), S_w=zeros(size, p + q), S_v=none, N=none.T, N_w=zeros(0, p + q), N_v=zeros(0, 0),
        M=zeros(0, 1), plant_curves=(*plant.curves, *(curve for _, _, curve in parts)), law_curves=(),
        names=(*plant.names, *(f"law: curve {j}" for j in range(q))),
    )  # fmt: skip
