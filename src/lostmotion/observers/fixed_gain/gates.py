"""A correction that acts in contact only: exact in Lur'e form, although it is a product of innovation and contact.

A product of two signals does not fit the form, but a limiter with a moving limit does. With e the innovation and
L ≥ 0 the opening, a curve of the estimated twist that is zero in the gap::

    w₁ = max(e − L, 0),    w₂ = max(−L − (e − w₁), 0),    e − w₁ + w₂ = clip(e, −L, L)

So the part of the correction that needs contact is K·clip(e, ±L): zero in the gap, K·e in contact, and K·L for an
outlier.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...curves import PiecewiseLinear
from ...systems import DiscreteSystem
from ..model import ObserverModel
from ..scale import scale_of, sized

Array = NDArray[np.float64]

#: Largest innovation that a gate passes, per signal in SI units (numerics: larger than those of good samples on the
#: paper's rig). A drivetrain of another size gets them by ``scale.scale_of``.
LARGEST_CORRECTION = {
    "speed_motor": 100.0, "speed_load": 100.0, "twist": 0.1, "torque_shaft": 1000.0, "angle_motor": 1.0
}  # fmt: skip

#: Shaft torque above which a gate passes so much, Nm on the paper's rig (calibrated on the virtual rigs 1 to 4: half
#: and double give the same error of the load speed; benchmarks/calibrations.py).
OPEN_AT = 1.0

#: max(z, 0) (numerics).
POSITIVE_PART = PiecewiseLinear(((0.0, 0.0),), 0.0, 1.0)


def with_gates(
    law: DiscreteSystem,
    measured: tuple[str, ...],
    rows: tuple[Array, Array],
    gain: Array,
    model: ObserverModel,
) -> DiscreteSystem:
    """Add the correction gain·clip(e, ±L) to an observer; e = measured − rows[0] x − rows[1] w.

    ``gain`` is (m, n_measured) over the first m states.
    """
    shaft = model.drivetrain.shaft
    scale = scale_of(model.drivetrain)
    half, width = 0.5 * shaft.backlash, OPEN_AT * scale.torque / shaft.stiffness
    largest = sized(LARGEST_CORRECTION, scale)
    n_w, n_x, n_u = len(law.curves), len(law.states), len(law.inputs)
    n_gates = 3 * len(measured)
    f, g = np.zeros((n_gates, n_x)), np.zeros((n_gates, n_u))
    h = np.zeros((n_gates, n_w + n_gates))
    e = np.zeros((n_x, n_gates))
    curves: list[PiecewiseLinear] = []
    contact = model.contact_argument()
    for i, signal in enumerate(measured):
        opening, above, below = 3 * i, 3 * i + 1, 3 * i + 2
        most = largest[signal]
        points = ((-half - width, most), (-half, 0.0), (half, 0.0), (half + width, most))
        curves += [PiecewiseLinear(points), POSITIVE_PART, POSITIVE_PART]
        f[opening, : contact.size] = contact
        for row, sign in ((above, 1.0), (below, -1.0)):
            f[row], g[row, 1 + i] = -sign * rows[0][i], sign
            h[row, :n_w] = -sign * rows[1][i]
            h[row, n_w + opening] = -1.0
        h[below, n_w + above] = 1.0
        column = gain[:, i]
        e[: column.size, above], e[: column.size, below] = -column, column
    # The innovation itself; the gates subtract what exceeds the opening.
    a, b, e_old = law.A.copy(), law.B.copy(), law.E.copy()
    m = gain.shape[0]
    a[:m] -= gain @ rows[0]
    b[:m, 1:] += gain
    e_old[:m] -= gain @ rows[1]
    return replace(
        law, A=a, B=b, E=np.hstack([e_old, e]), F=np.vstack([law.F, f]), G=np.vstack([law.G, g]),
        H=np.vstack([np.pad(law.H, ((0, 0), (0, n_gates))), h]), J=np.pad(law.J, ((0, 0), (0, n_gates))),
        curves=(*law.curves, *curves),
    )  # fmt: skip


def with_innovation(
    law: DiscreteSystem, measured: tuple[str, ...], rows: tuple[Array, Array]
) -> DiscreteSystem:
    """Add outputs ``innovation_<signal>``: measured − rows[0] x − rows[1] w, in the signal's unit."""
    d = np.zeros((len(measured), len(law.inputs)))
    d[:, 1:] = np.eye(len(measured))
    j = np.pad(-rows[1], ((0, 0), (0, len(law.curves) - rows[1].shape[1])))
    return replace(
        law, outputs=(*law.outputs, *(f"innovation_{s}" for s in measured)),
        C=np.vstack([law.C, -rows[0]]), D=np.vstack([law.D, d]), J=np.vstack([law.J, j]),
    )  # fmt: skip
