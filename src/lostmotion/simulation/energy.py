"""Energies of a simulated plant: input, stored, dissipated, each integrated on its own from event to event."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..drivetrain import Shaft
from .contact_states import GAP, relaxes
from .tables import Mode, Plant

Array = NDArray[np.float64]

#: Points of the Gauss–Legendre rule in an interval: exact to rounding where the state's series converges fast
#: (numerics).
_POINTS = 8


def energies(
    plant: Plant, states: Array, modes: NDArray[np.int64], inputs: Array, events: Array
) -> dict[str, Array]:
    """``energy_input``, ``energy_stored`` and ``energy_dissipated`` at every sample, J, (n,) each.

    The time is cut at every sample and event. In each interval the state is a power series of known coefficients, the
    powers are products of two rows of it, which the Gauss rule integrates exactly to rounding. The springs of the
    viscoelastic law have a kink within a mode, so there the change of ½·k·dz(twist)² is taken from the work.

    Parameters
    ----------
    states : (n + 1, N), modes : (n + 1,), inputs : (n, M)
    events : (events, 6 + N)
        As the kernel leaves them.
    """
    n = inputs.shape[0]
    time = np.concatenate([np.arange(n, dtype=float), events[:, 0]])
    order = np.argsort(time, kind="stable")
    state = np.concatenate([states[:-1], events[:, 6:]])[order]
    mode = np.concatenate([modes[:-1], events[:, 5].astype(np.int64)])[order]
    sample = np.maximum.accumulate(np.where(order < n, order, 0))
    duration = np.diff(time[order], append=float(n)) * plant.dt
    work, loss = np.zeros(duration.size), np.zeros(duration.size)
    for number in np.unique(mode):
        rows = np.flatnonzero((mode == number) & (duration > 0.0))
        s = np.column_stack([state[rows], inputs[sample[rows]], np.ones(rows.size)])
        work[rows], loss[rows] = _interval_energies(plant, int(number), s, duration[rows])
    return {
        "energy_input": _running(work, sample, n),
        "energy_stored": _stored(plant, states[:-1]),
        "energy_dissipated": _running(loss, sample, n),
    }


def _running(amounts: Array, sample: NDArray[np.int64], n: int) -> Array:
    """Sum before each sample."""
    return np.concatenate([[0.0], np.cumsum(np.bincount(sample, amounts, minlength=n))[:-1]])


def _interval_energies(plant: Plant, number: int, s: Array, duration: Array) -> tuple[Array, Array]:
    """Input and dissipated energy of intervals of one mode that start at s (m, C) and last `duration` (m,), s."""
    mode = plant.modes[plant.row_of_mode[number]]
    given, lost, kinked = _powers(plant, mode)
    parts = max(1, math.ceil(float(np.max(duration, initial=0.0)) / mode.piece))
    coefficients, piece = mode.state_series, mode.piece
    points, weights = np.polynomial.legendre.leggauss(_POINTS)
    work, loss = np.zeros(duration.size), np.zeros(duration.size)
    length = duration / parts
    states = plant.layout.states
    for _ in range(parts):
        series = np.einsum("onc,mc->omn", coefficients, s)
        for point, weight in zip((points + 1.0) / 2.0, weights / 2.0, strict=True):
            at = _advance(s, series, point * length / piece, states)
            work += weight * length * _products(given, at)
            loss += weight * length * _products(lost, at)
        end = _advance(s, series, length / piece, states)
        for i, shaft in kinked:
            loss -= _spring(shaft, end[:, i]) - _spring(shaft, s[:, i])
        s = end
    return work, loss


def _advance(s: Array, series: Array, fraction: Array, states: int) -> Array:
    """s at a fraction (m,) of the sub-step of the Taylor series."""
    change = np.zeros_like(series[0])
    for term in series[::-1]:
        change = (change + term) * fraction[:, None]
    later = s.copy()
    later[:, :states] += change
    return later


def _products(pairs: list[tuple[Any, Any]], s: Array) -> Array:
    return np.sum([(s @ a) * (s @ b) for a, b in pairs], axis=0) if pairs else np.zeros(len(s))


def _powers(
    plant: Plant, mode: Mode
) -> tuple[list[tuple[Array, Array]], list[tuple[Array, Array]], list[tuple[int, Shaft]]]:
    """Pairs of rows whose products are the input's and the losses' powers; shafts with a kinked spring."""
    layout, drivetrain = plant.layout, plant.drivetrain
    digit = {(e.kind, e.index): d for e, d in zip(plant.elements, mode.digits, strict=True)}
    rest = {e.index: e.rest for e in plant.elements if e.kind == "friction"}
    unit = np.eye(layout.columns)
    given, lost, kinked = [], [], []
    for i in range(layout.n):
        speed = unit[layout.speed(i)]
        if i == drivetrain.locked_inertia:
            given.append((mode.external[i] - mode.driving_torque(i), speed))
            continue
        given.append((mode.external[i], speed))
        if i not in rest or digit["friction", i] != rest[i]:
            lost.append((mode.frictions[i], speed))
    for i, shaft in enumerate(drivetrain.shafts):
        rate, torque = unit[layout.speed(i)] - unit[layout.speed(i + 1)], mode.shaft_torques[i]
        if not shaft.has_backlash or shaft.contact == "dead_zone":
            lost.append((shaft.damping * rate, rate))
        elif relaxes(shaft) and digit["shaft", i] == GAP:
            angle = unit[layout.shaft_angle(i)]
            lost.append((shaft.stiffness**2 / shaft.damping * angle, angle))
        elif relaxes(shaft):
            lost.append((shaft.damping * rate, rate))
        elif shaft.contact == "viscoelastic":
            lost.append((torque, rate))
            kinked.append((layout.twist(i), shaft))
        elif digit["shaft", i] != GAP:
            lost.append((torque - mode.springs[i], rate))
    return given, lost, kinked


def _spring(shaft: Shaft, twist: Array) -> Array:
    half = 0.5 * shaft.backlash if shaft.has_backlash else 0.0
    return np.asarray(0.5 * shaft.stiffness * (twist - np.clip(twist, -half, half)) ** 2)


def _stored(plant: Plant, states: Array) -> Array:
    """Kinetic and elastic energy, a held end's left out; states (n, N)."""
    layout, drivetrain = plant.layout, plant.drivetrain
    total = np.zeros(len(states))
    for i, inertia in enumerate(drivetrain.inertias):
        if i != drivetrain.locked_inertia:
            total += 0.5 * inertia * states[:, layout.speed(i)] ** 2
    for i, shaft in enumerate(drivetrain.shafts):
        if relaxes(shaft):
            total += 0.5 * shaft.stiffness * states[:, layout.shaft_angle(i)] ** 2
        else:
            total += _spring(shaft, states[:, layout.twist(i)])
    return total
