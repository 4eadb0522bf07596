"""How wrong the state of an observer can be, whatever the drive does: a bound that an exact check proves.

The observer in continuous time is a copy of the drivetrain with a correction::

    x̂' = A x̂ + B·torque_motor + Σ E·curve(ẑ) + gain·(measured − expected)

With the whole gap no gain makes its error go to zero: within the gap the twist acts on no sensor but its own. What is
proved instead is a set that every error enters and none leaves. docs/proofs.md, equations 19 to 22.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...observers import kalman_gain
from ...observers.fixed_gain.injection import injection_of
from ...observers.model import observer_model
from ..certificate import drivetrain_data, short, word_of
from ..plant import plant_of
from . import verify_observer
from .invariant_polytope import Difference, invariant_polytope

Array = NDArray[np.float64]

STATES = ("twist", "speed_motor", "speed_load")

#: What the observer may measure here: the signals that are sums of its three states and of its gap.
SENSORS = ("speed_motor", "speed_load", "twist", "torque_shaft")

#: Pairs of faces of the polytope, beside those that bound one state (option: more take longer and prove a smaller
#: bound; on Table I 100 prove 19.4 mrad, 150 17.2, 200 16.4).
FACES = 120

#: Share of the decay found that is claimed (numerics: the claim is a round number below what is proved).
CLAIMED = 0.9

#: Multipliers from this on are written, up to this one (numerics: the check allows for what is left out; a face that
#: has no point with some signs would take any).
SMALLEST, LARGEST = 1e-9, 1e6


@dataclass(frozen=True, eq=False)
class ObserverError:
    """What is proved of an observer's error.

    Parameters
    ----------
    bounds : mapping of state → float, or None
        twist in rad, speed_motor and speed_load in rad/s: each error enters these bounds and stays.
    decay : float or None
        Outside, the error's measure (the factor by which the set must grow to hold it) decays at least at this rate,
        1/s.
    certificate : dict or None
        What ``verify_observer.py`` checks.
    reason : str
        Why nothing is proved.
    """

    bounds: Mapping[str, float] | None
    decay: float | None
    certificate: dict[str, Any] | None
    reason: str = ""


@dataclass(frozen=True, eq=False)
class ErrorModel:
    """ė = A e + Σ effect·w over the errors of twist, speed_motor, speed_load: the differences of gap and frictions.

    The gap's difference comes first where the drivetrain has one.
    """

    drivetrain: Drivetrain
    measured: tuple[str, ...]
    gain: Array
    injection: Mapping[str, float]
    A: Array
    differences: tuple[Difference, ...]


def error_model(
    drivetrain: Drivetrain,
    measured: Sequence[str] = ("speed_motor",),
    gain: ArrayLike | None = None,
    injection: Mapping[str, float] | None = None,
) -> ErrorModel:
    """The error of the observer with a gain (3, n_measured), by default ``kalman_gain``, and an injection.

    Raises
    ------
    InvalidInput
        For a drivetrain that has no Lur'e form or a torque lag, and for other sensors than ``SENSORS``.
    """
    plant_of(drivetrain)
    if drivetrain.lag:
        raise InvalidInput("observer_error: drivetrain", f"lag {drivetrain.lag} s", "no torque lag",
                           "Leave it out: an observer knows its torque, and the lag adds no error.")  # fmt: skip
    model = observer_model(drivetrain, measured)
    if not set(measured) <= set(SENSORS):
        raise InvalidInput("observer_error: measured", f"{measured}", f"out of {SENSORS}", "Leave it out.")
    measured = tuple(measured)
    known = np.asarray(kalman_gain(drivetrain, measured) if gain is None else gain, dtype=float)
    if known.shape != (3, len(measured)) or not np.all(np.isfinite(known)):
        raise InvalidInput(
            "observer_error: gain", f"{known.shape}", f"(3, {len(measured)}) numbers", "Check it."
        )
    c = np.array([model.measurement_row(signal) for signal in measured])
    seen = injection_of(model, measured, c, injection)
    differences = []
    if drivetrain.shaft.has_backlash:
        row, effect = model.contact_argument(), model.E_gap[:, 0]
        if seen is not None:
            # The drivetrain's gap has the same value at z + what is added: a measured torque has the sign of dz(z), and
            # all else is zero without error. So what is measured adds to both, and what is expected to one.
            row = row + seen.states
        if "torque_shaft" in measured:
            effect = effect + known[:, measured.index("torque_shaft")] * drivetrain.stiffness
        differences.append(Difference(row, effect, drivetrain.backlash, jumps=False))
    for friction, name, effect in zip(
        drivetrain.frictions, STATES[1:], (model.E_motor, model.E_load), strict=True
    ):
        if height := friction.coulomb_plus + friction.coulomb_minus:
            differences.append(Difference(model.row(**{name: 1.0}), effect[:, 0], height, jumps=True))
    return ErrorModel(
        drivetrain, measured, known, dict(injection or {}), model.A - known @ c, tuple(differences)
    )


@checks_arguments
def observer_error(
    drivetrain: Drivetrain,
    measured: Sequence[str] = ("speed_motor",),
    *,
    gain: ArrayLike | None = None,
    injection: Mapping[str, float] | None = None,
    faces: int = FACES,
) -> ObserverError:
    """The bound of an observer's error during every motion, with the whole gap and set-valued friction.

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses without torque lag; the observer knows its parameters exactly.
    measured : sequence of str
        Out of ``SENSORS``.
    gain : (3, n_measured) array, optional
        Of the continuous observer; default ``observers.kalman_gain``.
    injection : mapping of measured signal → κ, optional
        See ``observers.kalman``.
    faces : int
        Pairs of faces of the polytope.

    Raises
    ------
    InvalidInput
        As ``error_model``.
    """
    model = error_model(drivetrain, measured, gain, injection)
    rows = invariant_polytope(model.A, model.differences, faces) if model.differences else None
    if rows is None:
        return ObserverError(None, None, None, "no invariant polytope is found")
    rows = short(rows)
    bounds = {name: float(np.nextafter(1.0 / rows[i, i], np.inf)) for i, name in enumerate(STATES)}
    multipliers, decay = _multipliers(model, rows)
    if not decay > 0.0:
        return ObserverError(None, None, None, "the error leaves the polytope that was found")
    decay *= CLAIMED
    data = {
        "claim": {"bounds": bounds, "decay": decay},
        "drivetrain": drivetrain_data(drivetrain),
        "measured": list(model.measured), "gain": model.gain.tolist(), "injection": model.injection,
        "proof": {"faces": rows.tolist(), "multipliers": multipliers},
    }  # fmt: skip
    reason = observer_verdict(data)
    if reason is not None:
        return ObserverError(None, None, None, f"the exact check failed: {reason}")
    return ObserverError(bounds, decay, data)


@checks_arguments
def observer_verdict(data: Mapping[str, Any]) -> str | None:
    """None if the certificate is proved in exact fractions, else why not; the verifier's own word."""
    return word_of(verify_observer, data)


@checks_arguments
def observer_headline(proof: ObserverError) -> str:
    """One sentence that is read in ten seconds."""
    if proof.bounds is None:
        return f"No bound of the observer's error is proved: {proof.reason}."
    twist, motor, load = (proof.bounds[name] for name in STATES)
    return (
        f"Proved: whatever the drive does, the observer's errors come and stay within {1e3 * twist:.1f} mrad (twist), "
        f"{motor:.3g} rad/s (motor) and {load:.3g} rad/s (load), with the whole gap and friction, at the moment of "
        "contact too, while its parameters are right."
    )


def _multipliers(model: ErrorModel, rows: Array) -> tuple[list[list[dict[str, Any]]], float]:
    """Multipliers of equation 21 for each face and each choice of signs, and the decay that they prove.

    The dual linear program of the largest h·ė on the face: its value is a bound whatever the solver's accuracy.
    """
    from scipy.optimize import linprog

    sizes = np.concatenate([1.0 / np.diag(rows[:3]), [d.limit for d in model.differences]])
    rates = np.column_stack([model.A, *(d.effect for d in model.differences)])
    found: list[list[dict[str, Any]]] = []
    decay = np.inf
    for face in rows:
        of_face = []
        on_face = np.append(face, np.zeros(len(model.differences)))
        for signs in itertools.product((1, -1), repeat=len(model.differences)):
            a, b = _conditions(model.differences, rows, signs)
            columns = np.vstack([a, on_face]) * sizes
            done = linprog(
                np.append(b, 1.0), A_eq=columns.T, b_eq=(face @ rates) * sizes,
                bounds=[*[(0.0, LARGEST)] * len(b), (None, None)],
            )  # fmt: skip
            if done.status != 0:
                return [], -np.inf
            decay = min(decay, -float(done.fun))
            values = short(done.x)
            known = [[i, float(v)] for i, v in enumerate(values[:-1]) if v > SMALLEST]
            of_face.append({"face": float(values[-1]), "known": known})
        found.append(of_face)
    return found, decay


def _conditions(differences: Sequence[Difference], rows: Array, signs: Sequence[int]) -> tuple[Array, Array]:
    """(a, b) of all that is known: b − a·(e, w) ≥ 0, in the verifier's order."""
    nothing = np.zeros(3 + len(differences))
    a, b = [], []
    for place, (difference, sign) in enumerate(zip(differences, signs, strict=True)):
        argument, value = nothing.copy(), nothing.copy()
        argument[:3], value[3 + place] = difference.row, 1.0
        a += [-sign * value, sign * value, -sign * argument]
        b += [0.0, difference.limit, 0.0]
        if not difference.jumps:
            a.append(sign * (value - argument))
            b.append(0.0)
    faces = np.hstack([rows, np.zeros((len(rows), len(differences)))])
    return np.vstack([*a, faces, -faces]), np.append(b, np.ones(2 * len(rows)))
