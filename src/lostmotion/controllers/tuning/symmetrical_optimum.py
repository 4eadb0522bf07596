"""Gains of the PI speed controller from an identified drivetrain: the symmetrical optimum."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...systems import DesignModel, design_model, loop_margin
from ...systems.checks import sample_time
from ..pi import pi

#: Share of the stiffness that a shaft with backlash shows to a small oscillation (its describing function): closed,
#: half open, at the edges of the gap, and the motor all but alone (numerics: a grid).
GAP_SHARES = (1.0, 0.3, 0.1, 0.01)
#: Largest sensitivity (Åström & Hägglund 2006, Advanced PID Control, section 4.6: 1.4 to 2 are usual).
LARGEST_SENSITIVITY = 2.0
#: Kessler's spread; that of a phase margin of 45°, from which on it is searched for (Schröder 2009).
CLASSICAL_SPREAD, DAMPED_SPREAD = 2.0, 1.0 + math.sqrt(2.0)
#: By which factor the spread, or all small time constants, grow in the search, and how often (numerics: to a spread of
#: 6.3, beyond which the reset time would be 40 time constants, and to two thousand times the time constants).
GROWTH, SPREADS, ATTEMPTS = 1.1, 11, 80


@dataclass(frozen=True)
class PiTuning:
    """Gains for ``pi``, and what they were made of.

    Parameters
    ----------
    kp : float, Nm s/rad
    ki : float, Nm/rad
    filter_time : float, s
        Of the set-point filter that belongs to them: it cancels the controller's zero.
    speed_filter_time : float, s
        Of the filter of the measured speed, which keeps its noise out of the torque.
    inertia : float, kg m2
        Of motor and load together.
    time_constant : float, s
        Sum of all small time constants, of which ``shaft_time`` is that of the shaft and ``delay_time`` that of current
        loop, computing delay and hold; the rest is the filter of the measured speed.
    shaft_time, delay_time : float, s
    spread : float
    sensitivity : float
        Largest of the sampled loop, torsional mode included, with the gap closed and at its edges. inf: unstable.
    noise_gain : float, Nm s/rad
        Standard deviation of the torque over that of the measured speed's noise, likewise.
    """

    kp: float
    ki: float
    filter_time: float
    speed_filter_time: float
    inertia: float
    time_constant: float
    shaft_time: float
    delay_time: float
    spread: float
    sensitivity: float
    noise_gain: float

    @property
    def stable(self) -> bool:
        """Whether the sampled loop is stable, torsional mode and backlash included."""
        return math.isfinite(self.sensitivity)

    def gains(self) -> dict[str, float]:
        """The arguments of ``pi``: kp, ki and the filters' times."""
        gains = {"kp": self.kp, "ki": self.ki, "filter_time": self.filter_time}
        return gains | ({"speed_filter_time": self.speed_filter_time} if self.speed_filter_time else {})


@checks_arguments
def symmetrical_optimum(
    drivetrain: Drivetrain,
    *,
    dt: float,
    delay: int = 1,
    spread: float | None = CLASSICAL_SPREAD,
    speed_from_counts: bool = False,
    largest_noise_gain: float = math.inf,
    possible: Sequence[Drivetrain] = (),
) -> PiTuning:
    """Symmetrical optimum of the motor-speed loop, with the shaft as its largest small time constant.

    ::

        T = 1/ω_zero + lag + (delay + ½)·dt + speed_filter_time        ω_zero = √(stiffness/inertia_load)
        kp = J/(a·T)        ki = kp/(a²·T)        filter_time = a²·T        J = inertia_motor + inertia_load

    The loop crosses at 1/(a·T), a factor a below 1/T: the load then turns with the motor. With the current loop's time
    constant alone the loop would cross above the shaft's zero and swing (measured on the virtual rig: 49 % overshoot).

    Parameters
    ----------
    drivetrain : Drivetrain
        Two masses, as identified.
    dt : float, s
    delay : int
        Samples of computing delay; half a sample of hold comes on top.
    spread : float, optional
        a: 2 is the classical choice, larger is slower and better damped. The optimum does not know the torsional mode:
        late drives with little damping need a larger one. None: the smallest from 1 + √2 on (phase margin 45°) with a
        sensitivity of at most ``LARGEST_SENSITIVITY``.
    speed_from_counts : bool
        Whether the measured speed is a mean over the sample, for the sensitivity.
    largest_noise_gain : float, Nm s/rad
        With ``spread=None``: standard deviation of the torque over that of the measured speed's noise, at most. Where
        it is more, the measured speed is filtered. The filter takes noise by itself and by the lower gain, and makes
        the loop slower in proportion; a larger spread takes it by the gain alone, and is slower by the square.
    possible : sequence of Drivetrain
        Drives that the gains must suit: shaft time, lag and sensitivity are the largest of them. Default: the
        drivetrain alone.

    Raises
    ------
    InvalidInput
        If there are not two masses, dt or the noise gain is not positive, the delay is negative or the spread not
        above 1.

    Notes
    -----
    Kessler 1958, Regelungstechnik 6, 395–400 and 432–436; Schröder 2009, Elektrische Antriebe – Regelung von
    Antriebssystemen (textbook form).
    """
    dt = sample_time("symmetrical_optimum.dt", dt)
    if not (isinstance(delay, int) and delay >= 0):
        raise InvalidInput(
            "symmetrical_optimum.delay", repr(delay), "zero or more samples", "Give a whole number."
        )
    if spread is not None:
        if not (math.isfinite(spread) and spread > 1.0):
            raise InvalidInput("symmetrical_optimum.spread", repr(spread), "a number above 1", "2 is usual.")
        return _tuning(drivetrain, dt, delay, speed_from_counts, possible, spread, 0.0)
    if not largest_noise_gain > 0.0:
        raise InvalidInput(
            "symmetrical_optimum.largest_noise_gain",
            repr(largest_noise_gain),
            "a positive number",
            "Leave it out.",
        )
    tried = partial(_tuning, drivetrain, dt, delay, speed_from_counts, possible)
    return _fastest(tried, largest_noise_gain)


def _fastest(tried: Callable[[float, float], PiTuning], largest_noise_gain: float) -> PiTuning:
    """The tuning of the shortest reset time that keeps sensitivity and noise; the one nearest to it if none does.

    Every spread has a shortest filter with which it does: that of the smallest reset time is taken.
    """

    def excess(one: PiTuning) -> float:
        """At most one: both are kept."""
        if not one.stable:
            return math.inf
        return max(one.sensitivity / LARGEST_SENSITIVITY, one.noise_gain / largest_noise_gain)

    best: PiTuning | None = None
    nearest = tried(DAMPED_SPREAD, 0.0)
    for k in range(SPREADS):
        spread, filtered = DAMPED_SPREAD * GROWTH**k, 0.0
        for _ in range(ATTEMPTS):
            tuning = tried(spread, filtered)
            if best is not None and tuning.filter_time >= best.filter_time:
                break
            if excess(tuning) <= 1.0:
                best = tuning
                break
            nearest = min(nearest, tuning, key=excess)
            filtered += (GROWTH - 1.0) * tuning.time_constant
    return best or nearest


def _tuning(
    drivetrain: Drivetrain,
    dt: float,
    delay: int,
    speed_from_counts: bool,
    possible: Sequence[Drivetrain],
    spread: float,
    filtered: float,
) -> PiTuning:
    """The gains of a spread and a filter of the measured speed (s)."""
    drives = possible or (drivetrain,)
    shaft = max(math.sqrt(drive.inertia_load / drive.stiffness) for drive in drives)
    delays = max(drive.lag for drive in drives) + (delay + 0.5) * dt
    time = shaft + delays + filtered
    kp = drivetrain.inertia_total / (spread * time)
    ki = kp / (spread**2 * time)
    law = pi(dt=dt, kp=kp, ki=ki, speed_filter_time=filtered)
    models = [m for drive in drives for m in in_contact_states(drive, dt, delay)]
    margins = [loop_margin(law, model, speed_from_counts) for model in models]
    return PiTuning(
        kp=kp,
        ki=ki,
        filter_time=spread**2 * time,
        speed_filter_time=filtered,
        inertia=drivetrain.inertia_total,
        time_constant=time,
        shaft_time=shaft,
        delay_time=delays,
        spread=spread,
        sensitivity=max(margin.sensitivity for margin in margins),
        noise_gain=max(margin.torque_per_speed_noise for margin in margins),
    )


def in_contact_states(drivetrain: Drivetrain, dt: float, delay: int) -> tuple[DesignModel, ...]:
    """The drive as a small oscillation sees it with the gap closed, and, where there is one, at its edges."""
    shares = GAP_SHARES if drivetrain.backlash > 0.0 else GAP_SHARES[:1]
    softer = (
        drivetrain.with_parameters(stiffness=s * drivetrain.stiffness, damping=s * drivetrain.damping)
        for s in shares
    )
    return tuple(design_model(d, dt, delay) for d in softer)
