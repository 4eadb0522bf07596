"""What the slow motion of a recording tells the search: total inertia within sure bounds, and friction."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from .....drivetrain import Drivetrain
from ..filter import ContactFilter

Array = NDArray[np.float64]

#: Upper edge of the slow motion over the nameplate's torsional frequency (numerics: with the frequency three times too
#: high, shaft and gap still are 10 % of the motion at most), and over the sampling rate.
SLOW, SLOW_DT = 0.1, 0.1
#: Upper edge of the speed whose sign friction takes, over the sampling rate; speed below which a drive may rest, over
#: the speed's deviation; share of rest up to which a row counts; part of the rows that counts at least (numerics).
SIGN_DT, REST, RESTING, KEPT = 0.2, 0.05, 0.1, 0.1
#: Rows per period of the upper edge (numerics: ten times what a band needs).
ROWS_PER_PERIOD = 20
#: The nameplate's total inertia is right within this factor (option: what the second estimator promises to bear).
NAMEPLATE = 3.0
#: Half widths of a 95 % interval within which the inertia certainly is, and a least one (calibrated on development
#: drives 1400 to 1566, 2026-11-24: the largest error of 68 was 0.77 of that).
SURE, LEAST = 2.0, 0.01
#: By how much smaller the columns of friction are than the others, and the least singular value that counts (numerics:
#: where a drive turns one way alone, a constant torque explains what friction does but for a hundredth, and takes it).
YIELDING, COUNTING = 1e3, 1e-5
#: Friction at least and at most, over the torque's deviation (numerics: a start may have any, but not none).
FRICTION = (0.005, 2.0)


def informed(flt: ContactFilter, told: tuple[float, float], start: Drivetrain) -> ContactFilter:
    """The filter with the bounds of the total inertia, and with the drive's own friction as unit of friction."""
    flt = replace(flt, inertia=sure_inertia(told, start))
    friction = SlowFriction.of(flt, start.pole_frequency)
    return replace(flt, units=(flt.units[0], friction.coulomb, friction.viscous))


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
        known; ``pole``: torsional frequency, Hz.

        The equation holds at each moment, so that both sides pass the same low pass: the sign of a slow speed is not
        the slow part of the sign. At rest friction is anything up to M_c: rows that show much rest do not count.
        """
        edge = min(SLOW * pole, SLOW_DT / flt.dt)
        every = max(1, int(1.0 / (ROWS_PER_PERIOD * edge * flt.dt)))
        parts = [_slow(flt, slice(first, end), pole, edge)[::every] for first, end in pairwise(flt.bounds)]
        *known, torque, rest = np.concatenate(parts).T
        rows = rest <= max(RESTING, float(np.quantile(rest, KEPT)))
        columns, left = np.column_stack(known)[rows], torque[rows]
        if np.isfinite(flt.inertia[1]):
            left, columns = left - flt.inertia[0] * columns[:, -1], columns[:, :-1]
        coulomb, viscous, load = _least_squares(columns, left)[:3]
        if coulomb < 0.0:  # the speeds do not tell both apart; hardly a drive has viscous friction alone
            columns[:, 1] = 0.0
            coulomb, viscous, load = _least_squares(columns, left)[:3]
        low, high = FRICTION
        return cls(
            float(np.clip(coulomb, low * flt.torque_size, high * flt.torque_size)),
            float(np.clip(viscous, low * flt.damper_size, high * flt.damper_size)),
            float(load),
        )


def _least_squares(columns: Array, torque: Array) -> Array:
    """Factors of the columns; the first two are friction's."""
    sizes = np.maximum(np.linalg.norm(columns, axis=0), 1e-300)
    sizes[:2] *= YIELDING
    return np.asarray(np.linalg.lstsq(columns / sizes, torque, rcond=COUNTING)[0] / sizes)


def _slow(flt: ContactFilter, rows: slice, pole: float, edge: float) -> Array:
    """(n, 6) of a segment below ``edge`` (Hz): sign of the speed, speed, one, acceleration, torque, share of rest."""
    from scipy.signal import butter, sosfiltfilt

    def below(cutoff: float, signal: Array) -> Array:
        padding = min(int(3.0 / (cutoff * flt.dt)), signal.size - 1)
        return np.asarray(
            sosfiltfilt(butter(2, cutoff, fs=1.0 / flt.dt, output="sos"), signal, padlen=padding)
        )

    measured = flt.measured[rows]
    speed = np.gradient(measured, flt.dt) if flt.counted else measured
    seen = below(min(pole, SIGN_DT / flt.dt), speed)
    rests = np.abs(seen) < REST * flt.speed_deviation
    sign, slow = np.where(rests, 0.0, np.sign(seen)), below(edge, speed)
    known = [below(edge, sign), slow, np.ones(slow.size), np.gradient(slow, flt.dt)]
    return np.column_stack([*known, below(edge, flt.torque[rows]), below(edge, rests.astype(float))])
