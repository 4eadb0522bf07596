"""Exact simulation of drivetrains with backlash and set-valued friction, with or without a law in the loop."""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

from .sensors import Sensor, measure
from .simulate import simulate

if TYPE_CHECKING:
    from .batch.run import BatchResult, read_trajectories, simulate_batch
    from .batch.variants import variants

# Loaded when first used: what batches need takes as long to load as a small simulation runs.
_HOME = {
    "BatchResult": "batch.run",
    "read_trajectories": "batch.run",
    "simulate_batch": "batch.run",
    "variants": "batch.variants",
}

__all__ = ["BatchResult", "Sensor", "measure", "read_trajectories", "simulate", "simulate_batch", "variants"]


if not TYPE_CHECKING:  # a type checker sees the imports above, and that nothing else is here

    def __getattr__(name: str) -> Any:
        if name not in _HOME:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return getattr(importlib.import_module(f".{_HOME[name]}", __name__), name)
