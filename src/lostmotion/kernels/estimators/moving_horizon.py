"""Moving-horizon estimator over a piecewise-linear model: one step.

The cost over the horizon — distance from the arrival estimate, from the model, from the measurements, each in its own
standard deviations — is minimised by Gauss–Newton: modes and slopes are taken along the trajectory of the last pass,
and the linear problem that remains is solved exactly by a Kalman filter forwards and its adjoint backwards. So a later
sample revises which contact an earlier one was in.

States: those of ``parameter_tracking``.
"""

from __future__ import annotations

import math

import numpy as np
from numba import njit

from .extended_kalman import jacobian, propagate
from .parameter_tracking import (
    BACKLASH,
    BEFORE,
    BLIND,
    COULOMB,
    COVARIANCE,
    EASE_LOAD,
    EASE_MOTOR,
    FACTOR,
    FRICTION,
    LARGEST_FACTOR,
    LEAST_FACTOR,
    LOAD_TORQUE,
    MOVING,
    SENSOR_MEMORY,
    SIZE,
    STARTED,
    N,
    along,
    begin,
    bound,
    correct,
    moved,
    new_state,
    recover,
    restart,
    row,
    spread,
    write,
)  # fmt: skip
from .runner import INIT, STEP
from .two_mass_model import (
    ANGLE,
    AVERAGED,
    DOUBT,
    DT,
    FROZEN,
    JUMP,
    KIND,
    LEAD_MIDDLE,
    MEMORY,
    N_SENSORS,
    OWN,
    PIECES,
    SCALE,
    SPEED_LOAD,
    SPEED_MOTOR,
    START_AGAIN,
    USE,
    advance,
    clip,
    doubt,
    doubt_torque,
    mean_gap,
    next_count,
    sensor_believed,
    sensor_variance,
)  # fmt: skip

# Own parameters: nodes of the horizon, passes.
NODES, PASSES = OWN, OWN + 1

# Places in the state after that of the tracking filters, which holds the newest estimate: number of nodes in use, the
# arrival estimate and covariance, then the nodes.
COUNT = SIZE
ARRIVAL = SIZE + 1
FIRST_NODE = ARRIVAL + N + N * N
# A node: trajectory, torque, measurements, 1 where one is believed, 1 if the torque was missing, ``blind_samples``.
NODE_TORQUE, NODE_VALUE, NODE_BELIEVED, NODE_GUESSED, NODE_BLIND = N, N + 1, N + 5, N + 9, N + 10
NODE = N + 11


@njit(INIT, cache=True)
def init(p):
    state = np.zeros(FIRST_NODE + int(p[NODES]) * NODE)
    state[:SIZE] = new_state(p)
    return state


@njit(cache=True)
def _move(p, w, x, torque, f):
    """Model over a piece of a sample from x (N,), in place; its derivatives go to f (5, N); returns the friction.

    The gap enters by its mean over the spread of the estimate w, as in the extended Kalman filter: with a sharp edge a
    backlash that is far too large keeps the trajectory inside for ever.
    """
    coulomb = max(x[COULOMB], 0.0)
    z = x[0] + p[LEAD_MIDDLE] * (x[1] - x[2])
    gap, above, below = mean_gap(z, 0.5 * max(x[BACKLASH], 0.0), spread(w, p[LEAD_MIDDLE]))
    n0, n1, n2, n3, turn, motor, load = advance(
        p,
        x[0],
        x[1],
        x[2],
        x[3],
        x[LOAD_TORQUE],
        coulomb,
        gap,
        torque,
        x[FACTOR],
        x[EASE_MOTOR],
        x[EASE_LOAD],
    )
    jacobian(p, x, gap, 1.0 - above - below, above - below, (n1 - x[1], n2 - x[2]), motor, load, f)
    x[0], x[1], x[2], x[3] = n0, n1, n2, n3
    x[ANGLE] += turn * p[AVERAGED]
    return load / x[EASE_LOAD]


@njit(cache=True)
def _count(p, s, at, w):
    """The estimate w, before the node's trajectory at s[at …] moves on: its angle from the node's count on."""
    if p[AVERAGED]:
        i = _counter(p)
        error = sensor_variance(p, s, SENSOR_MEMORY + MEMORY * i, i)
        next_count(p, i, w, 0, COVARIANCE, N, s[at + NODE_VALUE + i], error, s[at + NODE_BELIEVED + i] != 0.0)


@njit(cache=True)
def _counter(p):
    """Which sensor is the motor's."""
    i = 0
    while p[KIND + i] != SPEED_MOTOR:
        i += 1
    return i


@njit(cache=True)
def _chained(slope, f, work):
    """slope (5, N) of the pieces so far, followed by a piece with f."""
    for i in range(MOVING):
        for j in range(N):
            total = f[i, j] if j >= LOAD_TORQUE else 0.0
            for k in range(MOVING):
                total += f[i, k] * slope[k, j]
            work[i, j] = total
    slope[:] = work


@njit(cache=True)
def _advance_estimate(p, w, s, at, torque, slope, f, work, two):
    """The estimate w a sample on, along the node's trajectory at s[at …]; the sample's derivatives to slope."""
    x, apart = two[0], two[1]
    keeps = 1.0
    for j in range(N):
        x[j] = s[at + j]
    if p[AVERAGED]:
        i = _counter(p)
        keeps = s[at + NODE_BELIEVED + i]
        x[ANGLE] = keeps * (x[ANGLE] - s[at + NODE_VALUE + i] * p[SCALE + i])
    _count(p, s, at, w)
    for j in range(N):
        apart[j] = w[j] - x[j]
    for piece in range(int(p[PIECES])):
        _move(p, w, x, torque, f)
        propagate(p, w, f, work)
        if piece == 0:
            slope[:] = f
        else:
            _chained(slope, f, work)
    for i in range(MOVING):
        w[i] = x[i]
        for j in range(N):
            w[i] += slope[i, j] * apart[j]
    slope[ANGLE, ANGLE] = keeps


@njit(cache=True)
def _doubt_torque(p, w, s, at):
    """The covariance of the estimate w at the node, where the torque or all may have been missing."""
    doubt_torque(p, w, COVARIANCE, N, s[at + NODE_GUESSED] != 0.0, s[at + NODE_BLIND])


@njit(cache=True)
def _use(p, w, s, at, i, h, gain):
    """Sensor i of the node at ``at`` into w; returns innovation over variance (0: not believed), variance."""
    if s[at + NODE_BELIEVED + i] == 0.0:
        return 0.0, 1.0
    innovation = s[at + NODE_VALUE + i] * p[SCALE + i] - row(p, w, int(p[KIND + i]), h)
    variance = sensor_variance(p, s, SENSOR_MEMORY + MEMORY * i, i) + along(w, h, gain)
    if not variance > 0.0:  # the covariance has lost its meaning to rounding
        gain[:] = 0.0
        return 0.0, 1.0
    correct(w, innovation, variance, gain)
    return innovation / variance, variance


@njit(cache=True)
def _backwards(s, count, sensors, known, slopes, rows, gains, scaled):
    """Adjoint pass: the trajectory of every node from all samples of the horizon."""
    r, turned = np.zeros(N), np.zeros(N)
    for n in range(count - 1, -1, -1):
        at = FIRST_NODE + n * NODE
        if n < count - 1:
            for j in range(N):
                turned[j] = r[j] if j >= LOAD_TORQUE else 0.0
                for i in range(MOVING):
                    turned[j] += slopes[n, i, j] * r[i]
            r[:] = turned
        for i in range(sensors - 1, -1, -1):
            along = scaled[n, i]
            for j in range(N):
                along -= gains[n, i, j] * r[j]
            for j in range(N):
                r[j] += rows[n, i, j] * along
        for j in range(N):
            total = known[n, j]
            for k in range(N):
                total += known[n, COVARIANCE + j * N + k] * r[k]
            s[at + j] = clip(total, LEAST_FACTOR, LARGEST_FACTOR) if j >= FACTOR else total


@njit(cache=True)
def _solve(p, s, count, w, f, work, two):
    """One Gauss–Newton pass; w ends as the newest estimate."""
    sensors = int(p[N_SENSORS])
    known = np.empty((count, N + N * N))
    slopes = np.empty((count, MOVING, N))
    rows, gains = np.zeros((count, sensors, N)), np.zeros((count, sensors, N))
    scaled = np.zeros((count, sensors))
    for j in range(N + N * N):
        w[j] = s[ARRIVAL + j]
    for n in range(count):
        at = FIRST_NODE + n * NODE
        _doubt_torque(p, w, s, at)
        for j in range(N + N * N):
            known[n, j] = w[j]
        for i in range(sensors):
            scaled[n, i], variance = _use(p, w, s, at, i, rows[n, i], gains[n, i])
            for j in range(N):
                gains[n, i, j] /= variance
        if n < count - 1:
            _advance_estimate(p, w, s, at, s[at + NODE_TORQUE], slopes[n], f, work, two)
    _backwards(s, count, sensors, known, slopes, rows, gains, scaled)


@njit(cache=True)
def _forget_oldest(p, s, w, slope, f, work, two):
    """The arrival estimate one sample on, and every node one place down."""
    for j in range(N + N * N):
        w[j] = s[ARRIVAL + j]
    _doubt_torque(p, w, s, FIRST_NODE)
    for i in range(int(p[N_SENSORS])):
        _use(p, w, s, FIRST_NODE, i, work[0], work[1])
    _advance_estimate(p, w, s, FIRST_NODE, s[FIRST_NODE + NODE_TORQUE], slope, f, work, two)
    for j in range(N + N * N):
        s[ARRIVAL + j] = w[j]
    for j in range(FIRST_NODE, FIRST_NODE + (int(s[COUNT]) - 1) * NODE):
        s[j] = s[j + NODE]


@njit(cache=True)
def _disbelieve(s, i, repeats):
    """A frozen sensor: the earlier samples of the same value, still in the horizon, are not believed any more."""
    for n in range(int(s[COUNT]) - repeats, int(s[COUNT])):
        s[FIRST_NODE + n * NODE + NODE_BELIEVED + i] = 0.0


@njit(cache=True)
def _append(p, s, inputs, torque, faults, h, scratch):
    """A new node from the newest prediction; returns the faults and whether to start again."""
    count = int(s[COUNT])
    at = FIRST_NODE + count * NODE
    again = False
    for j in range(N):
        s[at + j] = s[j]
    s[at + NODE_TORQUE] = torque
    s[at + NODE_GUESSED], s[at + NODE_BLIND] = float(faults & 1), s[BLIND]
    given = faults
    for i in range(int(p[N_SENSORS])):
        kind = int(p[KIND + i])
        innovation = inputs[1 + i] * p[SCALE + i] - row(p, s, kind, h)
        variance = sensor_variance(p, s, SENSOR_MEMORY + MEMORY * i, i) + along(s, h, scratch)
        verdict = sensor_believed(
            p, s, SENSOR_MEMORY + MEMORY * i, i, inputs[1 + i], given & (2 << i) != 0, moved(p, s, kind), innovation,
            variance,
        )  # fmt: skip
        s[at + NODE_VALUE + i] = inputs[1 + i]
        s[at + NODE_BELIEVED + i] = 1.0 if verdict == USE else 0.0
        if verdict != USE:
            faults |= 2 << i
            if verdict == FROZEN:
                _disbelieve(s, i, min(int(s[SENSOR_MEMORY + MEMORY * i + 1]) - 1, count))
        if verdict == JUMP:
            doubt(p, s, ARRIVAL + N, N, LOAD_TORQUE, math.exp(DOUBT * p[DT]))
        if verdict == START_AGAIN:
            restart(p, s, inputs[1 + i] if kind <= SPEED_LOAD else s[1], LOAD_TORQUE)
            again = True
    return faults, again


@njit(cache=True)
def _begin_horizon(s):
    """The horizon begins at the newest estimate."""
    s[COUNT] = 0.0
    for j in range(N + N * N):
        s[ARRIVAL + j] = s[j]


@njit(cache=True)
def _recover(p, s):
    """Start again if the estimate or anything in the horizon is lost."""
    total = 0.0
    for j in range(COUNT, s.size):
        total += s[j]
    if not math.isfinite(total):
        s[0] = math.nan
    recover(p, s)
    if s[STARTED] == 0.0:
        for j in range(COUNT, FIRST_NODE + int(p[NODES]) * NODE):
            s[j] = 0.0


@njit(STEP, cache=True)
def step(p, s, inputs, faults, outputs):
    w, two = np.empty(N + N * N), np.empty((2, N))
    slope, f, work = np.empty((MOVING, N)), np.empty((MOVING, N)), np.empty((MOVING, N))
    fresh = s[STARTED] == 0.0
    torque, faults = begin(p, s, inputs, faults)
    if fresh:
        _begin_horizon(s)
    if s[COUNT] >= p[NODES]:
        _forget_oldest(p, s, w, slope, f, work, two)
        s[COUNT] -= 1.0
    faults, again = _append(p, s, inputs, torque, faults, work[0], work[1])
    if again:
        _begin_horizon(s)
    else:
        s[COUNT] += 1.0
        for _ in range(int(p[PASSES])):
            _solve(p, s, int(s[COUNT]), w, f, work, two)
        for j in range(N + N * N):
            s[j] = w[j]
        bound(p, s)
    _recover(p, s)
    write(p, s, work[0], work[1], outputs)
    for i in range(4):
        s[BEFORE + i] = s[i]
    if s[COUNT] > 0.0:
        _count(p, s, FIRST_NODE + (int(s[COUNT]) - 1) * NODE, s)
    for _ in range(int(p[PIECES])):
        s[FRICTION] = _move(p, s, s, torque, f)
        propagate(p, s, f, work)
    if again:
        _begin_horizon(s)
    _recover(p, s)
    return faults
