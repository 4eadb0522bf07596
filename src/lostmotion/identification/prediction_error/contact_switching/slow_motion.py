"""What the slow motion of a recording tells, in which the drive turns as one body: total inertia and friction."""

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
#: Friction at least and at most, over the torque's deviation (numerics: a start may have any, but not none).
FRICTION = (0.005, 2.0)


@dataclass(frozen=True)
class SlowMotion:
    """One rigid body: inertia (kg m²), Coulomb (Nm) and viscous (Nm s/rad) friction, constant load torque (Nm)."""

    inertia: float
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
        inertia, coulomb, viscous, load = np.linalg.lstsq(
            np.concatenate(columns), np.concatenate(torques), rcond=None
        )[0]
        if not 1.0 / NAMEPLATE < inertia / start.inertia_total < NAMEPLATE:
            inertia = start.inertia_total
        size = float(np.std(flt.torque))
        per_speed = size / max(flt.speed_deviation, 1e-300)
        low, high = FRICTION
        return cls(
            float(inertia),
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
