"""What the slow motion of a recording tells, in which the drive turns as one body: total inertia and friction."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from ....drivetrain import Drivetrain
from ...statistics.block_covariance import sandwich, student_factor
from .filter import ContactFilter

Array = NDArray[np.float64]

#: Upper edge of the slow motion over the nameplate's torsional frequency (numerics: with the frequency three times too
#: high, shaft and gap still are 10 % of the motion at most), and over the sampling rate.
SLOW, SLOW_DT = 0.1, 0.1
#: Rows per period of the upper edge (numerics: ten times what a band needs).
ROWS_PER_PERIOD = 20
#: The nameplate's total inertia is right within this factor (option: what the second estimator promises to bear).
NAMEPLATE = 3.0
#: Half widths of a 95 % interval within which the inertia certainly is (calibrated on development drives 140 to 279,
#: 2026-11-23: the largest error was 0.98 of that).
SURE = 2.0
#: Friction at least and at most, over the torque's deviation (numerics: a start may have any, but not none).
FRICTION = (0.005, 2.0)


@dataclass(frozen=True)
class SlowMotion:
    """One rigid body: inertia (kg m²), Coulomb (Nm) and viscous (Nm s/rad) friction, constant load torque (Nm).

    ``half`` is the half width of the inertia's logarithm.
    """

    inertia: float
    half: float
    coulomb: float
    viscous: float
    load_torque: float

    @classmethod
    def of(cls, flt: ContactFilter, start: Drivetrain) -> SlowMotion:
        """By least squares of torque = J·acceleration + M_c·sgn(speed) + d_v·speed + M_L.

        An inertia beyond ``NAMEPLATE`` is none: little acceleration, or a wrong sign. Then the nameplate's is taken.
        """
        edge = min(SLOW * start.pole_frequency, SLOW_DT / flt.dt)
        every = max(1, int(1.0 / (ROWS_PER_PERIOD * edge * flt.dt)))
        columns, torques = [], []
        for first, end in pairwise(flt.bounds):
            torque, speed = _slow(flt, slice(first, end), edge)
            rows = [np.gradient(speed, flt.dt), np.sign(speed), speed, np.ones(speed.size)]
            columns.append(np.column_stack(rows)[::every])
            torques.append(torque[::every])
        (inertia, coulomb, viscous, load), half = _regression(
            np.concatenate(columns), np.concatenate(torques)
        )
        if not 1.0 / NAMEPLATE < inertia / start.inertia_total < NAMEPLATE:
            inertia, half = start.inertia_total, np.inf
        size = flt.torque_deviation
        per_speed = size / max(flt.speed_deviation, 1e-300)
        low, high = FRICTION
        return cls(
            float(inertia),
            half,
            float(np.clip(coulomb, low * size, high * size)),
            float(np.clip(viscous, low * per_speed, high * per_speed)),
            float(load),
        )


def _regression(columns: Array, torque: Array) -> tuple[Array, float]:
    """Coefficients (4,) of the torque, and the half width of the first one's logarithm.

    What the columns leave of the torque may be inertia's as well.
    """
    sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    found = np.linalg.lstsq(columns / sizes, torque, rcond=None)[0]
    rest = torque - columns / sizes @ found
    error = float(np.sqrt(sandwich((columns / sizes).T, rest)[0, 0])) / max(abs(found[0]), 1e-300)
    unexplained = float(np.var(rest) / max(np.var(torque), 1e-300))
    return found / sizes, SURE * (student_factor(len(found)) * error + unexplained)


def _slow(flt: ContactFilter, rows: slice, edge: float) -> tuple[Array, Array]:
    """Torque (Nm) and motor speed (rad/s) of a segment below ``edge`` (Hz)."""
    from scipy.signal import butter, sosfiltfilt

    low = butter(2, edge, fs=1.0 / flt.dt, output="sos")
    measured = flt.measured[rows]
    speed = np.gradient(measured, flt.dt) if flt.counted else measured
    padding = min(int(3.0 / (edge * flt.dt)), speed.size - 1)
    torque, speed = (sosfiltfilt(low, s, padlen=padding) for s in (flt.torque[rows], speed))
    return torque, speed
