"""Stiffness of a shaft from the speeds at both of its ends and its torque, and the delay of that torque."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...recording import Recording
from ..backlash.torque_reversals import backlash_excited
from ..frequency.spectra import Complexes, Floats, gain_and_coherence, segment_spectra
from ..statistics.estimates import Estimates, Interval, Source
from . import problems as problem

#: What is looked for.
VALUES = ("stiffness", "torque_delay", "damping", "inertia_between")
#: Periods of the lowest frequency in one segment (numerics: with Hann's window its line is then clear of zero's, whose
#: main lobe is two lines wide).
PERIODS_PER_SEGMENT = 3.0
#: Fewest segments (numerics: Student's factor of a jackknife over them is 2.6).
MIN_SEGMENTS = 6
#: Fewest usable frequencies (numerics: for three unknowns).
MIN_FREQUENCIES = 8
#: Lower bound on 1 − coherence (numerics), so that one strong line does not dominate.
COHERENCE_FLOOR = 1e-3
#: Half width, in bins, of what is left out around multiples of the turning frequency: Hann's main lobe (numerics).
ORDER_BINS = 2.0


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class ShaftStiffness(Estimates):
    """Stiffness and torque delay of one shaft.

    Values:

    - ``stiffness``, Nm/rad: towards low frequency;
    - ``torque_delay``, s, positive = torque late against the speeds: the apparent one, true delay − damping /
      stiffness; the given one where it was given;
    - ``damping``, Nm s/rad: only where the delay was given, since the phase alone cannot separate damping and delay;
    - ``inertia_between``, kg m2: m of the fit abs(T/twist) = stiffness − m·(2π·frequency)², the inertia between the
      sensors.

    Attributes
    ----------
    frequency, response, coherence : (m,) arrays, Hz, complex Nm/rad, 1
        Torque over twist over the band.
    used : (m,) bool array
        The frequencies that the fit used.
    segments : int
    torque_reverses : bool
        If so, a gap (if there is one) is part of what was measured.
    """

    frequency: Floats
    response: Complexes
    coherence: Floats
    used: NDArray[np.bool_]
    segments: int
    torque_reverses: bool

    def fitted(self, frequency: Floats) -> Complexes:
        """The fitted torque over twist, Nm/rad, at frequencies in Hz; to be shown beside ``response``."""
        stiffness, between, delay = (self.values[n] for n in ("stiffness", "inertia_between", "torque_delay"))
        if stiffness is None or between is None or delay is None:
            raise InvalidInput(
                "ShaftStiffness.fitted", "no stiffness", "an identified one", "See its problems."
            )
        w = 2.0 * np.pi * np.asarray(frequency, dtype=float)
        late = delay - (self.values["damping"] or 0.0) / stiffness
        magnitude = stiffness - between * w**2
        return np.asarray(magnitude * np.exp(-1j * w * late), dtype=complex)


@checks_arguments
def shaft_stiffness(
    recording: Recording,
    *,
    speed_a: str = "speed_motor",
    speed_b: str = "speed_load",
    torque: str = "torque_shaft",
    band: tuple[float, float] = (3.0, 60.0),
    min_coherence: float = 0.9,
    torque_delay: float | None = None,
) -> ShaftStiffness:
    """Stiffness from the shaft torque T against the integral of the speed difference, the twist.

    T/twist by cross spectrum, and weighted by coherence / (1 − coherence) the fit::

        abs(T/twist) = stiffness − inertia_between·ω²,     angle(T/twist) = −ω·torque_delay

    The twist is the trapezoidal integral, on the recording's mean step h, and its known gain
    (ωh/2)/tan(ωh/2) is divided out; a running sum would be half a sample off. Left out are frequencies below
    ``min_coherence`` and, at steady speed, the multiples of the turning frequency: there a speed sensor sees
    its own run-out. Intervals: jackknife over the segments (Student t), in quadrature with what a fit over
    the band's lower half changes (the real shaft may follow another law than the fit); for stiffness and
    inertia plus half of what separates the two usual estimates, biased by noise in twist or in torque.

    Parameters
    ----------
    recording : Recording
        Signals in rad/s and Nm; a positive torque drives end b.
    speed_a, speed_b, torque : str
        The speeds at the driving and the driven end, and the torque of the shaft between them.
    band : (float, float), Hz
        Default for a first eigenmode near 30 Hz (the Aalto thruster rig).
    min_coherence : float
        In (0, 1); default chosen.
    torque_delay : float, optional, s
        The torque channel's delay where it is known: what is left of the phase then is the damping.

    Raises
    ------
    InvalidInput
        A missing signal, or a band outside 0 … half the sample rate.
    """
    dt = recording.dt
    if not 0.0 < band[0] < band[1] < 0.5 / dt or not 0.0 < min_coherence < 1.0:
        raise InvalidInput(
            "shaft_stiffness",
            f"band {band} Hz, min_coherence {min_coherence}",
            f"0 < lower < upper < {0.5 / dt:g} Hz and a coherence between 0 and 1",
            "Choose a band below half the sample rate.",
        )
    length = max(round(PERIODS_PER_SEGMENT / (band[0] * dt)), 4)
    frequency = np.asarray(np.fft.rfftfreq(length, dt), dtype=float)
    keep = (frequency >= band[0]) & (frequency <= band[1])
    frequency = frequency[keep]
    x = segment_spectra(_twist(recording[speed_a] - recording[speed_b], dt), length)[:, keep]
    x *= np.tan(np.pi * frequency * dt) / (np.pi * frequency * dt)
    y = segment_spectra(recording[torque], length)[:, keep]
    response, coherence = gain_and_coherence(_sum(x, x).real, _sum(y, y).real, _sum(x, y))
    used = (coherence >= min_coherence) & ~_orders(frequency, recording[speed_a], 1.0 / (length * dt))
    reverses = bool(backlash_excited(recording, signal=torque).excited)
    problems = [problem.gap_in_stiffness(torque)] if reverses else []
    values: dict[str, float] = {}
    intervals: dict[str, Interval] = {}
    least, usable = (MIN_SEGMENTS, MIN_FREQUENCIES), int(np.count_nonzero(used))
    if len(x) < MIN_SEGMENTS or usable < MIN_FREQUENCIES:
        problems.append(problem.too_little(torque, len(x), usable, length * dt, least, min_coherence))
    else:
        if np.sum(response[used].real) < 0.0:
            problems.append(problem.wrong_sign(torque))
            response, y = -response, -y
        values, intervals = _estimate(x[:, used], y[:, used], frequency[used])
        if intervals["stiffness"][0] <= 0.0:
            problems.append(problem.may_be_zero(torque, intervals["stiffness"]))
            values, intervals = {}, {}
        else:
            if intervals["inertia_between"][1] < 0.0:
                problems.append(problem.negative_inertia(torque, intervals.pop("inertia_between")))
                del values["inertia_between"]
            _take_known_delay(values, intervals, torque_delay)
    known = {} if torque_delay is None else {"torque_delay": torque_delay}
    found = {name: values.get(name) for name in VALUES} | known
    given: dict[str, Source] = dict.fromkeys(known, "nameplate")
    return ShaftStiffness(
        values=found, intervals=intervals, sources=given, problems=tuple(problems),
        frequency=frequency, response=response, coherence=coherence, used=used, segments=len(x),
        torque_reverses=reverses,
    )  # fmt: skip


def _twist(difference: Floats, dt: float) -> Floats:
    """Trapezoidal integral; its phase is exact."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (difference[1:] + difference[:-1]))]) * dt


def _sum(a: Complexes, b: Complexes) -> Complexes:
    return np.asarray(np.sum(a.conj() * b, axis=0), dtype=complex)


def _orders(frequency: Floats, speed: Floats, resolution: float) -> NDArray[np.bool_]:
    """The frequencies at multiples of the turning frequency, if it is steady and they are apart."""
    turning = abs(float(speed.mean())) / (2.0 * np.pi)
    if turning < 3.0 * ORDER_BINS * resolution or abs(speed.mean()) < 5.0 * speed.std():
        return np.zeros(frequency.shape, dtype=bool)
    from_order = np.abs(frequency - turning * np.maximum(np.round(frequency / turning), 1.0))
    return np.asarray(from_order <= ORDER_BINS * resolution)


def _fit(xx: Floats, yy: Floats, xy: Complexes, frequency: Floats) -> Floats:
    """(…, 4) array: stiffness, inertia between, torque delay, weighted mean of 1 − coherence."""
    w2 = (2.0 * np.pi * frequency) ** 2
    gain, coherence = gain_and_coherence(xx, yy, xy)
    lost = np.maximum(1.0 - coherence, COHERENCE_FLOOR)
    weight = coherence / lost
    by_gain = weight / np.abs(gain) ** 2
    s0, s1, s2 = ((by_gain * p).sum(axis=-1) for p in (1.0, -w2, w2**2))
    b0, b1 = ((by_gain * np.abs(gain) * p).sum(axis=-1) for p in (1.0, -w2))
    stiffness = (s2 * b0 - s1 * b1) / (s0 * s2 - s1**2)
    inertia = (s0 * b1 - s1 * b0) / (s0 * s2 - s1**2)
    phase = np.angle(gain)
    delay = -(weight * np.sqrt(w2) * phase).sum(axis=-1) / (weight * w2).sum(axis=-1)
    ambiguity = (weight * (1.0 - coherence)).sum(axis=-1) / weight.sum(axis=-1)
    return np.stack([stiffness, inertia, delay, ambiguity], axis=-1)


def _estimate(x: Complexes, y: Complexes, frequency: Floats) -> tuple[dict[str, float], dict[str, Interval]]:
    from scipy.stats import t as student

    n = len(x)
    xx, yy, xy = np.abs(x) ** 2, np.abs(y) ** 2, x.conj() * y
    sums = xx.sum(axis=0), yy.sum(axis=0), xy.sum(axis=0)
    whole = _fit(sums[0], sums[1], sums[2], frequency)
    without_one = _fit(sums[0] - xx, sums[1] - yy, sums[2] - xy, frequency)
    error = np.sqrt((n - 1) / n * ((without_one - without_one.mean(axis=0)) ** 2).sum(axis=0))
    margin = float(student.ppf(0.975, n - 1)) * error
    lower = frequency <= 0.5 * frequency[-1]
    if np.count_nonzero(lower) >= MIN_FREQUENCIES:
        part = _fit(sums[0][lower], sums[1][lower], sums[2][lower], frequency[lower])
        margin = np.hypot(margin, part - whole)
    # Sxy/Sxx and Syy/Syx lie √coherence below and above the geometric mean: about half of 1 − coherence each.
    margin[:2] += 0.5 * whole[3] * np.abs(whole[:2])
    values: dict[str, float] = {}
    intervals: dict[str, Interval] = {}
    for i, name in enumerate(("stiffness", "inertia_between", "torque_delay")):
        values[name] = float(whole[i])
        intervals[name] = (float(whole[i] - margin[i]), float(whole[i] + margin[i]))
    return values, intervals


def _take_known_delay(values: dict[str, float], intervals: dict[str, Interval], known: float | None) -> None:
    """Damping from the part of the phase that a known delay leaves: stiffness·(known − apparent delay)."""
    if known is None:
        return
    stiffness, (low, high) = values["stiffness"], intervals.pop("torque_delay")
    values["damping"] = stiffness * (known - values["torque_delay"])
    intervals["damping"] = (stiffness * (known - high), stiffness * (known - low))
    values["torque_delay"] = known
