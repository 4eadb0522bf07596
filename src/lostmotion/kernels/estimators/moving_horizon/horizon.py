"""The horizon: its nodes, each a sample with its trajectory and what was measured; how one comes, and how it begins."""

from __future__ import annotations

import math

from ...jit import njit
from ..kalman import inflate
from ..layout import HORIZON, HORIZON_PARAMETERS, SENSORS, SPEED_MOTOR, TORQUE_LOAD, TRACKED, place, size
from ..records import reads
from ..sensor_check import REFUSED_RATE
from ..sensors import OF_SPEED_LOAD
from ..tracking.correction import check
from ..tracking.measurement import innovation_of
from ..tracking.start import restart, start_again_if_lost
from ..verdicts import FROZEN, JUMP, START_AGAIN, USE

parameters_of, memory_of = reads(HORIZON_PARAMETERS), reads(HORIZON)

_COUNT, _NODES, _NODE = place(HORIZON, "count"), place(HORIZON, "nodes"), size(HORIZON["nodes"].base)


@njit(cache=True)
def memory_size(own):
    """Numbers in the memory of a horizon with as many nodes as its parameters say."""
    return _NODES + int(own.nodes) * _NODE


@njit(cache=True)
def copy_estimate(source, to):
    """x and P."""
    for i in range(TRACKED):
        to.x[i] = source.x[i]
        for j in range(TRACKED):
            to.P[i, j] = source.P[i, j]


@njit(cache=True)
def begin_horizon(h):
    """The horizon begins at the newest estimate."""
    h.count = 0.0
    copy_estimate(h.filter.estimate, h.arrival)


@njit(cache=True)
def append(p, h, inputs, torque, given, w):
    """A new node from the newest prediction; returns the faults and whether to start again."""
    s, count = h.filter, int(h.count)
    x, P, node = s.estimate.x, s.estimate.P, h.nodes[count]
    faults, again = given, False
    for j in range(TRACKED):
        node.x[j] = x[j]
    node.torque = torque
    node.torque_missing, node.blind = float(given & 1), s.blind
    for i in range(int(p.sensors)):
        value = inputs[1 + i]
        nu, S, _ = innovation_of(p, s.sensors[i], x, P, i, value, w.H, w.PHt)
        verdict = check(p, s, i, value, given & (2 << i) != 0, nu, S)
        node.value[i] = value
        node.used[i] = 1.0 if verdict == USE else 0.0
        if verdict != USE:
            faults |= 2 << i
        if verdict == FROZEN:
            _take_back(h, i, min(int(s.sensors[i].repeats) - 1, count))
        if verdict == JUMP:
            inflate(h.arrival.P, TORQUE_LOAD, math.exp(REFUSED_RATE * p.dt), p.largest_deviation)
        if verdict == START_AGAIN:
            restart(p, s, value if int(p.kind[i]) <= OF_SPEED_LOAD else x[SPEED_MOTOR], TORQUE_LOAD)
            again = True
    return faults, again


@njit(cache=True)
def _take_back(h, i, repeats):
    """A frozen sensor: the earlier samples of the same value, still in the horizon, are not used any more."""
    for n in range(int(h.count) - repeats, int(h.count)):
        h.nodes[n].used[i] = 0.0


@njit(cache=True)
def drop_oldest(h):
    """Every node one place down."""
    for n in range(int(h.count) - 1):
        node, following = h.nodes[n], h.nodes[n + 1]
        for j in range(TRACKED):
            node.x[j] = following.x[j]
        for i in range(SENSORS):
            node.value[i], node.used[i] = following.value[i], following.used[i]
        node.torque, node.torque_missing, node.blind = (
            following.torque,
            following.torque_missing,
            following.blind,
        )
    h.count -= 1.0


@njit(cache=True)
def empty_if_lost(own, state):
    """Start again if the estimate or anything in the horizon is no number."""
    h, total = memory_of(state), 0.0
    for j in range(_COUNT, state.size):
        total += state[j]
    if not math.isfinite(total):
        h.filter.estimate.x[0] = math.nan
    start_again_if_lost(own.common, h.filter)
    if h.filter.started == 0.0:
        for j in range(_COUNT, memory_size(own)):
            state[j] = 0.0
