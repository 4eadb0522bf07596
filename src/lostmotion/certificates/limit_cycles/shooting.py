"""The exact periodic orbit of a sampled loop, by shooting, with its Floquet multipliers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...drivetrain import Drivetrain
from ...errors import InvalidInput
from ...recording import Recording
from ...systems import DiscreteSystem, pruned
from ..lure import delayed
from .sampled_loop import LoopPoint, SampledLoop

Array = NDArray[np.float64]

#: Time that a loop is given to reach its limit cycle, s (option: some hundred periods of the slowest drives).
SETTLE = 10.0
#: Longest simulation, s (option: a minute of computing).
LONGEST = 3600.0
#: Swings of the motor speed that are none, over the set-point's size plus 1 rad/s (numerics: what rounding leaves).
STILL = 1e-7
#: An oscillation whose swing in the last quarter of the simulation is that of the third times less than this dies out
#: (option).
DYING = 0.8
#: Most upward crossings of the mean that make one period, and how near, over its swing, the state must come to where it
#: was (numerics: a crossing lies within a sample of its place; Newton decides).
MOST_CROSSINGS, NEAR = 12, 0.1
#: Signals by which a period is found.
SEEN = ("speed_motor", "speed_load", "twist", "torque_motor")
#: Change of the sample time that is accepted for a whole number of samples, of up to so many periods together; most of
#: an orbit that counts as the law's own (numerics: the law's matrices stay, so its gains change by as much).
STRETCH, MOST_PERIODS, MOST_STRETCH = 2e-4, 12, 3e-3
#: Points of a period from which the swing of each state is taken (numerics).
POINTS = 16
#: Steps of the difference quotients and accepted residual, over the swing of each state; most Newton steps (numerics:
#: the map is exact to 1e-12, and piecewise smooth).
STEP, CLOSED, ROUNDS = 1e-6, 1e-8, 30


@dataclass(frozen=True, eq=False, kw_only=True)
class LimitCycle:
    """A periodic orbit of the sampled loop.

    Parameters
    ----------
    period : float, s
    periods, samples : int
        After so many periods, and so many samples, the orbit is closed. Samples are whole, so the sample time is not
        quite the law's.
    sample_time : float, s
        That of the orbit: period·periods/samples.
    multipliers : (n,) complex array
        Floquet multipliers, the largest first: what a small deviation has become when the orbit is closed. One is 1:
        along the orbit.
    residual : float
        Largest deviation then, over the swing of each state.
    recording : Recording
        The closed orbit, from event to event.
    """

    period: float
    periods: int
    samples: int
    sample_time: float
    multipliers: NDArray[np.complex128]
    residual: float
    recording: Recording

    @property
    def frequency(self) -> float:
        """Hz."""
        return 1.0 / self.period

    @property
    def is_stable(self) -> bool:
        """Whether deviations die out: all multipliers but that along the orbit are inside the unit circle."""
        along = int(np.argmin(np.abs(self.multipliers - 1.0)))
        return bool(np.all(np.abs(np.delete(self.multipliers, along)) < 1.0))

    def swing(self, signal: str) -> float:
        """Largest minus smallest value of a signal over the period, in its unit."""
        return float(np.ptp(self.recording[signal]))


@checks_arguments
def limit_cycle(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    *,
    reference: float,
    torque_load: float = 0.0,
    delay: int = 0,
    state: tuple[float, float, float] | None = None,
    settle: float = SETTLE,
) -> LimitCycle | None:
    """The limit cycle that the loop ends in from a start, exactly; None where it comes to rest or finds no period.

    A simulation finds the orbit roughly; Newton's method closes it: unknown are the states of plant and law at a
    sample, and the sample time, since a period is hardly ever a whole number of samples (their number is fixed; the
    law's matrices stay). The simulation is exact from event to event, so the orbit is one of the loop with its gap,
    its set-valued friction and its law at every sample.

    Parameters
    ----------
    drivetrain : Drivetrain
        Any that ``simulate`` runs: Stribeck friction and breakaway levels too.
    law : DiscreteSystem
        Connected, with speed_reference and torque_motor; input checks are left out.
    reference : float, rad/s
        Constant set-point.
    torque_load : float, Nm
        Constant load torque.
    delay : int
        Computing delay, samples.
    state : (twist, speed_motor, speed_load), optional
        Where the simulation starts; default: at rest in the middle of the gap. Another start may end elsewhere.
    settle : float, s
        Length of the simulation.

    Raises
    ------
    InvalidInput
        As ``simulate``; for a law without set-point or torque, and a time that is not positive.

    Notes
    -----
    Shooting and Floquet multipliers: Nayfeh & Balachandran 1995, Applied Nonlinear Dynamics, sections 3.2 and 5.5.
    """
    return ending(drivetrain, law, reference, torque_load, delay, state, settle)[1]


def ending(
    drivetrain: Drivetrain,
    law: DiscreteSystem,
    reference: float,
    torque_load: float,
    delay: int,
    state: Sequence[float] | None,
    settle: float,
) -> tuple[float, LimitCycle | None]:
    """Swing of the load speed (rad/s) in the second half of the simulation, 0 if it ends at rest; and the limit cycle.

    A swing without a limit cycle has no period that repeats. Arguments as for ``limit_cycle``.
    """
    if not 0.0 < settle <= LONGEST:
        raise InvalidInput(
            "limit_cycle.settle", repr(settle), f"a time in s up to {LONGEST:g}", "Give seconds."
        )
    if delay < 0:
        raise InvalidInput("limit_cycle.delay", repr(delay), "zero or more samples", "Use 0 for none.")
    if "torque_motor" not in law.outputs or "speed_reference" not in law.inputs:
        raise InvalidInput(
            "limit_cycle.law", f"{law.inputs} → {law.outputs}", "speed_reference → torque_motor",
            "Connect observer and controller.",
        )  # fmt: skip
    own = delayed(pruned(law, ("torque_motor",)), delay)
    loop = SampledLoop(drivetrain, own, float(reference), float(torque_load))
    first = None if state is None else loop.start(state)
    size = abs(reference) + 1.0
    run = loop.run(max(round(settle / own.dt), 100), first)
    third, fourth = np.array_split(run["speed_motor"][len(run) // 2 :], 2)
    if not np.ptp(fourth) > max(STILL * size, DYING * np.ptp(third)):
        return 0.0, None
    swing, found = float(np.ptp(run["speed_load"][len(run) // 2 :])), _period(run)
    if found is None:
        return swing, None
    begin, length = found
    periods = _periods(length)
    orbit = _closed(loop, loop.point(loop.run(begin, first)), round(periods * length), STILL * size)
    return swing, None if orbit is None else replace(orbit, periods=periods, period=orbit.period / periods)


def _periods(length: float) -> int:
    """How many periods of so many samples are nearly a whole number of them."""

    def stretch(periods: int) -> float:
        return abs(round(periods * length) / (periods * length) - 1.0)

    tried = range(1, MOST_PERIODS + 1)
    return next((k for k in tried if stretch(k) < STRETCH), min(tried, key=stretch))


def _period(run: Recording) -> tuple[int, float] | None:
    """Sample at which the last whole period begins, and the samples that it has in the mean; None if nothing repeats.

    It begins where the motor speed changes fastest, of all samples at which the load does not stick.
    """
    half = len(run) // 2
    speed = run["speed_motor"][half:]
    above = speed > 0.5 * (np.max(speed) + np.min(speed))
    crossings = np.flatnonzero(above[1:] & ~above[:-1])
    seen = np.column_stack([run[name][half:] for name in SEEN])
    seen = seen / np.maximum(np.ptp(seen, axis=0), 1e-300)
    for m in range(1, min(MOST_CROSSINGS, (crossings.size - 1) // 2) + 1):
        last, before = crossings[-1 - m], crossings[-1 - 2 * m]
        length = min(crossings[-1] - last, last - before)
        apart = np.abs(seen[last : last + length] - seen[before : before + length])
        if np.median(np.max(apart, axis=1)) < NEAR:
            periods = (crossings.size - 1) // m
            samples = float(crossings[-1] - crossings[-1 - m * periods]) / periods
            rate = np.abs(np.gradient(speed[last : last + length]))
            slips = run["speed_load"][half + last : half + last + length] != 0.0
            return int(half + last + np.argmax(np.where(slips, rate, -1.0))), samples
    return None


def _closed(loop: SampledLoop, start: LoopPoint, samples: int, still: float) -> LimitCycle | None:
    """Newton's method from a point near the orbit; None if it does not close, or only by standing still."""
    size, dt = _sizes(loop, start, samples), loop.law.dt
    values, residual, n = start.values, np.inf, start.values.size
    # The time is free, so the point may not move along the orbit.
    along = (loop.after(2, start, values, dt) - values) / size
    for _ in range(ROUNDS):
        after = loop.after(samples, start, values, dt)
        gap = np.append((after - values) / size, along @ ((values - start.values) / size))
        residual = float(np.max(np.abs(gap)))
        if residual < CLOSED:
            break
        longer, shorter = (loop.after(samples, start, values, dt * (1.0 + s * STEP)) for s in (1.0, -1.0))
        system = np.zeros((n + 1, n + 1))
        system[:n, :n] = _jacobian(loop, start, samples, values, dt, size) - np.eye(n)
        system[:n, n], system[n, :n] = (longer - shorter) / (2.0 * STEP * size), along
        change = np.linalg.lstsq(system, -gap, rcond=None)[0]
        change *= min(1.0, 0.5 / float(np.max(np.abs(change))))
        values, dt = values + size * change[:n], dt * (1.0 + float(change[n]))
    if not residual < CLOSED or abs(dt / loop.law.dt - 1.0) > MOST_STRETCH:
        return None
    orbit = loop.run(samples, replace(start, values=values), dt)
    if not np.ptp(orbit["speed_motor"]) > still:
        return None
    multipliers = np.linalg.eigvals(_jacobian(loop, start, samples, values, dt, size)).astype(complex)
    return LimitCycle(
        period=samples * dt, periods=1, samples=samples, sample_time=dt,
        multipliers=multipliers[np.argsort(-np.abs(multipliers))], residual=residual, recording=orbit,
    )  # fmt: skip


def _sizes(loop: SampledLoop, start: LoopPoint, samples: int) -> Array:
    """Swing of each value over the orbit (n,), from some points of it; 1 for one that stands still."""
    points = [start]
    for _ in range(POINTS):
        points.append(loop.point(loop.run(max(samples // POINTS, 2), points[-1])))
    swing = np.ptp(np.array([point.values for point in points]), axis=0)
    return np.where(swing > 0.0, swing, 1.0)


def _jacobian(
    loop: SampledLoop, start: LoopPoint, samples: int, values: Array, dt: float, size: Array
) -> Array:
    """Central differences of the map over one period, both sides over ``size``."""
    columns = []
    for i, each in enumerate(size):
        change = np.zeros(size.size)
        change[i] = STEP * each
        ahead, behind = (loop.after(samples, start, values + s * change, dt) for s in (1.0, -1.0))
        columns.append((ahead - behind) / (2.0 * STEP * size))
    return np.column_stack(columns)
