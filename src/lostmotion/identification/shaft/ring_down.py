"""Frequency and damping ratio of the oscillation that rings down after a step."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...recording import Recording
from ..statistics.estimates import Estimates, Interval
from . import problems as problem

Floats = NDArray[np.float64]

#: What is looked for.
VALUES = ("frequency", "damping_ratio")

#: Means over this many seconds on both sides make a step stand out (calibrated on ten ring-downs of 28 Hz with noise,
#: of which it is three periods: half and double find frequency and damping as well; benchmarks/calibrations.py).
STEP_WINDOW = 0.1
#: A change of the mean is a step if it is this many robust standard deviations of all changes (numerics: hardly
#: ever by chance).
STEP_FACTOR = 6.0
#: Steps at least this fraction of the largest are used together (option).
STEP_FRACTION = 0.5
#: Where the fit starts after the step and how long it is, in periods (option; six windows of different start and
#: length: what depends on the choice shows as a difference between them). The first pair gives the estimate, the others
#: its spread. The step itself is over after half a period.
WINDOWS = ((0.5, 10.0), (0.5, 6.0), (0.5, 14.0), (1.0, 10.0), (1.0, 14.0), (1.5, 10.0))
#: Largest damping ratio: above, there is hardly a second period to measure (numerics: each is 14 % of the one before).
MAX_DAMPING_RATIO = 0.3
#: Without a step the recording may begin inside a decay: of that the fit explains at least this part (option: half).
BEGUN = 0.5
#: Surrogates of the residual for the interval (numerics: their scatter is then known within 11 %).
SURROGATES = 40
#: A window cut short by the next step or the end counts from this many periods on (option).
MIN_PERIODS = 4.0


@dataclass(frozen=True, eq=False, repr=False, kw_only=True)
class RingDown(Estimates):
    """Ring-down after one or more steps.

    Values: ``frequency`` (Hz, undamped natural frequency, f below), ``damping_ratio`` (Lehr's; of the rig as it ran,
    with its controllers).

    Attributes
    ----------
    steps : tuple of float, s
        Where the steps were found.
    explained : float
        Fraction of the variance in the windows that the fit explains; NaN without a fit.
    seed : int
        Of the surrogates.
    windows : tuple of (time, signal, fit), arrays, s and the signal's unit
        One for each step, for plots.
    spread : (m, 2) array
        Frequency and damping ratio of each of the m other windows tried.
    signal : str
    """

    steps: tuple[float, ...]
    explained: float
    windows: tuple[tuple[Floats, Floats, Floats], ...]
    spread: Floats
    signal: str
    seed: int


@checks_arguments
def ring_down(
    recording: Recording,
    *,
    signal: str = "torque_shaft",
    band: tuple[float, float] | None = None,
    seed: int = 1,
) -> RingDown:
    """Fit one damped oscillation to what follows the steps of a signal.

    Steps are where the mean changes most; where there is none, the recording may begin inside the decay, and its
    first row counts as one. Steps of similar size share one frequency f and one damping ratio D, each with its own
    offset, amplitude and phase::

        y = c0 + exp(−D·w·t)·(c1 cos(w√(1 − D²)·t) + c2 sin(w√(1 − D²)·t)),     w = 2π·f

    by least squares over D and f (the rest is linear: variable projection), from half a period after the step
    for ten periods. Intervals (95 %): fits to surrogates, the fit plus its residual with random phases, so
    that coloured disturbances count with their colour; in quadrature with the spread over other windows.
    No ring-down is reported where the interval of D reaches 0: a steady disturbance fits as well.

    Parameters
    ----------
    recording : Recording
    signal : str
        The shaft torque rings most clearly: the speed of a controlled motor hardly moves.
    band : (float, float), Hz
        Where the frequency is looked for; default: 3 Hz to 300 Hz, at most 0.4 of the sample rate (chosen).
    seed : int
        Of the surrogates, which make the intervals.

    Raises
    ------
    InvalidInput
        A missing signal, or a band outside 0 … half the sample rate.
    """
    values, dt = recording[signal], recording.dt
    band = band or (3.0, min(300.0, 0.4 / dt))
    if not 0.0 < band[0] < band[1] < 0.5 / dt:
        raise InvalidInput(
            "ring_down",
            f"band {band} Hz",
            f"0 < lower < upper < {0.5 / dt:g} Hz",
            "Choose a band below half the sample rate.",
        )
    steps = _steps(values, max(round(STEP_WINDOW / dt), 2))
    least = 0.0 if steps else BEGUN
    steps = steps or [0]
    times = tuple(float(recording.time[i]) for i in steps)
    fit = _search_and_fit(values, steps, dt, band)
    if fit is None:
        return _nothing(signal, times, seed, "no ring-down of four periods or more")
    found, rows, models = fit
    segments = [values[r] for r in rows]
    explained = _explained(segments, models)
    if explained < least:
        return _nothing(signal, (), seed, "no step that stands out", explained)
    decays = 0.0 < found[1] < MAX_DAMPING_RATIO and explained > 0.0
    if not (decays and band[0] < found[0] < band[1]):
        best = f"{found[0]:.3g} Hz, damping ratio {found[1]:.2g}, {100 * explained:.0f} % of the variance"
        return _nothing(signal, times, seed, f"no clear ring-down (best fit: {best})", explained)
    others = [_cut(values.size, steps, 1.0 / (found[0] * dt), window) for window in WINDOWS[1:]]
    spread = np.array([_fit([values[r] for r in other], dt, found)[0] for other in others if other])
    spread = spread.reshape(-1, 2)
    intervals = _intervals(found, segments, models, dt, spread, np.random.default_rng(seed))
    if intervals["damping_ratio"][0] <= 0.0:
        got = f"a line at {found[0]:.4g} Hz that need not decay"
        return _nothing(signal, times, seed, got, explained)
    named: dict[str, float | None] = dict(zip(VALUES, found.tolist(), strict=True))
    return RingDown(
        values=named,
        intervals=intervals,
        steps=times,
        explained=explained,
        windows=tuple((recording.time[r], values[r], m) for r, m in zip(rows, models, strict=True)),
        spread=spread,
        signal=signal,
        seed=seed,
    )


def _steps(values: Floats, width: int) -> list[int]:
    """Rows where the mean of ``width`` rows changes most, in order of time; none if no change stands out."""
    if values.size < 4 * width:
        return []
    mean = np.convolve(values, np.full(width, 1.0 / width), mode="valid")
    change = np.abs(mean[width:] - mean[:-width])
    usual = 1.4826 * float(np.median(change))
    largest = float(change.max())
    if not largest > STEP_FACTOR * usual:
        return []
    steps: list[int] = []
    left = change.copy()
    while left.max() >= max(STEP_FRACTION * largest, STEP_FACTOR * usual, np.finfo(float).tiny):
        at = int(np.argmax(left))
        steps.append(at + width)
        left[max(at - 2 * width, 0) : at + 2 * width] = 0.0
    return sorted(steps)


def _cut(size: int, steps: list[int], period: float, window: tuple[float, float]) -> list[slice]:
    """The rows after each step; ``window`` is start and length in periods, ``period`` one in rows."""
    rows = []
    for step, following in zip(steps, [*steps[1:], size], strict=True):
        start = step + round(window[0] * period)
        # The next step is known within half a period only.
        stop = min(start + round(window[1] * period), following - round(0.5 * period))
        if stop - start >= MIN_PERIODS * period:
            rows.append(slice(start, stop))
    return rows


def _model(frequency: float, ratio: float, segment: Floats, dt: float) -> Floats:
    """The best fit to one segment at this frequency and damping ratio: offset, cosine, sine are linear."""
    t = np.arange(segment.size) * dt
    w = 2.0 * math.pi * frequency
    decay = np.exp(-ratio * w * t)
    turn = w * math.sqrt(max(1.0 - ratio**2, 1e-9)) * t
    basis = np.stack([np.ones_like(t), decay * np.cos(turn), decay * np.sin(turn)], axis=1)
    return np.asarray(basis @ np.linalg.lstsq(basis, segment, rcond=None)[0], dtype=float)


def _explained(segments: list[Floats], models: list[Floats]) -> float:
    rest = sum(float(((p - m) ** 2).sum()) for p, m in zip(segments, models, strict=True))
    whole = sum(float(((p - p.mean()) ** 2).sum()) for p in segments)
    return 1.0 - rest / whole if whole > 0.0 else 0.0


def _search(values: Floats, steps: list[int], dt: float, band: Interval) -> Floats | None:
    """Start values: the pair of a grid that explains most of the variance of its own window."""
    best, found = -math.inf, None
    for frequency in np.geomspace(*band, max(round(25.0 * math.log(band[1] / band[0])), 2)):
        segments = [values[rows] for rows in _cut(values.size, steps, 1.0 / (frequency * dt), WINDOWS[0])]
        for ratio in (0.02, 0.06, 0.18):
            explained = _explained(segments, [_model(frequency, ratio, p, dt) for p in segments])
            if segments and explained > best:
                best, found = explained, np.array([frequency, ratio])
    return found


def _search_and_fit(
    values: Floats, steps: list[int], dt: float, band: Interval
) -> tuple[Floats, list[slice], list[Floats]] | None:
    """Frequency and damping ratio, the rows fitted, and the fit there; None if too short."""
    found = _search(values, steps, dt, band)
    if found is None:
        return None
    # Once more with the window of the frequency found: else the result would depend on the grid.
    for _ in range(2):
        rows = _cut(values.size, steps, 1.0 / (found[0] * dt), WINDOWS[0])
        if not rows:
            return None
        found, models = _fit([values[r] for r in rows], dt, found)
    return found, rows, models


def _fit(segments: list[Floats], dt: float, start: Floats) -> tuple[Floats, list[Floats]]:
    """Least squares over (frequency, damping ratio) common to all segments; also the fitted segments."""
    from scipy.optimize import least_squares

    def residual(p: Floats) -> Floats:
        return np.concatenate([segment - _model(p[0], p[1], segment, dt) for segment in segments])

    bounds = ([0.5 * start[0], -0.5], [2.0 * start[0], 0.9])
    scale = [0.02 * start[0], 0.02]
    found = np.asarray(least_squares(residual, start, x_scale=scale, bounds=bounds).x, dtype=float)
    return found, [_model(found[0], found[1], segment, dt) for segment in segments]


def _intervals(
    found: Floats,
    segments: list[Floats],
    models: list[Floats],
    dt: float,
    spread: Floats,
    random: np.random.Generator,
) -> dict[str, Interval]:
    from scipy.stats import t as student

    fits = np.empty((SURROGATES, 2))
    for i in range(SURROGATES):
        surrogate = [m + _random_phases(p - m, random) for p, m in zip(segments, models, strict=True)]
        fits[i] = _fit(surrogate, dt, found)[0]
    variance = fits.var(axis=0, ddof=1)
    if len(spread):
        variance += ((spread - found) ** 2).mean(axis=0)
    margin = float(student.ppf(0.975, SURROGATES - 1)) * np.sqrt(variance)
    return {n: (float(v - m), float(v + m)) for n, v, m in zip(VALUES, found, margin, strict=True)}


def _random_phases(residual: Floats, random: np.random.Generator) -> Floats:
    """A surrogate with the residual's spectrum and random phases (Theiler et al. 1992)."""
    spectrum = np.fft.rfft(residual)
    turned = spectrum * np.exp(2j * np.pi * random.random(spectrum.size))
    # First and, at even length, last value are real: a turned phase would lose a part of them.
    turned[0] = spectrum[0]
    if residual.size % 2 == 0:
        turned[-1] = spectrum[-1]
    return np.asarray(np.fft.irfft(turned, residual.size), dtype=float)


def _nothing(
    signal: str, times: tuple[float, ...], seed: int, got: str, explained: float = math.nan
) -> RingDown:
    return RingDown(
        values=dict.fromkeys(VALUES),
        intervals={},
        problems=(problem.no_ring_down(signal, got),),
        steps=times,
        explained=explained,
        windows=(),
        spread=np.empty((0, 2)),
        signal=signal,
        seed=seed,
    )
