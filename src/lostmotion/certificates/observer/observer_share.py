"""The largest share of the gap's slope up to which an observer's error is proved to go to zero, and the κ for it.

At the whole slope no observer on the motor's side has such a proof, since the twist acts on nothing within the gap:
the share compares gains and injections with each other, and with the literature. It is no bound: that is
``error_bound``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ..certificate import short
from ..rational import Matrix, is_positive_definite, rational
from ..scaling import power_of_two
from ..semidefinite import Inequalities, Layout, Unknowns
from .error_bound import STATES, ErrorModel, error_model

Array = NDArray[np.float64]

#: Halvings of the interval in which the share lies (numerics: it is found to 1e-4).
HALVINGS = 13

#: κ that are tried, as shares of the largest, and halvings of the interval around the best (numerics).
TRIED, REFINED = 16, 5


class BestInjection(NamedTuple):
    """κ of one signal, rad per unit of it, and the share that it proves; ``without`` is the share without it."""

    factor: float
    share: float
    without: float


@checks_arguments
def observer_share(
    drivetrain: Drivetrain,
    measured: Sequence[str] = ("speed_motor",),
    *,
    gain: ArrayLike | None = None,
    injection: Mapping[str, float] | None = None,
) -> float:
    """The largest share, 0 to 1, of the gap's slope for which the circle criterion proves the error to vanish.

    V = eᵀPe falls during every motion, with set-valued friction; the last P is checked in exact fractions. 0: nothing
    is proved. Arguments as for ``observer_error``.

    Raises
    ------
    InvalidInput
        As ``observer_error``, and for a drivetrain without backlash.
    """
    model = error_model(drivetrain, measured, gain, injection)
    if not drivetrain.shaft.has_backlash:
        raise InvalidInput(
            "observer_share: drivetrain", "no backlash", "a gap", "Without a gap the error is linear."
        )
    low, high = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _vanishes(model, middle) else (low, middle)
    # The slope by which the observer's gap answers is larger where it sees the torque that it acts on.
    seen = model.injection.get("torque_shaft", 0.0) * drivetrain.stiffness
    return low / (1.0 - seen + low * seen)


@checks_arguments
def best_injection(
    drivetrain: Drivetrain,
    measured: Sequence[str] = ("speed_motor",),
    *,
    signal: str = "speed_motor",
    largest: float,
    gain: ArrayLike | None = None,
) -> BestInjection:
    """The κ of a measured signal, up to ``largest`` (rad per unit of it), that proves the largest share.

    With the gain left as it is, nothing is lost while the gap stays closed or open; of equal shares the smallest κ is
    taken, since the signal's noise enters through it where contact changes.
    """

    if not 0.0 < largest < np.inf:
        raise InvalidInput(
            "best_injection.largest", repr(largest), "a finite κ above 0", "1e-3 s for a speed."
        )
    if signal not in measured:
        raise InvalidInput("best_injection.signal", repr(signal), f"out of {measured}", "Measure it.")

    def share(factor: float) -> float:
        return observer_share(drivetrain, measured, gain=gain, injection={signal: factor})

    factors = largest * np.arange(TRIED + 1) / TRIED
    found = {float(factor): share(float(factor)) for factor in factors}
    width = largest / TRIED
    for _ in range(REFINED):
        width *= 0.5
        best = _best(found)
        for factor in (best - width, best + width):
            if 0.0 <= factor <= largest:
                found[factor] = share(factor)
    best = _best(found)
    return BestInjection(best, found[best], found[0.0])


def _best(found: Mapping[float, float]) -> float:
    return min(found, key=lambda factor: (-found[factor], factor))


def _vanishes(model: ErrorModel, share: float) -> bool:
    """Whether V proves it: P ≻ 0 and −V̇ minus the multiplier times w(share·z − w) ≻ 0, in fractions."""
    if np.max(np.linalg.eigvals(model.A).real) >= 0.0:
        return False
    gap = model.differences[0]
    blocks = _blocks(model)
    flow = np.column_stack([model.A, gap.effect])
    layout = Layout({f"P{i}": len(block) for i, block in enumerate(blocks)}, {"gap": 1})

    def conditions(unknowns: Unknowns) -> Sequence[Matrix]:
        exact = unknowns["gap"].dtype == object
        rates, argument = (rational(x) if exact else x for x in (flow, share * gap.row))
        p = 0 * rates[:, :3]
        for i, block in enumerate(blocks):
            p[np.ix_(block, block)] = unknowns[f"P{i}"]
        form = 0 * rates[[0, 0, 0, 0]]  # over (e, w)
        form[:3] = -p @ rates
        form[3] = unknowns["gap"][0] * np.append(-argument, 1)
        return [p, form + form.T]

    sizes = power_of_two(np.append(_sizes(model), gap.limit))
    found = Inequalities(conditions, layout, [sizes[:3], sizes]).largest_margin()
    if found is None or not found[1] > 0.0:
        return False
    unknowns = {name: rational(short(value)) for name, value in found[0].items()}
    return all(is_positive_definite(matrix) for matrix in conditions(unknowns))


def _blocks(model: ErrorModel) -> list[list[int]]:
    """Blocks of P: friction's part of V̇, 2eᵀPE w, is −w·speed times a positive number if its speed is alone in P."""
    alone = [
        STATES.index(name) for name in STATES for d in model.differences[1:] if d.row[STATES.index(name)]
    ]
    together = [i for i in range(3) if i not in alone]
    return [together, *([i] for i in alone)]


def _sizes(model: ErrorModel) -> Array:
    """Typical sizes of the states: how far the differences drive them, as white noise."""
    from scipy.linalg import solve_continuous_lyapunov

    driven = np.column_stack([d.effect * d.limit for d in model.differences])
    return np.asarray(np.sqrt(np.diag(solve_continuous_lyapunov(model.A, -driven @ driven.T))))
