"""One Gauss–Newton pass over the horizon: a Kalman filter forwards along the last trajectory, its adjoint backwards.

The adjoint is the modified Bryson–Frazier smoother: Bierman 1973, Int. J. Control 18, 65–75.
"""

from __future__ import annotations

import numpy as np

from ...jit import njit
from ..kalman import correct, predict_covariance
from ..layout import ANGLE_COUNTED, MOVING, STIFFNESS, TORQUE_LOAD, TRACKED
from ..missing_inputs import add_missing_torque
from ..sensors import OF_SPEED_MOTOR, count_from_here, sensor_variance
from ..tracking.measurement import innovation_of
from ..tracking.prediction import move
from ..tracking.start import LARGEST_FACTOR, LEAST_FACTOR
from ..two_mass_model import clip
from .horizon import copy_estimate, drop_oldest


@njit(cache=True)
def counter(p):
    """Which sensor is the motor's."""
    i = 0
    while p.kind[i] != OF_SPEED_MOTOR:
        i += 1
    return i


@njit(cache=True)
def count_at(p, s, node, estimate):
    """The estimate, before it moves on from a node: its counted angle from the node's count on."""
    if p.counted:
        i = counter(p)
        R = sensor_variance(p, i, s.sensors[i])
        count_from_here(estimate.x, estimate.P, node.value[i] * p.scale[i], R, node.used[i] != 0.0)


@njit(cache=True)
def _chain(slope, F, product):
    """``slope`` of the substeps so far, followed by a substep with F."""
    for i in range(MOVING):
        for j in range(TRACKED):
            total = F[i, j] if j >= TORQUE_LOAD else 0.0
            for k in range(MOVING):
                total += F[i, k] * slope[k, j]
            product[i, j] = total
    for i in range(MOVING):
        for j in range(TRACKED):
            slope[i, j] = product[i, j]


@njit(cache=True)
def _predict(p, s, node, w):
    """The estimate w.estimate a sample on, along the node's trajectory; the sample's derivatives go to w.slope."""
    e, x, apart, slope = w.estimate, w.x, w.apart, w.slope
    keeps = 1.0
    for j in range(TRACKED):
        x[j] = node.x[j]
    if p.counted:
        i = counter(p)
        keeps = node.used[i]
        x[ANGLE_COUNTED] = keeps * (x[ANGLE_COUNTED] - node.value[i] * p.scale[i])
    count_at(p, s, node, e)
    for j in range(TRACKED):
        apart[j] = e.x[j] - x[j]
    for i in range(MOVING):
        for j in range(TRACKED):
            slope[i, j] = 1.0 if i == j else 0.0
    for _ in range(int(p.substeps)):
        move(p, x, e.P, node.torque, w.F)
        predict_covariance(w.F, e.P, p.Q, w.FP)
        _chain(slope, w.F, w.FP)
    for i in range(MOVING):
        e.x[i] = x[i]
        for j in range(TRACKED):
            e.x[i] += slope[i, j] * apart[j]
    slope[ANGLE_COUNTED, ANGLE_COUNTED] = keeps


@njit(cache=True)
def _correct(p, s, node, i, w):
    """Sensor i of a node into w.estimate; returns ν/S and S (0 if it is not used); H and P Hᵀ in w."""
    e = w.estimate
    if node.used[i] == 0.0:
        return 0.0, 0.0
    nu, S, _ = innovation_of(p, s.sensors[i], e.x, e.P, i, node.value[i], w.H, w.PHt)
    if not S > 0.0:  # the covariance has lost its meaning to rounding
        return 0.0, 0.0
    correct(e.x, e.P, w.PHt, nu, S)
    return nu / S, S


@njit(cache=True)
def forget_oldest(p, h, w):
    """The arrival estimate one sample on, and every node one place down."""
    node = h.nodes[0]
    copy_estimate(h.arrival, w.estimate)
    add_missing_torque(p, w.estimate.P, node.torque_missing != 0.0, node.blind)
    for i in range(int(p.sensors)):
        _correct(p, h.filter, node, i, w)
    _predict(p, h.filter, node, w)
    copy_estimate(w.estimate, h.arrival)
    drop_oldest(h)


@njit(cache=True)
def gauss_newton(p, h, w):
    """One pass; w.estimate ends as the newest estimate."""
    count, sensors = int(h.count), int(p.sensors)
    x, P = np.empty((count, TRACKED)), np.empty((count, TRACKED, TRACKED))
    slopes = np.empty((count, MOVING, TRACKED))
    H, K = np.zeros((count, sensors, TRACKED)), np.zeros((count, sensors, TRACKED))
    scaled = np.zeros((count, sensors))
    copy_estimate(h.arrival, w.estimate)
    for n in range(count):
        node = h.nodes[n]
        add_missing_torque(p, w.estimate.P, node.torque_missing != 0.0, node.blind)
        for i in range(TRACKED):
            x[n, i] = w.estimate.x[i]
            for j in range(TRACKED):
                P[n, i, j] = w.estimate.P[i, j]
        for i in range(sensors):
            scaled[n, i], S = _correct(p, h.filter, node, i, w)
            if S > 0.0:
                for j in range(TRACKED):
                    H[n, i, j], K[n, i, j] = w.H[j], w.PHt[j] / S
        if n < count - 1:
            _predict(p, h.filter, node, w)
            for i in range(MOVING):
                for j in range(TRACKED):
                    slopes[n, i, j] = w.slope[i, j]
    _backwards(h, count, x, P, slopes, H, K, scaled)


@njit(cache=True)
def _backwards(h, count, x, P, slopes, H, K, scaled):
    """Adjoint pass: the trajectory x + P r of every node, from all samples of the horizon."""
    r, turned = np.zeros(TRACKED), np.zeros(TRACKED)
    for n in range(count - 1, -1, -1):
        if n < count - 1:
            for j in range(TRACKED):
                turned[j] = r[j] if j >= TORQUE_LOAD else 0.0
                for i in range(MOVING):
                    turned[j] += slopes[n, i, j] * r[i]
            for j in range(TRACKED):
                r[j] = turned[j]
        for i in range(H.shape[1] - 1, -1, -1):
            along = scaled[n, i]
            for j in range(TRACKED):
                along -= K[n, i, j] * r[j]
            for j in range(TRACKED):
                r[j] += H[n, i, j] * along
        for j in range(TRACKED):
            total = x[n, j]
            for k in range(TRACKED):
                total += P[n, j, k] * r[k]
            h.nodes[n].x[j] = clip(total, LEAST_FACTOR, LARGEST_FACTOR) if j >= STIFFNESS else total
