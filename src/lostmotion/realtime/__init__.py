"""A law and the virtual rig as two processes of one machine, in lock-step or by the clock."""

from .run_loop import LoopRun, run_loop
from .timing import Timing

__all__ = ["LoopRun", "Timing", "run_loop"]
