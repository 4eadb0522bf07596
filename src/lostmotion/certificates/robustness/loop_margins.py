"""Margins of one sampled loop: disk, gain, phase, delay."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .open_loop import OpenLoop

Array = NDArray[np.float64]

#: Frequencies of the first look: so many for each decade, over so many decades below the Nyquist frequency (numerics);
#: around every pole, so many on each side, up to so many times its distance from the unit circle (numerics: a resonance
#: is that wide).
PER_DECADE, DECADES, NEAR, WIDE = 60, 6, 8, 8.0
#: Highest points of the first look that are refined (numerics: neighbours of a resonance come close to each other).
PEAKS = 3


@dataclass(frozen=True, kw_only=True)
class Margins:
    """How much a stable loop may change at the motor torque until it is unstable; of an unstable one all are none.

    Parameters
    ----------
    stable : bool
    disk : float
        Gain and phase may change at once, at every frequency, within a factor (1 + δ/2)/(1 − δ/2), abs(δ) < disk:
        alone, the gain by a factor up to (2 + disk)/(2 − disk), the phase by 2·atan(disk/2). 0 to 2.
    disk_frequency : float, rad/s
        Where the disk margin is smallest.
    gain_low, gain_high : float
        Factors on the gain at which the loop gets unstable; 0 and inf: none.
    phase : float, rad
        Smallest further phase lag or lead at one crossover that makes it unstable; inf: none.
    delay : float, s
        Smallest further delay of the torque, whole samples or not, that makes it unstable; inf: none.
    """

    stable: bool
    disk: float
    disk_frequency: float
    gain_low: float
    gain_high: float
    phase: float
    delay: float


#: Of an unstable loop (numerics).
NO_MARGIN = Margins(
    stable=False, disk=0.0, disk_frequency=math.nan, gain_low=1.0, gain_high=1.0, phase=0.0, delay=0.0
)


def loop_margins(loop: OpenLoop) -> Margins:
    """Margins of a loop, of the sampled frequency response up to the Nyquist frequency.

    The disk margin is that of Seiler, Packard & Gahinet 2020, An introduction to disk margins, IEEE Control Systems 40,
    78-95, without skew: 1/max abs((1 − L)/(2 (1 + L))). The delay margin is exact for a torque that is held and comes
    late by any part of a sample: whole samples turn the phase, the rest changes the step's matrices.
    """
    if not loop.is_stable:
        return NO_MARGIN
    turns = _frequencies(loop)
    values = loop.response(turns)
    disk, at = _disk(loop, turns, values)
    low, high = _gains(loop, turns, values)
    crossovers = _crossovers(loop, turns, values)
    at_crossovers = loop.response(crossovers)
    phase = float(np.min(np.abs(np.angle(-at_crossovers)), initial=math.inf))
    return Margins(
        stable=True, disk=disk, disk_frequency=at / loop.dt, gain_low=low, gain_high=high, phase=phase,
        delay=_delay(loop, turns, crossovers),
    )  # fmt: skip


def _frequencies(loop: OpenLoop) -> Array:
    """Rad per sample, rising up to π: even in the logarithm, and close around the poles of open and closed loop."""
    found = [np.geomspace(10.0**-DECADES * math.pi, math.pi, DECADES * PER_DECADE + 1)]
    for pole in (*loop.poles(), *np.linalg.eigvals(loop.closed())):
        turn, width = abs(np.angle(pole)), abs(1.0 - abs(pole))
        found.append(turn + width * np.linspace(-WIDE, WIDE, 2 * NEAR + 1))
    turns = np.unique(np.concatenate(found))
    return turns[(turns >= found[0][0]) & (turns <= math.pi)]


def _disk(loop: OpenLoop, turns: Array, values: NDArray[np.complex128]) -> tuple[float, float]:
    """Disk margin, and its frequency in rad per sample."""
    from scipy.optimize import minimize_scalar

    def size(turn: float) -> float:
        value = loop.response(np.array([turn]))[0]
        return float(abs((1.0 - value) / (1.0 + value)))

    sizes = np.abs((1.0 - values) / (1.0 + values))
    best = [(float(sizes[i]), float(turns[i])) for i in np.argsort(sizes)[-PEAKS:]]
    for _, turn in list(best):
        i = int(np.searchsorted(turns, turn))
        bounds = turns[max(i - 1, 0)], turns[min(i + 1, turns.size - 1)]
        found = minimize_scalar(
            lambda t: -size(t), bounds=bounds, method="bounded", options={"xatol": 1e-9 * turn}
        )
        best.append((-float(found.fun), float(found.x)))
    largest, turn = max(best)
    return 2.0 / largest, turn


def _gains(loop: OpenLoop, turns: Array, values: NDArray[np.complex128]) -> tuple[float, float]:
    """Largest gain below 1 and smallest above 1 with a pole on the unit circle."""
    real = list(_roots(lambda t: float(loop.response(np.array([t]))[0].imag), turns, values.imag))
    # At z = −1, and at z = 1 where no pole lies, L is real.
    crossing = [*map(float, loop.response(np.array(real)).real), float(values[-1].real)]
    if np.min(np.abs(loop.poles() - 1.0), initial=1.0) > turns[0]:
        crossing.append(float(loop.response(np.zeros(1))[0].real))
    gains = [-1.0 / value for value in crossing if value < 0.0]
    low = max((gain for gain in gains if gain < 1.0), default=0.0)
    return low, min((gain for gain in gains if gain > 1.0), default=math.inf)


def _crossovers(loop: OpenLoop, turns: Array, values: NDArray[np.complex128], late: float = 0.0) -> Array:
    """Frequencies in rad per sample with abs(L) = 1."""
    return _roots(
        lambda t: float(abs(loop.response(np.array([t]), late)[0])) - 1.0, turns, np.abs(values) - 1.0
    )


def _roots(function: Callable[[float], float], turns: Array, values: Array) -> Array:
    """Zeros of a function between neighbours of different sign."""
    from scipy.optimize import brentq

    changes = np.flatnonzero(np.sign(values[:-1]) * np.sign(values[1:]) < 0.0)
    # The end of the axis, where L is real, is no change of sign but for rounding.
    return np.array(
        [brentq(function, turns[i], turns[i + 1], xtol=1e-14, rtol=1e-12) for i in changes], dtype=float
    )


def _delay(loop: OpenLoop, turns: Array, crossovers: Array) -> float:
    """Delay margin, s: whole samples by the phase at the crossovers, the rest by the torque that acts late."""
    from scipy.optimize import brentq

    def whole(late: float) -> float:
        """Whole samples, not rounded, by which the torque may further be late."""
        where = crossovers if late == 0.0 else _crossovers(loop, turns, loop.response(turns, late), late)
        # The part of a sample takes about that turn, which may be more than the lag that is left.
        own = late * where
        lag = np.mod(np.angle(-loop.response(where, late)) + own, 2.0 * math.pi) - own
        return float(np.min(lag / where, initial=math.inf))

    start = whole(0.0)
    if not math.isfinite(start):
        return math.inf
    samples = math.floor(start)

    def left(late: float) -> float:
        return min(whole(late) - samples, 1.0)

    rest = brentq(left, 0.0, 1.0, xtol=1e-6) if start > samples else 0.0
    return (samples + float(rest)) * loop.dt
