"""The figure of errors within their deviations."""

from __future__ import annotations

import numpy as np

from lostmotion.plot import estimate_errors
from lostmotion.recording import Recording


def test_error_band_and_gap_of_each_observer():
    time = np.arange(5) * 0.1
    exact = Recording(time=time, signals={"twist": np.zeros(5)})
    one = Recording(
        time=time, signals={"twist_estimated": np.full(5, 1e-3), "twist_deviation": np.full(5, 2e-3)}
    )
    figure = estimate_errors(
        {"a": one, "b": one}, exact, signal="twist", gap=[0, 1, 1, 0, 0], span=(0.1, 0.4)
    )
    assert len(figure.axes) == 2
    line = figure.axes[0].lines[0]
    np.testing.assert_allclose(line.get_xdata(), [0.1, 0.2, 0.3])
    np.testing.assert_allclose(line.get_ydata(), 1.0)  # mrad
    band = figure.axes[1].collections[1].get_paths()[0].vertices[:, 1]
    assert (band.min(), band.max()) == (-4.0, 4.0)
    assert figure.axes[0].get_ylabel() == "a\nerror (mrad)"
    assert figure.axes[1].get_xlabel() == "time (s)"
