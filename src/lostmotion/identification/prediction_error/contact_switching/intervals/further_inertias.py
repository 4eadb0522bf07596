"""What an inertia that the model does not have may change of the values, as far as the recording leaves it open."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from ....statistics.block_covariance import student_factor
from ...innovations import NAMES as TOLD
from ..estimate import beyond_chance, distance, shown_slopes
from ..filter import INDEX, ContactFilter, Run, pole_of
from ..likelihood import Box, Candidate, polish

Array = NDArray[np.float64]

#: An inertia that is not seen has its mode at the first of these multiples of the torsional frequency, or above
#: (calibrated on development drives 2050 to 2890, 2026-11-26). Its effect is computed at each (numerics: it goes with
#: the inverse square of the multiple; far off it is linear, near by it is well above what else changes).
HIDDEN_MODES = (8.0, 16.0, 32.0)
#: Parts of its side's inertia that it may have (numerics: a light one and a heavy one).
SHARES = (0.1, 0.5)
#: Damping ratio of its mode (numerics: it does not ring).
DAMPED = 0.5


def room_for_further_inertias(best: Candidate, box: Box) -> Array:
    """(8,) half widths, in the logarithm, for inertias that the model does not have.

    With a third inertia, a fourth one changes the values by as much for what is left of the innovations as the third
    did for what it took away, and by no more than that: it is taken out, and the others are fitted again. Without a
    third, see ``of_a_third``.
    """
    third = [INDEX[name] for name in ("share", "compliance", "loss")]
    if not np.isfinite(best.theta[third[0]]):
        return of_a_third(best)
    theta = best.flt.changed(best.theta, share=0.0, compliance=0.0, loss=0.0)
    free = [place for place in best.free if place not in third]
    without = polish(replace(best, theta=theta, free=free), replace(best.flt, behind=False), box)
    # Innovations of e^cost times the noise: both parts of their squares.
    left, taken = np.expm1(2.0 * abs(best.cost)), np.exp(2.0 * without.cost) - np.exp(2.0 * best.cost)
    part = np.sqrt(left / taken) if taken > left else 1.0
    return np.asarray(part * distance(without, best))


def of_a_third(best: Candidate) -> Array:
    """(8,) largest change of the values by a third inertia at either end, light or heavy.

    To first order, it adds ``part``·``effect`` to the innovations, where a part of 1 has its mode at the lowest of
    ``HIDDEN_MODES``. The other parameters make up for some of it; that changes their values. What is left shows how
    large the part is: a score test. Source: Rao (1948), Large sample tests of statistical hypotheses concerning
    several parameters, Mathematical Proceedings of the Cambridge Philosophical Society 44, section 2.
    """
    flt = best.flt
    run = flt.run(best.theta, best.free)
    jacobian, slopes = shown_slopes(best, run)
    if not jacobian.size:
        return np.zeros(len(TOLD))
    size = np.linalg.norm(jacobian, axis=1)
    basis, triangle = np.linalg.qr((jacobian / size[:, None]).T)
    width = student_factor(1) * beyond_chance(best) * np.sqrt(np.mean(run.weighted**2))
    largest = np.zeros(len(TOLD))
    for effect in _effects(best, run):
        made_up = basis.T @ effect
        left = effect - basis @ made_up
        with np.errstate(divide="ignore", invalid="ignore"):
            part = np.hypot(run.weighted @ left / (left @ left), width / np.linalg.norm(left))
        change = slopes @ (np.linalg.lstsq(triangle, made_up)[0] / size)
        largest = np.maximum(largest, np.fmin(part, 1.0) * np.abs(change))
    return largest


def _effects(best: Candidate, run: Run) -> Iterator[Array]:
    """Change of the weighted innovations by a third inertia of part 1, as each of its places and modes says."""
    n = run.rows.size
    for mode, share, behind in product(HIDDEN_MODES, SHARES, (False, True)):
        flt, theta = _with_a_stiff_third(best, mode, share, behind)
        other = flt.run(theta)
        effect = np.zeros(run.weighted.size)
        effect[:n] = other.weighted[:n] * other.deviations / run.deviations - run.weighted[:n]
        if np.all(np.isfinite(effect)):
            yield effect * (mode / HIDDEN_MODES[0]) ** 2


def _with_a_stiff_third(
    best: Candidate, mode: float, share: float, behind: bool
) -> tuple[ContactFilter, Array]:
    """Filter and θ with a third inertia whose mode is at a multiple of the torsional frequency."""
    values = dict(zip(INDEX, map(float, best.flt.values(best.theta)), strict=True))
    motor, load = values["inertia_motor"], values["inertia_load"]
    side = load if behind else motor
    # The mode of both parts of a side on a stiff shaft, over the torsional one.
    compliance = motor * load / (motor + load) / (share * (1.0 - share) * side * mode**2)
    damped = 2.0 * np.pi * mode * pole_of(best.theta) * values["damping"] / values["stiffness"]
    loss = 2.0 * DAMPED / damped if damped > 0.0 else 1.0
    flt = replace(best.flt, behind=behind)
    return flt, flt.changed(best.theta, share=share, compliance=compliance, loss=loss)
