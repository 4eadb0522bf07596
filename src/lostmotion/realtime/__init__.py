"""A law and the virtual rig as two processes: in lock-step, or paced by the clock."""

from .run_loop import LoopRun, run_loop
from .timing import Timing

__all__ = ["LoopRun", "Timing", "run_loop"]
