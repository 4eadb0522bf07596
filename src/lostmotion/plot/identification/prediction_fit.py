"""Prediction by the identified model: measured and predicted signal, the residual and its autocorrelation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from ...argument_checks import checks_arguments
from ...errors import InvalidInput
from ..style import ESTIMATED, MEASURED, Floats, axis_label, display_unit, panels, thin_min_max

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@checks_arguments
def prediction_fit(
    time: ArrayLike,
    measured: ArrayLike,
    predicted: ArrayLike,
    *,
    signal: str = "speed_motor",
    source: str = "measured",
    window: tuple[float, float] | None = None,
    lags: int = 100,
    axes: Sequence[Axes] | None = None,
) -> Figure:
    """Measured and predicted signal over a short window, the residual, and its autocorrelation.

    Parameters
    ----------
    time, measured, predicted : (n,) arrays, s and SI
        ``predicted`` is the prediction one sample ahead.
    signal : str
        The signal's name; it gives label and unit.
    source : str
        What the signal is called in the legend: "simulated" if it is that, see ``source_of``.
    window : (start, stop), optional, s
        What the first panel shows; default: the quarter of a second in which the signal moves most.
    lags : int
        Number of lags of the autocorrelation, in samples.
    axes : sequence of three Axes, optional

    Returns
    -------
    Figure
    """
    t, real, guess = (np.asarray(values, dtype=float) for values in (time, measured, predicted))
    if not (t.ndim == 1 and t.size > 1 and t.shape == real.shape == guess.shape and lags > 0):
        got = f"shapes {t.shape}, {real.shape}, {guess.shape}, {lags} lags"
        raise InvalidInput("prediction_fit", got, "three rows of one length, some lags", "Cut them alike.")
    factor, unit = display_unit(signal)
    figure, (overlay, error, correlation) = panels(axes, 3, size=(10.0, 7.2))
    start, stop = window or _liveliest(t, real, 0.25)
    part = (t >= start) & (t < stop)
    overlay.plot(t[part], factor * real[part], label=source, **MEASURED)
    overlay.plot(t[part], factor * guess[part], label="predicted", **ESTIMATED)
    overlay.set(xlabel="time (s)", ylabel=axis_label(signal), xlim=(start, stop))
    overlay.set_title("Prediction one sample ahead", loc="left")
    overlay.legend(frameon=False, ncols=2, loc="lower right", bbox_to_anchor=(1.0, 0.98))
    residual = real - guess
    error.plot(*thin_min_max(t, factor * residual, 1000), color=ESTIMATED["color"], linewidth=0.5)
    error.set(xlabel="time (s)", ylabel=f"residual ({unit})", xlim=(t[0], t[-1]))
    error.set_title("Residual over the recording", loc="left")
    values = autocorrelation(residual, lags)
    band = 1.96 / np.sqrt(residual.size)
    correlation.axhspan(-band, band, color="#E69F00", alpha=0.45, label="95 % band of white noise")
    correlation.vlines(np.arange(1, values.size), 0.0, values[1:], color=ESTIMATED["color"], linewidth=1.2)
    correlation.axhline(0.0, color="#999999", linewidth=0.8)
    correlation.set(xlabel="lag (samples)", ylabel="autocorrelation (–)")
    correlation.set_title("Autocorrelation of the residual", loc="left")
    correlation.legend(frameon=False, loc="lower right", bbox_to_anchor=(1.0, 0.98))
    return figure


def autocorrelation(values: ArrayLike, lags: int) -> Floats:
    """Autocorrelation of an (n,) array at lags 0 … lags, by the Fourier transform; zeros if constant."""
    centred = np.array(values, dtype=float)
    centred -= centred.mean()
    spectrum = np.abs(np.fft.rfft(centred, 2 * centred.size)) ** 2
    covariance = np.fft.irfft(spectrum)[: min(lags, centred.size - 1) + 1]
    return np.asarray(covariance / covariance[0] if covariance[0] > 0.0 else np.zeros_like(covariance))


def _liveliest(time: Floats, values: Floats, length: float) -> tuple[float, float]:
    """The stretch of the given length in which the values have the largest range."""
    starts = np.arange(time[0], max(time[-1] - length, time[0]) + 1e-12, length)
    spans = [np.ptp(values[(time >= s) & (time < s + length)]) for s in starts]
    start = float(starts[int(np.argmax(spans))])
    return start, min(start + length, float(time[-1]))
