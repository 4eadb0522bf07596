"""Comparisons: many laws over the same recordings, as a leaderboard."""

from .cases import CASES, Case
from .compare_observers import compare_observers
from .contestants import CONTESTANTS, Contestant, Sensing
from .leaderboard import Leaderboard

__all__ = ["CASES", "CONTESTANTS", "Case", "Contestant", "Leaderboard", "Sensing", "compare_observers"]
