"""Kalman filter, one scalar measurement after the other: innovation, correction, prediction of the covariance.

    ν = y − h(x)                      (1)  innovation
    S = H P Hᵀ + R                    (2)  its variance
    K = P Hᵀ / S                      (3)
    x ← x + K ν,  P ← P − K S Kᵀ      (4)  correction
    x ← f(x, u)                       (5)  prediction
    P ← F P Fᵀ + Q                    (6)

Särkkä 2013, Bayesian Filtering and Smoothing, theorem 4.2, with F = ∂f/∂x and H = ∂h/∂x algorithm 5.4; scalar
measurements in turn: Simon 2006, Optimal State Estimation, section 6.1.
"""

from __future__ import annotations

from ..jit import njit
from .layout import SPEED_MOTOR


@njit(cache=True, inline="always")
def variance_along(P, H, PHt):
    """H P Hᵀ of equation (2); P Hᵀ goes to ``PHt``. Most entries of a row H are zero."""
    n = H.size
    for j in range(n):
        PHt[j] = 0.0
    for k in range(n):
        if H[k] != 0.0:
            for j in range(n):
                PHt[j] += P[k, j] * H[k]
    variance = 0.0
    for j in range(n):
        variance += H[j] * PHt[j]
    return variance


@njit(cache=True, inline="always")
def correct(x, P, PHt, nu, S):
    """Equations (3) and (4): x and P corrected by the innovation ν of variance S."""
    n = x.size
    for i in range(n):
        x[i] += PHt[i] / S * nu
    for i in range(n):
        for j in range(i, n):
            P[i, j] = P[j, i] = P[i, j] - PHt[i] * PHt[j] / S


@njit(cache=True)
def predict_covariance(F, P, Q, FP):
    """Equation (6). ``F`` has the rows of the moving states, all others are constants; ``FP`` is scratch."""
    moving, n = F.shape
    for i in range(moving):
        for j in range(n):
            FP[i, j] = F[i, 0] * P[0, j]
        for k in range(1, n):
            for j in range(n):
                FP[i, j] += F[i, k] * P[k, j]
    for i in range(moving):
        for j in range(i, moving):
            total = FP[i, 0] * F[j, 0]
            for k in range(1, n):
                total += FP[i, k] * F[j, k]
            P[i, j] = P[j, i] = total
        for j in range(moving, n):
            P[i, j] = P[j, i] = FP[i, j]
    for i in range(n):
        P[i, i] += Q[i]


@njit(cache=True)
def inflate(P, states, factor, largest):
    """Covariance inflation: deviations of the first states grow by a factor, that of the motor speed up to ``largest``.

    So an estimate whose covariance is too small, after a drop-out say, accepts its sensor again within milliseconds.
    """
    if P[SPEED_MOTOR, SPEED_MOTOR] > largest * largest:
        return
    for i in range(states):
        for j in range(P.shape[0]):
            P[i, j] *= factor
            P[j, i] *= factor
