"""Compiled kernels on floats and arrays; nothing else imports numba."""

from pathlib import Path

from .fresh_cache import drop_stale

drop_stale(Path(__file__).parent)
