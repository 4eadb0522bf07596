"""Channels of several files on one clock: the further ones are shifted, and put on the raster of the first."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ...recording import Recording
from .checks import check_recording

Floats = NDArray[np.float64]

#: Correlation of the common signal below which two files cannot be aligned by it (option: a tenth of the variance is
#: not common).
ALIKE = 0.95
#: Rows that the recordings must have in common (option: as many as any recording needs).
FEWEST = 100
#: Steps of the least squares (numerics: noise makes each too short, by as much as its slope is above the signal's).
ROUNDS = 20


@checks_arguments
def aligned(
    first: Recording, further: Recording, *, by: str | None = None, delay: float | None = None
) -> Recording:
    """The first recording with the signals that only a further one has, on the raster of the first.

    Parameters
    ----------
    first, further : Recording
    by : str, optional
        A signal that both have: the clocks are shifted so that it agrees best.
    delay : float, s, optional
        By how much the further file's clock is ahead, where that is known; 0 with neither.

    Returns
    -------
    Recording
        Rows that both have; ``meta["clock_delay"]`` is the shift, s. Signals between rows are interpolated linearly.

    Raises
    ------
    InvalidInput
        If the signal is missing in one, does not agree at any shift, or hardly any rows are common.
    """
    if by is not None and delay is not None:
        raise InvalidInput("aligned", "a signal and a delay", "one of them", "Leave one out.")
    shift = _delay(first, further, by) if by is not None else (delay or 0.0)
    time = further.time - shift
    rows = (first.time >= time[0]) & (first.time <= time[-1])
    if np.count_nonzero(rows) < FEWEST:
        raise InvalidInput(
            "aligned",
            f"{np.count_nonzero(rows)} rows in common",
            f"at least {FEWEST}",
            "Check time and unit.",
        )
    new = [name for name in further.names if name not in first]
    signals = {name: first[name][rows] for name in first.names}
    signals |= {name: np.interp(first.time[rows], time, further[name]) for name in new}
    origin = {**first.origin, **{name: further.origin[name] for name in new if name in further.origin}}
    made = replace(first, time=first.time[rows], signals=signals, origin=origin)
    problems = (*first.meta.get("problems", ()), *further.meta.get("problems", ()))
    if problems:  # what holds of the channels together, as a wrong sign, shows only now
        problems = tuple(dict.fromkeys((*problems, *check_recording(made))))
    return replace(made, meta={**first.meta, "problems": problems, "clock_delay": float(shift)})


def _delay(first: Recording, further: Recording, by: str) -> float:
    """Shift of the further clock, s: from the peak of the correlation on, by least squares."""
    from scipy.signal import correlate

    for recording in (first, further):
        if by not in recording:
            raise InvalidInput(
                "aligned: by", f"no {by} in one of them", "a signal that both have", "Choose one."
            )
    dt = first.dt
    other = np.interp(np.arange(further.time[0], further.time[-1], dt), further.time, further[by])
    a, b = (values - np.mean(values) for values in (first[by], other))
    product = correlate(a, b, "full", "fft")
    # Of the rows that overlap at each shift: else a short overlap could never win, and never be judged.
    ones_a, ones_b = np.ones(a.size), np.ones(b.size)
    energy = correlate(a**2, ones_b, "full", "fft") * correlate(ones_a, b**2, "full", "fft")
    overlap = correlate(ones_a, ones_b, "full", "fft")
    usable = overlap > 0.5 * min(a.size, b.size)
    likeness = np.where(usable, product / np.sqrt(np.maximum(energy, 1e-300)), -1.0)
    peak = int(np.argmax(likeness))
    if likeness[peak] < ALIKE:
        got = f"a {by} that agrees by {likeness[peak]:.2f} at best"
        raise InvalidInput(
            "aligned", got, f"a correlation of {ALIKE}", "Check sign, unit and column, or give the delay."
        )
    # ``further`` belongs so much after the first's begin; then least squares, where the normalisation has no part.
    delay = float(further.time[0] - first.time[0] - (peak - (b.size - 1)) * dt)
    for _ in range(ROUNDS):
        time = further.time - delay
        rows = (first.time >= time[0]) & (first.time <= time[-1])
        shown = np.interp(first.time[rows], time, further[by])
        slope = np.gradient(shown, dt)
        delay -= float(np.sum((shown - first[by][rows]) * slope) / max(np.sum(slope**2), 1e-300))
    return delay
