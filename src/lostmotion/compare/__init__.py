"""Comparisons: many laws over the same recordings, or in the same loops, as a leaderboard."""

from .cases import CASES, Case
from .compare_observers import compare_observers
from .contestants import CONTESTANTS, Contestant, Sensing
from .controllers import ControlTable, compare_controllers
from .leaderboard import Leaderboard

__all__ = [
    "CASES", "CONTESTANTS", "Case", "Contestant", "ControlTable", "Leaderboard", "Sensing", "compare_controllers",
    "compare_observers",
]  # fmt: skip
