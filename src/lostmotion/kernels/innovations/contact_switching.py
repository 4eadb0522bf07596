"""Innovations of a Kalman filter whose transition follows gap and friction, for identification.

One model for all: two to four masses, with or without a gap, motor and load friction, any sensors, an unknown load
torque. Between contacts the model is linear and its transition exact. Where a contact or a friction
changes within a sample, the change is sought in ever smaller parts, and the rest goes on in the new state. Where
the filter does not know on which side of an edge it is, the gap is taken as its mean over that spread (statistical
linearisation, Gelb 1974, Applied Optimal Estimation, chapter 6). No law tells an impact exactly: the speeds after it
may be off by a share of the approach. Innovations beyond what the filter thinks possible make its covariance grow: it
has lost the motion, and finds it again within a few samples.

Variances are in multiples of the first sensor's. Matrices lie column after column, columns are ``WIDE`` long.
"""

from __future__ import annotations

import math

import numpy as np

from ..jit import njit
from .changes import along_path, through_changes
from .channels import ANGLE_MOTOR, SPEED_LOAD, SPEED_MOTOR, TORQUE_SHAFT, TWIST
from .columns import COMPILED, INNER, NONE, WIDE, add, copy, product_of, turned_product
from .delayed_torque import delayed, torque_at_ends
from .gap_in_doubt import blend, mean_gap
from .holding import fill_loads, fill_resting, holds, stops
from .motion import (
    error_transition,
    moved,
    next_contact,
    reversed_motion,
    slopes_of_friction,
    stop_errors,
)
from .sample_parts import parts
from .sensitivities import COLUMNS, fill_changes, follow, slides
from .transitions import (
    BACKLASH,
    BLOCK,
    DAMPING,
    DEAD_ZONE,
    EDGE,
    HALF,
    KICKS,
    LEAD,
    NO_GAP,
    NUMBERS,
    OFFSET,
    PART,
    STIFFNESS,
    fill_changed_model,
    fill_model,
    fill_numbers,
    layout,
)

#: An edge is in doubt within so many standard deviations (numerics: beyond, the chance is a thousandth).
_DOUBT = 3.0
#: Innovations beyond so many standard deviations make the covariance grow, up to this factor over its start
#: (numerics).
_LOST, _MOST = 3.0, 1e6
#: Step of the differences in θ: far above rounding, far below any interval (numerics).
_STEP = 1e-6


@njit(**INNER)
def _changed(value, kind, unit, change, dt):
    """A parameter whose place in θ has changed: kind 0 logarithm, 1 logarithm of value + dt, 2 plain."""
    if kind == 0:
        return value * math.exp(change)
    if kind == 1:
        return (value + dt) * math.exp(change) - dt
    return value + unit * change


@njit(**COMPILED)
def _fill_at_rest(
    stuck, models, changes, filled, parameters, changed, free, dt, law, finest, kind, level, numbers, loads
):
    """The models in which motor, load or both rest all the while, and their changes, with those of what is stuck, if
    that has not happened before."""
    if filled[stuck]:
        return
    if not np.any(filled):
        fill_loads(parameters, dt, law, kind, loads)
    filled[stuck] = True
    models[stuck] = 0.0
    fill_resting(
        parameters, changed, free, dt, law, finest, kind, level, stuck, numbers, _STEP, models[stuck],
        changes[stuck],
    )  # fmt: skip


@njit(**INNER)
def _sensor_rows(q, sensors, counted, law, further, angle, tail, head, rows, offsets):
    """What each sensor shows of the state with the gap open and closed, and of the gap's edge."""
    for s in range(sensors.size):
        for closed in range(2):
            if sensors[s] == SPEED_MOTOR:
                rows[closed, s, angle if counted else 1] = 1.0
            elif sensors[s] == SPEED_LOAD:
                rows[closed, s, 2] = 1.0
            elif sensors[s] == ANGLE_MOTOR:
                rows[closed, s, angle] = 1.0
            elif sensors[s] == TWIST:
                rows[closed, s, 0] = 1.0
                for place in further:
                    if place > 0:
                        rows[closed, s, place] = 1.0
            elif closed == 1 or law == DEAD_ZONE:
                rows[closed, s, tail], rows[closed, s, head] = q[DAMPING], -q[DAMPING]
                rows[closed, s, 0] = q[STIFFNESS] if closed == 1 else 0.0
        offsets[s] = -q[STIFFNESS] if sensors[s] == TORQUE_SHAFT else 0.0


@njit(**INNER)
def _start(further, unknown, slope_at, angle, spread, p):
    """Covariance p of a motion of which nothing is known but its size, see ``innovations``."""
    p[:] = 0.0
    p[0] = spread[0] ** 2
    p[WIDE + 1] = p[2 * WIDE + 2] = spread[1] ** 2
    for place in further:
        if place > 0:
            p[place * WIDE + place], p[(place + 1) * WIDE + place + 1] = spread[0] ** 2, spread[1] ** 2
    if unknown > 0:
        p[unknown * WIDE + unknown] = spread[2] ** 2
    if slope_at > 0:
        p[slope_at * WIDE + slope_at] = spread[3] ** 2
    if angle > 0:
        p[angle * WIDE + angle] = 1.0


@njit(**COMPILED)
def innovations(
    parameters, free, kinds, units, dt, law, finest, ramp, behind, drifts, sensors, counted, ratios, bounds, torque,
    measured, level, spread, residuals, variances, jacobian,
):  # fmt: skip
    """One pass of the filter over a recording, with the sensitivities to some parameters.

    Parameters
    ----------
    parameters : (26,) array
        See ``transitions``.
    free, kinds : (m,) int arrays
        Places of the parameters whose sensitivities are wanted, and how they enter θ, see ``_changed``.
    units : (m,) array
        Of the plain ones.
    dt : float, s
    law, finest : int
        Contact law; a sample is halved so often at most.
    ramp : bool
        Whether the torque goes straight from row to row, as a measured one does; else it is held.
    behind : int
        Bits of the masses that are part of the load and sit behind the gap: 1 the third, 2 the fourth. Others are part
        of the motor and sit before it.
    drifts : bool
        Whether the unknown load torque is smooth: its slope changes at random, else itself.
    sensors : (s,) int array
        SPEED_MOTOR first.
    counted : bool
        The motor speed is the difference of counts: its column of ``measured`` is the angle.
    ratios : (s,) array
        Variance of each sensor over that of the first.
    bounds : (p + 1,) int array
        First row of each piece, each with its own start, and the number of rows.
    torque, measured : (n,) and (n, s) arrays
    level : float
        Standard deviation of the first sensor, rad or rad/s.
    spread : (4,) tuple
        Standard deviation at the start of a piece of twist (rad), speeds (rad/s), load torque (Nm) and its slope
        (Nm/s), over ``level``.
    residuals, variances : (n, s) arrays
        Filled with the innovations, and with their variances over that of the first sensor.
    jacobian : (m, n, s) array
        Filled with the change of the innovations with θ, the gains as they are.

    Returns
    -------
    int
        Parts of samples in which a contact or a friction changed: what makes one pass longer than another.
    """
    m, angled = free.size, counted
    for s in range(sensors.size):
        angled = angled or sensors[s] == ANGLE_MOTOR
    third, fourth, unknown, slope_at, angle, tail, head, n, nc = layout(parameters, angled, behind, drifts)
    further, ends, kind = (third, fourth), (tail, head), (ramp, behind, drifts, counted, angled)
    gap_law = law if parameters[BACKLASH] > 0.0 else NO_GAP
    square, whole = WIDE * WIDE, parts(finest) * BLOCK
    # One for each that may rest all the while: none, motor, load, both; these are filled when that first happens.
    models, numbers = np.empty((4, m + 1, 2 * whole)), np.zeros((m + 1, NUMBERS))
    models[0] = 0.0
    noise, errors = np.zeros(2 * square), np.zeros(2 * square)
    rows, offsets = np.zeros((2, sensors.size, WIDE)), np.zeros(sensors.size)
    fill_model(parameters, dt, law, finest, kind, level, models[0, 0], numbers[0], noise)
    changed = np.zeros((m, parameters.size))
    for j in range(m):
        changed[j] = parameters
        changed[j, free[j]] = _changed(parameters[free[j]], kinds[j], units[j], _STEP, dt)
        fill_changed_model(free[j], changed[j], dt, law, finest, kind, level, NONE, models[0], j + 1)
        fill_numbers(changed[j], dt, law, behind, level, numbers[j + 1])
    _sensor_rows(parameters, sensors, counted, law, further, angle, tail, head, rows, offsets)
    for which in range(2):
        error_transition(models.reshape(-1), which * whole, n, 0, (0.0, 0.0), errors, which * square)
    t, c, model, at_rest = models.reshape(-1), numbers.reshape(-1), 2 * whole, (m + 1) * 2 * whole
    lead, half = c[LEAD], c[HALF]
    changes, what = np.empty((4, m, 2 * BLOCK)), np.zeros(m, dtype=np.int64)
    fill_changes(models[0], numbers, whole, _STEP, changes[0], what)
    change = changes.reshape(-1)
    room = (np.zeros(COLUMNS), np.zeros(COLUMNS), np.zeros(COLUMNS), np.zeros(WIDE))
    x, y, old, gain = np.zeros(WIDE), np.zeros(WIDE), np.zeros(WIDE), np.zeros(WIDE)
    p, f, work, mixed = np.zeros(square), np.zeros(square), np.zeros(square + WIDE), np.zeros(BLOCK)
    # Sensitivities of the state to θ, column after column, and where they go.
    slope, next_slope = np.zeros(m * WIDE), np.zeros(m * WIDE)
    path, steps = np.zeros((1 << finest, 4), dtype=np.int64), 0
    loads, filled = np.zeros((3, 2, 2, 2, COLUMNS)), np.zeros(4, dtype=np.bool_)
    piece, contact, rest, base, weight, taken = -1, NONE, NONE, 0.0, 0.0, 0
    for k in range(torque.size):
        if k == bounds[piece + 1]:
            piece += 1
            contact, rest = 1 if gap_law == NO_GAP else 0, NONE
            x[:] = 0.0
            slope[:] = 0.0
            end = bounds[piece + 1] - 1
            x[1] = (measured[min(k + 1, end), 0] - measured[k, 0]) / dt if counted else measured[k, 0]
            x[2] = x[1]
            x[n - 1] = torque[k] + c[OFFSET]
            for place in further:
                if place > 0:
                    x[place + 1] = x[1]
            _start(further, unknown, slope_at, angle, spread, p)
            base = measured[k, 0] if counted else 0.0
        elif counted:
            # The angle is that since the last count: a small number, whose differences are fine.
            x[angle] -= measured[k, 0] - base
            base = measured[k, 0]
        # What grew far may lose its digits in a correction, and with them all sense.
        least = 0.0
        for i in range(nc):
            least = min(least, p[i * WIDE + i])
        if least < 0.0:
            _start(further, unknown, slope_at, angle, spread, p)
        closed = 1 if contact != 0 else 0
        for s in range(sensors.size):
            e = measured[k, s] - offsets[s] * contact * half
            if angle > 0 and (sensors[s] == ANGLE_MOTOR or sensors[s] == SPEED_MOTOR):
                e -= base
            for i in range(WIDE):
                gain[i] = 0.0
            for j in range(nc):
                row = rows[closed, s, j]
                if row != 0.0:
                    e -= row * x[j]
                    add(p, j * WIDE, row, gain, 0)
            variance = ratios[s]
            for i in range(nc):
                variance += gain[i] * rows[closed, s, i]
            wanted = (e / (_LOST * level)) ** 2
            if wanted > variance:
                growth = (wanted - ratios[s]) / max(variance - ratios[s], 1e-12)
                # Far beyond what a start knows of twist and load nothing but rounding is left.
                known = max(p[0] / spread[0] ** 2, p[2 * WIDE + 2] / spread[1] ** 2, 1e-300)
                growth = min(growth, max(_MOST / known, 1.0))
                variance = ratios[s] + growth * (variance - ratios[s])
                for i in range(WIDE):
                    gain[i] *= growth
                for i in range(nc * WIDE):
                    p[i] *= growth
                if s == 0 and variance < wanted:
                    # The motor sticks for the filter, but moves: its motion starts anew from what is measured.
                    missing, where = wanted - variance, angle if counted else 1
                    p[where * WIDE + where] += missing
                    gain[where] += missing
                    if counted:
                        p[WIDE + 1] += missing / (dt * dt)
                    variance = wanted
            residuals[k, s], variances[k, s] = e, variance
            per = 1.0 / variance
            for j in range(nc):
                add(gain, 0, -gain[j] * per, p, j * WIDE)
                x[j] += gain[j] * per * e
            for j in range(m):
                total = 0.0
                for i in range(nc):
                    total += rows[closed, s, i] * slope[j * WIDE + i]
                jacobian[j, k, s] = -total
                add(gain, 0, -total * per, slope, j * WIDE)
        copy(x, old)
        u, jump = delayed(torque, k, c, 0, ramp)
        rate = x[tail] - x[head]
        z = x[0] + lead * rate
        # In doubt about the contact: an edge is within the filter's uncertainty, and that is more than the way of a
        # sample.
        doubt, extra, travel = 0.0, 0.0, 0.5 * rate * dt
        if gap_law != NO_GAP:
            a, b = tail * WIDE, head * WIDE
            variance = (
                p[0]
                + 2.0 * lead * (p[a] - p[b])
                + lead * lead * (p[a + tail] + p[b + head] - 2.0 * p[a + head])
            )
            doubt = level * math.sqrt(max(variance, 0.0))
            if doubt <= abs(travel) or abs(abs(z) - half) >= _DOUBT * doubt + abs(travel):
                doubt = 0.0
        before, rested, quiet, at, slopes, stuck = contact, rest, False, closed * whole, (0.0, 0.0), NONE
        if doubt > 0.0:
            weight, edge, extra = mean_gap(z + travel, half, doubt)
            blend(t, 0, whole, weight, mixed)
            rest = moved(mixed, 0, c, 0, n, x, u, jump, edge, 0, y)
            slopes = slopes_of_friction(c, 0, x, y)
            copy(y, x)
            z = x[0] + lead * (x[tail] - x[head])
            contact = 1 if z > half else -1 if z < -half else 0
            error_transition(mixed, 0, n, rest, slopes, f, 0)
        else:
            if rest != 0 and stops(t, at, c, rest, x):
                _fill_at_rest(
                    rest, models, changes, filled, parameters, changed, free, dt, law, finest, kind, level, numbers,
                    loads,
                )  # fmt: skip
                stuck = rest
                at += stuck * at_rest
                for end in range(2):
                    if stuck & (1 << end):
                        x[1 + end] = 0.0
            moved_to = moved(t, at, c, 0, n, x, u, jump, contact * half, stuck, y)
            z = y[0] + lead * (y[tail] - y[head])
            quiet = next_contact(contact, z, y[0], half, gap_law) == contact and not reversed_motion(
                c, 0, x, y
            )
            quiet = quiet and moved_to == rested == stuck
            if quiet and stuck != 0:
                first, last = torque_at_ends(u, jump, c[PART], ramp)
                if ramp:
                    quiet = holds(loads, closed, stuck, c, x, first, y, last, contact * half, 1.0)
                else:  # the torque steps somewhere between
                    quiet = holds(loads, closed, stuck, c, x, first, y, first, contact * half, 1.0)
                    quiet = quiet and holds(loads, closed, stuck, c, x, last, y, last, contact * half, 1.0)
            if stuck != 0:
                copy(x, old)
            if quiet:
                rest, slopes = moved_to, slopes_of_friction(c, 0, x, y)
                copy(y, x)
            else:
                lacking, begun = NONE, stuck
                stuck, at = NONE, closed * whole
                while True:
                    if lacking != 0:
                        _fill_at_rest(
                            lacking, models, changes, filled, parameters, changed, free, dt, law, finest, kind, level,
                            numbers, loads,
                        )  # fmt: skip
                    copy(old, x)
                    contact, rest, weight, steps, lacking = through_changes(
                        t, filled, at_rest, c, loads, finest, ramp, n, ends, gap_law, u,
                        jump, before, begun, x, y, f, work, path,
                    )  # fmt: skip
                    if lacking == 0:
                        break
                taken += steps
        if quiet and stuck == 0 and slopes[0] == 0.0 and slopes[1] == 0.0:
            where = closed * square
            product_of(errors, where, n, slope, m, next_slope)
            product_of(errors, where, nc, p, nc, work)
            turned_product(work, errors, where, nc, noise, closed, p)
        else:
            if quiet:
                weight = closed
                error_transition(t, at, n, 0, slopes, f, 0)
                stop_errors(stuck, f)
            product_of(f, 0, n, slope, m, next_slope)
            product_of(f, 0, nc, p, nc, work)
            turned_product(work, f, 0, nc, noise, 1 if weight > 0.5 else 0, p)
            if doubt > 0.0:
                at_edge = whole + EDGE * WIDE
                for i in range(nc):
                    add(t, at_edge, extra / (level * level) * t[at_edge + i], p, i * WIDE)
        if contact != before:
            kick, back = c[KICKS] * rate, c[KICKS + 1] * rate
            p[tail * WIDE + tail] += kick * kick
            p[head * WIDE + head] += back * back
            p[tail * WIDE + head] += kick * back
            p[head * WIDE + tail] += kick * back
        # How the parameters move the state within this sample.
        if m > 0 and (quiet or doubt > 0.0) and slides(old, x, stuck):
            if quiet:
                weight, edge = float(closed), before * half
                for i in range(BLOCK):
                    mixed[i] = t[at + i]
            follow(
                t, whole, mixed, c, change, stuck * m, what, n, torque, k, ramp, old, stuck, u, jump, edge, weight,
                before, (doubt, rate, travel), _STEP, room, next_slope,
            )  # fmt: skip
            for i in range(m * WIDE):
                slope[i] = next_slope[i]
            continue
        # Where something changes, by differences.
        for j in range(m):
            begin, of = (j + 1) * model, (j + 1) * NUMBERS
            u, jump = delayed(torque, k, c, of, ramp)
            if quiet:
                moved(t, begin + at, c, of, n, old, u, jump, before * c[of + HALF], stuck, y)
            elif doubt > 0.0:
                weight, edge, _ = mean_gap(old[0] + c[of + LEAD] * rate + travel, c[of + HALF], doubt)
                blend(t, begin, begin + whole, weight, mixed)
                moved(mixed, 0, c, of, n, old, u, jump, edge, 0, y)
            else:
                copy(old, gain)
                along_path(
                    t, begin, at_rest, c, of, finest, ramp, n, ends, gap_law, u,
                    jump, before, path, steps, gain, y,
                )  # fmt: skip
                copy(gain, y)
            for i in range(WIDE):
                y[i] -= x[i]
            add(y, 0, 1.0 / _STEP, next_slope, j * WIDE)
        for i in range(m * WIDE):
            slope[i] = next_slope[i]
    return taken
