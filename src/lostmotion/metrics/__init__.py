"""Metrics: errors of an estimate, and quality of the response to a step of the set-point.

Pure functions on arrays. A value that is not defined for the given data is ``None``, never NaN.
"""

from .estimate_errors import compare, lag, largest_error, rmse, signal_range
from .gap_crossing import CrossingMetrics, crossing_metrics
from .step_response import Recovery, StepMetrics, recovery, step_metrics

__all__ = [
    "CrossingMetrics", "Recovery", "StepMetrics", "compare", "crossing_metrics", "lag", "largest_error", "recovery",
    "rmse", "signal_range", "step_metrics",
]  # fmt: skip
