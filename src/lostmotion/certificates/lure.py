"""Plant and law as one Lur'e system: a linear flow and a linear jump, with static curves.

Between samples the plant flows while torque and law stand still; at a sample the law jumps::

    ξ = (plant, torque_motor held, law)
    ξ̇  = A ξ + E w + L·torque_load                  z = Z ξ,              w = curve(z)   plant
    ξ⁺ = S ξ + S_w w + S_v v + R·speed_reference     s = N ξ + N_w w + N_v v + M·speed_reference,
                                                    v = curve(s)                        law

docs/stability.md, section 1. All numbers are exact fractions of the floats of drivetrain and law.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np

from ..drivetrain import Drivetrain
from ..errors import InvalidInput
from ..systems import DiscreteSystem, connect, one_sample_delay, pruned
from .rational import Matrix, identity, rational, zeros
from .static_curves import StaticCurve, normalised

#: What a law may read of the plant, beside its reference.
MEASURABLE = ("speed_motor", "speed_load", "twist", "torque_shaft")

REFERENCE = "speed_reference"


@dataclass(frozen=True, eq=False, kw_only=True)
class Plant:
    """A two-mass drivetrain as a flow with curves; states twist, speed_motor, speed_load (torque_actuator).

    Parameters
    ----------
    states : tuple of str
    A : (n, n) array, B : (n, 1) array of the torque set-point, L : (n, 1) array of the load torque
    E : (n, m) array
        Of the curves' values.
    Z : (m, n) array
        Of the curves' arguments.
    curves : tuple of StaticCurve
        Gap, then friction of motor and load, where they are.
    measured : mapping of signal → row (n + m,) over states and curve values
    """

    states: tuple[str, ...]
    A: Matrix
    B: Matrix
    L: Matrix
    E: Matrix
    Z: Matrix
    curves: tuple[StaticCurve, ...]
    names: tuple[str, ...]
    measured: dict[str, Matrix]


@dataclass(frozen=True, eq=False, kw_only=True)
class LureLoop:
    """The closed loop; symbols as in the module's equations, sizes n states, p plant curves, q law curves.

    ``dt`` in s. ``plant_size``: number of plant states, which come first; the held torque follows.
    """

    dt: Fraction
    states: tuple[str, ...]
    plant_size: int
    A: Matrix
    E: Matrix
    L: Matrix
    Z: Matrix
    S: Matrix
    S_w: Matrix
    S_v: Matrix
    R: Matrix
    N: Matrix
    N_w: Matrix
    N_v: Matrix
    M: Matrix
    plant_curves: tuple[StaticCurve, ...]
    law_curves: tuple[StaticCurve, ...]
    names: tuple[str, ...]

    @property
    def is_odd(self) -> bool:
        """Whether both directions are alike: then what holds for one speed holds for the opposite one."""
        return all(curve.is_odd for curve in (*self.plant_curves, *self.law_curves))


def lure_loop(drivetrain: Drivetrain, law: DiscreteSystem, *, delay: int = 0) -> LureLoop:
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

    Raises
    ------
    InvalidInput
        For another drivetrain or law: a proof says nothing about it.
    """
    plant, law = plant_of(drivetrain), _law_alone(drivetrain, law, delay)
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
        names=(*plant.names, *(f"law: curve {j}" for j in range(q))),
    )  # fmt: skip


def plant_of(drivetrain: Drivetrain) -> Plant:
    """The drivetrain between samples, in exact fractions of its parameters."""
    _check_drivetrain(drivetrain)
    shaft = drivetrain.shaft
    k, d = Fraction(shaft.stiffness), Fraction(shaft.damping)
    j = [Fraction(inertia) for inertia in drivetrain.inertias]
    viscous = [Fraction(friction.viscous) for friction in drivetrain.frictions]
    lag = Fraction(drivetrain.lag)
    states = ("twist", "speed_motor", "speed_load", *(("torque_actuator",) if lag else ()))
    n = len(states)
    a, b, load = zeros(n, n), zeros(n, 1), zeros(n, 1)
    a[0, 1], a[0, 2] = Fraction(1), Fraction(-1)
    shaft_torque = zeros(n)
    shaft_torque[:3] = rational([k, d, -d])
    a[1] -= shaft_torque / j[0]
    a[2] += shaft_torque / j[1]
    a[1, 1] -= viscous[0] / j[0]
    a[2, 2] -= viscous[1] / j[1]
    load[2, 0] = 1 / j[1]
    if lag:
        a[1, 3], a[3, 3], b[3, 0] = 1 / j[0], -1 / lag, 1 / lag
    else:
        b[1, 0] = 1 / j[0]
    columns, rows, curves, names = [], [], [], []
    if shaft.has_backlash:
        # k·dz(z) = k·z - k·backlash·σ(z), σ a saturation of height 1.
        h = Fraction(shaft.backlash) / 2
        lead = d / k if shaft.contact == "viscoelastic" else Fraction(0)
        half = Fraction(1, 2)
        columns.append(rational([0, 2 * h * k / j[0], -2 * h * k / j[1], *[0] * (n - 3)]))
        rows.append(rational([1, lead, -lead, *[0] * (n - 3)]))
        curves.append(StaticCurve(((-h, -half), (h, half))))
        names.append("gap")
    for i, friction in enumerate(drivetrain.frictions):
        plus, minus = Fraction(friction.coulomb_plus), Fraction(friction.coulomb_minus)
        if plus or minus:
            height = plus + minus
            columns.append(rational([0] * n))
            columns[-1][1 + i] = -height / j[i]
            rows.append(rational([int(s == 1 + i) for s in range(n)]))
            zero = Fraction(0)
            curves.append(StaticCurve(((zero, -minus / height), (zero, plus / height))))
            names.append(("friction of the motor", "friction of the load")[i])
    p = len(curves)
    measured = {
        name: rational([*(int(s == name) for s in states), *[0] * p])
        for name in ("speed_motor", "speed_load", "twist")
    }
    measured["torque_shaft"] = rational([*shaft_torque, *[0] * p])
    if shaft.has_backlash:
        measured["torque_shaft"][n] = -k * Fraction(shaft.backlash)
    return Plant(
        states=states, A=a, B=b, L=load,
        E=rational(np.array(columns, dtype=object).reshape(p, n).T),
        Z=rational(np.array(rows, dtype=object).reshape(p, n)),
        curves=tuple(curves), names=tuple(names), measured=measured,
    )  # fmt: skip


def _check_drivetrain(drivetrain: Drivetrain) -> None:
    """Raise where the Lur'e form is not this drivetrain's."""
    friction = drivetrain.frictions
    actuator = drivetrain.actuator
    wrong = [
        (len(drivetrain.inertias) != 2, f"{len(drivetrain.inertias)} inertias", "Reduce it to two masses first."),
        (drivetrain.locked is not None, "a held end", "Free it."),
        (
            any(s.has_backlash and s.contact not in ("viscoelastic", "dead_zone") for s in drivetrain.shafts),
            f"contact law {', '.join(s.contact for s in drivetrain.shafts)}",
            "Take contact = 'viscoelastic', the law of the observers.",
        ),
        (any(f.stribeck for f in friction), "Stribeck friction", "The loop may stick and slip: simulate it."),
        (
            any(f.breakaway is not None and f.breakaway > max(f.level_at_rest) for f in friction),
            "a breakaway level above Coulomb friction",
            "The loop may stick and slip: simulate it.",
        ),
        (np.isfinite(actuator.rate_limit), "a rate limit of the torque", "Leave it out where it never acts."),
    ]
    for found, got, remedy in wrong:
        if found:
            raise InvalidInput(
                "certify: drivetrain", got,
                "two free masses, contact viscoelastic or dead_zone, viscous and Coulomb friction", remedy,
            )  # fmt: skip


def _law_alone(drivetrain: Drivetrain, law: DiscreteSystem, delay: int) -> DiscreteSystem:
    """The law as it acts on the motor: limited and delayed, without checks and without what nothing reads."""
    if "torque_motor" not in law.outputs:
        raise InvalidInput("certify: law", f"outputs {law.outputs}", "torque_motor", "Connect the controller.")
    unknown = sorted(set(law.inputs) - {REFERENCE, *MEASURABLE})
    if unknown:
        raise InvalidInput(
            "certify: law", f"inputs {', '.join(unknown)}", f"{REFERENCE} and any of {', '.join(MEASURABLE)}",
            "Connect observer and controller to one law first.",
        )  # fmt: skip
    law = pruned(law, ("torque_motor",))
    for i in range(delay):
        later = one_sample_delay("torque_motor", law.dt, f"torque_motor_{i + 1}")
        law = replace(
            connect([law, later], inputs=law.inputs, outputs=later.outputs), outputs=("torque_motor",)
        )
    return law


def _below(matrix: Matrix, size: int) -> Matrix:
    whole = zeros(size, matrix.shape[1])
    whole[: matrix.shape[0]] = matrix
    return whole


def _beside(matrix: Matrix, size: int) -> Matrix:
    whole = zeros(matrix.shape[0], size)
    whole[:, : matrix.shape[1]] = matrix
    return whole
