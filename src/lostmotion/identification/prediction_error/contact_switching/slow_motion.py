"""What the slow motion of a recording tells the search: total inertia within sure bounds, and friction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from .filter import ContactFilter

Array = NDArray[np.float64]

#: Upper edge of the slow motion over the nameplate's torsional frequency (numerics: with the frequency three times too
#: high, shaft and gap still are 10 % of the motion at most), and over the sampling rate.
SLOW, SLOW_DT = 0.1, 0.1
#: Rows per period of the upper edge (numerics: ten times what a band needs).
ROWS_PER_PERIOD = 20
#: The nameplate's total inertia is right within this factor (option: what the second estimator promises to bear).
NAMEPLATE = 3.0
#: Half widths of a 95 % interval within which the inertia certainly is, and a least one (calibrated on development
#: drives 1400 to 1566, 2026-11-24: the largest error of 68 was 0.77 of that).
SURE, LEAST = 2.0, 0.01
#: Friction at least and at most, over the torque's deviation (numerics: a start may have any, but not none).
FRICTION = (0.005, 2.0)


def sure_inertia(told: tuple[float, float], start: Drivetrain) -> tuple[float, float]:
    """Total inertia (kg m²) and the half width of its logarithm within which it certainly is; infinite: any.

    ``told`` is the slow motion's own, see ``total_inertia.of_slow_motion``. Beyond ``NAMEPLATE`` it is none: little
    acceleration, or a wrong sign. Then the nameplate's is taken.
    """
    inertia, half = told
    if not 1.0 / NAMEPLATE < inertia / start.inertia_total < NAMEPLATE:
        return start.inertia_total, np.inf
    return inertia, float(np.hypot(SURE * half, LEAST))


@dataclass(frozen=True)
class SlowFriction:
    """Coulomb (Nm) and viscous (Nm s/rad) friction of the drive as one body, and a constant torque against it (Nm)."""

    coulomb: float
    viscous: float
    constant: float

    @classmethod
    def of(cls, flt: ContactFilter, pole: float) -> SlowFriction:
        """By least squares of torque = J·acceleration + M_c·sgn(speed) + d_v·speed + M_L, with the filter's J if it is
        known; ``pole``: torsional frequency, Hz."""
        edge = min(SLOW * pole, SLOW_DT / flt.dt)
        every = max(1, int(1.0 / (ROWS_PER_PERIOD * edge * flt.dt)))
        columns, torques = [], []
        for first, end in pairwise(flt.bounds):
            torque, speed = _slow(flt, slice(first, end), edge)
            rows = [np.sign(speed), speed, np.ones(speed.size), np.gradient(speed, flt.dt)]
            columns.append(np.column_stack(rows)[::every])
            torques.append(torque[::every])
        known, left = np.concatenate(columns), np.concatenate(torques)
        if np.isfinite(flt.inertia[1]):
            left, known = left - flt.inertia[0] * known[:, -1], known[:, :-1]
        sizes = np.maximum(np.linalg.norm(known, axis=0), 1e-300)
        coulomb, viscous, load = (np.linalg.lstsq(known / sizes, left, rcond=None)[0] / sizes)[:3]
        size = flt.torque_deviation
        per_speed = size / max(flt.speed_deviation, 1e-300)
        low, high = FRICTION
        return cls(
            float(np.clip(coulomb, low * size, high * size)),
            float(np.clip(viscous, low * per_speed, high * per_speed)),
            float(load),
        )


def _slow(flt: ContactFilter, rows: slice, edge: float) -> tuple[Array, Array]:
    """Torque (Nm) and motor speed (rad/s) of a segment below ``edge`` (Hz)."""
    from scipy.signal import butter, sosfiltfilt

    low = butter(2, edge, fs=1.0 / flt.dt, output="sos")
    measured = flt.measured[rows]
    speed = np.gradient(measured, flt.dt) if flt.counted else measured
    padding = min(int(3.0 / (edge * flt.dt)), speed.size - 1)
    torque, speed = (sosfiltfilt(low, s, padlen=padding) for s in (flt.torque[rows], speed))
    return torque, speed
