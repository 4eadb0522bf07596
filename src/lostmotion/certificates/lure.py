"""Plant and law as one Lur'e system: a linear flow and a linear jump, with static curves.

Between samples the plant flows while torque and law stand still; at a sample the law jumps::

    ξ = (plant, torque_motor held, law)
    ξ̇  = A ξ + E w + L·torque_load                  z = Z ξ,              w = curve(z)   plant
    ξ⁺ = S ξ + S_w w + S_v v + R·speed_reference     s = N ξ + N_w w + N_v v + M·speed_reference,
                                                    v = curve(s)                        law

docs/proofs.md, equations 1 to 3. All numbers are exact fractions of the floats of drivetrain and law.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

import numpy as np

from ..curves import saturation
from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem, connect, one_sample_delay, pruned
from .plant import plant_of
from .rational import Matrix, identity, rational, zeros
from .static_curves import StaticCurve, normalised

#: Longest computing delay, samples (option: drives have one to three; a state is added for each).
LONGEST_DELAY = 100
#: What a law may read of the plant, beside its reference.
MEASURABLE = ("speed_motor", "speed_load", "twist", "torque_shaft")

REFERENCE = "speed_reference"


@dataclass(frozen=True, eq=False, kw_only=True)
class LoopMatrices:
    """Flow, jump and the curves' arguments without inputs; symbols as in the module's equations."""

    A: Matrix
    E: Matrix
    Z: Matrix
    S: Matrix
    S_w: Matrix
    S_v: Matrix
    N: Matrix
    N_w: Matrix
    N_v: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class LureLoop(LoopMatrices):
    """The closed loop; symbols as in the module's equations, sizes n states, p plant curves, q law curves.

    ``dt`` in s. ``plant_size``: number of plant states, which come first; the held torque follows. ``limit``: the law
    curve that limits the torque, if one does. With a law in continuous time (``continuous_loop``) all states and curves
    are in the flow, and so is R.
    """

    dt: Fraction
    states: tuple[str, ...]
    plant_size: int
    L: Matrix
    R: Matrix
    M: Matrix
    plant_curves: tuple[StaticCurve, ...]
    law_curves: tuple[StaticCurve, ...]
    names: tuple[str, ...]
    limit: int | None = None

    @property
    def is_odd(self) -> bool:
        """Whether both directions are alike: then what holds for one speed holds for the opposite one."""
        return all(curve.is_odd for curve in (*self.plant_curves, *self.law_curves))


def lure_loop(
    drivetrain: Drivetrain, law: DiscreteSystem, *, delay: int = 0, stribeck: bool = False
) -> LureLoop:
    """The loop of a drivetrain and a connected law, without the law's input checks.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses, contact law ``viscoelastic`` or ``dead_zone``, viscous and Coulomb friction; its torque lag is a
        state, its torque limit a curve.
    law : DiscreteSystem
        Inputs speed_reference and any of ``MEASURABLE``; an output torque_motor.
    delay : int
        Computing delay in samples of the law.
    stribeck : bool
        Whether friction may fall with speed (``plant.plant_of``): no proof covers that.

    Raises
    ------
    InvalidInput
        For another drivetrain or law: a proof says nothing about it.
    """
    if isinstance(delay, bool) or not isinstance(delay, int) or delay < 0:
        raise InvalidInput("certify: delay", repr(delay), "a whole number of samples", "Use 0 for none.")
    plant, law = plant_of(drivetrain, stribeck), _limited_law(drivetrain, law)
    limit = _own_limit(law)
    law = delayed(law, delay)
    n, p, k, q = len(plant.states), len(plant.curves), len(law.states), len(law.curves)
    size = n + 1 + k
    inputs = zeros(len(law.inputs), n + p)
    reference = zeros(len(law.inputs), 1)
    for i, name in enumerate(law.inputs):
        if name == REFERENCE:
            reference[i, 0] = Fraction(1)
        else:
            inputs[i] = plant.measured[name]
    exact = {key: rational(getattr(law, key)) for key in ("A", "B", "E", "F", "G", "H", "C", "D", "J")}
    # Every curve is a·z + b·σ(z): the linear part joins the linear system, from the first curve to the last.
    parts = [normalised(curve) for curve in law.curves]
    known = n + 1 + k + p + q + 1  # columns: ξ, w, v, reference

    def row(state: Matrix, given: Matrix, curve: Matrix, values: Matrix) -> Matrix:
        total = zeros(known)
        total[n + 1 : size] = state
        measured = given @ inputs
        total[:n] += measured[:n]
        total[size : size + p] += measured[n:]
        total[-1] += (given @ reference)[0]
        return total + curve @ values

    values, arguments = zeros(q, known), zeros(q, known)
    for j, (a, b, _) in enumerate(parts):
        arguments[j] = row(exact["F"][j], exact["G"][j], exact["H"][j], values)
        values[j] = a * arguments[j]
        values[j, size + p + j] += b
    jump = zeros(size, known)
    jump[:n, :n] = identity(n)
    jump[n] = row(exact["C"][0], exact["D"][0], exact["J"][0], values)
    for i in range(k):
        jump[n + 1 + i] = row(exact["A"][i], exact["B"][i], exact["E"][i], values)
    flow = zeros(size, size)
    flow[:n, :n], flow[:n, [n]] = plant.A, plant.B
    return LureLoop(
        dt=Fraction(law.dt),
        states=(*plant.states, "torque_motor", *(f"law: {name}" for name in law.states)),
        plant_size=n,
        A=flow, E=_below(plant.E, size), L=_below(plant.L, size), Z=_beside(plant.Z, size),
        S=jump[:, :size], S_w=jump[:, size : size + p], S_v=jump[:, size + p : -1], R=jump[:, -1:],
        N=arguments[:, :size], N_w=arguments[:, size : size + p], N_v=arguments[:, size + p : -1],
        M=arguments[:, -1:],
        plant_curves=plant.curves, law_curves=tuple(curve for _, _, curve in parts),
        names=(*plant.names, *(f"law: curve {j}" for j in range(q))), limit=limit,
    )  # fmt: skip


def delayed(law: DiscreteSystem, delay: int) -> DiscreteSystem:
    """The law whose torque_motor comes so many samples later."""
    if delay > LONGEST_DELAY:
        raise InvalidInput(
            "certify: delay",
            f"{delay} samples",
            f"at most {LONGEST_DELAY}",
            "Its unit is one sample of the law.",
        )
    for i in range(delay):
        law = _followed_by(law, one_sample_delay("torque_motor", law.dt, f"torque_motor_{i + 1}"))
    return law


def _limited_law(drivetrain: Drivetrain, law: DiscreteSystem) -> DiscreteSystem:
    """The law with the drive's torque limit, without checks and without what nothing reads."""
    if "torque_motor" not in law.outputs:
        raise InvalidInput(
            "certify: law", f"outputs {law.outputs}", "torque_motor", "Connect the controller."
        )
    unknown = sorted(set(law.inputs) - {REFERENCE, *MEASURABLE})
    if unknown:
        raise InvalidInput(
            "certify: law", f"inputs {', '.join(unknown)}", f"{REFERENCE} and any of {', '.join(MEASURABLE)}",
            "Connect observer and controller to one law first.",
        )  # fmt: skip
    law = pruned(law, ("torque_motor",))
    limit, own = drivetrain.actuator.torque_limit, _own_limit(law)
    if not np.isfinite(limit) or (
        own is not None and all(abs(w) <= limit for _, w in law.curves[own].points)
    ):
        return law
    one = np.ones((1, 1))
    return _followed_by(
        law,
        DiscreteSystem(
            inputs=("torque_motor",), outputs=("torque_limited",), dt=law.dt, curves=(saturation(limit),), G=one,
            J=one,
        ),
    )  # fmt: skip


def largest_torque(drivetrain: Drivetrain, law: DiscreteSystem) -> float:
    """What the torque cannot exceed in either direction, Nm; infinite without a limit."""
    law = _limited_law(drivetrain, law)
    own = _own_limit(law)
    if own is None:
        return float(np.inf)
    return float(min(abs(law.curves[own].points[end][1]) for end in (0, -1)))


def _own_limit(law: DiscreteSystem) -> int | None:
    """The curve that keeps the law's torque within bounds, and never falls: the torque is its value and nothing
    else."""
    own = np.flatnonzero(law.J[0])
    if np.any(law.C) or np.any(law.D) or own.size != 1 or law.J[0, own[0]] != 1.0:
        return None
    curve = law.curves[own[0]]
    values = [w for _, w in curve.points]
    flat = curve.slope_left == curve.slope_right == 0.0
    return int(own[0]) if flat and values == sorted(values) else None


def _followed_by(law: DiscreteSystem, last: DiscreteSystem) -> DiscreteSystem:
    """The law whose torque_motor is what the last system makes of it."""
    return replace(connect([law, last], inputs=law.inputs, outputs=last.outputs), outputs=("torque_motor",))


def _below(matrix: Matrix, size: int) -> Matrix:
    whole = zeros(size, matrix.shape[1])
    whole[: matrix.shape[0]] = matrix
    return whole


def _beside(matrix: Matrix, size: int) -> Matrix:
    whole = zeros(matrix.shape[0], size)
    whole[:, : matrix.shape[1]] = matrix
    return whole


def with_memory(loop: LureLoop, curves: Sequence[int]) -> LureLoop:
    """The loop that remembers, from sample to sample, the arguments of curves at the last one; nothing reads them.

    ``curves`` number the plant's, then the law's. A law that reads the shaft torque acts on the gap at its samples, the
    plant on the gap between them: the value at the last sample, a curve of the new state, ties both together in a proof
    (docs/proofs.md, equation 27).
    """
    p, known = len(loop.plant_curves), (*loop.plant_curves, *loop.law_curves)
    for place in curves:
        loop = _with_one_memory(loop, place, known[place], p)
    return loop


def _with_one_memory(loop: LureLoop, place: int, curve: StaticCurve, p: int) -> LureLoop:
    n, q = len(loop.states), len(loop.law_curves)
    name = f"law: {loop.names[place]} at the last sample"
    changed = {key: _grown(getattr(loop, key)) for key in ("A", "S", "N", "S_v", "N_v")}
    changed |= {key: _below(getattr(loop, key), n + 1) for key in ("E", "L", "S_w", "R")}
    changed |= {key: _below(getattr(loop, key), q + 1) for key in ("N_w", "M")}
    changed["N"][q, n] = Fraction(1)
    if place < p:
        changed["S"][n, :n] = loop.Z[place]
    else:
        law = place - p
        changed["S"][n, :n], changed["S_v"][n, :q] = loop.N[law], loop.N_v[law]
        changed["S_w"][n], changed["R"][n] = loop.N_w[law], loop.M[law]
    further: dict[str, Any] = changed
    return replace(
        loop, **further, Z=_beside(loop.Z, n + 1), states=(*loop.states, name),
        law_curves=(*loop.law_curves, curve), names=(*loop.names, name),
    )  # fmt: skip


def useful_memory(loop: LureLoop) -> tuple[int, ...]:
    """Numbers of the curves that a proof needs the memory of, for ``with_memory``.

    The gap where the law reads the shaft torque. And law curves that have no integral in V, since they read curves that
    read the plant (an observer's friction after a gap with injection), with what they read of these.
    """
    p, q = len(loop.plant_curves), len(loop.law_curves)
    by_plant = [bool(np.any(loop.N[j, : loop.plant_size])) or bool(np.any(loop.N_w[j])) for j in range(q)]
    found: set[int] = set()
    for j, curve in enumerate(loop.law_curves):
        read = {i for i in map(int, np.flatnonzero(loop.N_v[j])) if by_plant[i] or i in found}
        if read and not by_plant[j] and j != loop.limit and curve.rises and curve.steepest:
            found |= {j, *read}
    gap = loop.names[:p].index("gap") if "gap" in loop.names[:p] else None
    reads_torque = gap is not None and (np.any(loop.S_w[:, gap]) or np.any(loop.N_w[:, gap]))
    return (*((gap,) if gap is not None and (reads_torque or found) else ()), *(p + j for j in sorted(found)))


def _grown(matrix: Matrix) -> Matrix:
    """The matrix with a row and a column of zeros more."""
    return _beside(_below(matrix, matrix.shape[0] + 1), matrix.shape[1] + 1)
